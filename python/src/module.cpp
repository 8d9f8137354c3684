#include "bindings.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/version.hpp"

// The names of the package tubebin, which says more about each of them.
NB_MODULE(_core, module) {
  using namespace tubebin;
  module.def("tool_version", &tool_version);
  const nanobind::exception<IoError> io_error(module, "IoError", PyExc_OSError);
  const nanobind::exception<ConfigError> config_error(module, "ConfigError", PyExc_ValueError);
  python::bind_cloud(module);
  python::bind_depth_image(module);
  python::bind_scene(module);
  python::bind_dataset(module);
  python::bind_model(module);
  python::bind_evaluation(module);
}
