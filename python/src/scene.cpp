// Scenes: generated, and scanned.
#include "scene.hpp"

#include <nanobind/stl/string.h>

#include "depth_image.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::python {
namespace {

using dataset::DatasetConfig;

/// No attempt gave a scene.
class GenerationError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

DatasetConfig parse_config(const std::string& text) {
  DatasetConfig config;
  const KeyPlaces places = read_yaml_text(text, "config", fields_of(config));
  load_bin_mesh(config, places);
  check(config, places);
  config.tool_version = tool_version();
  return config;
}

/// An exception costs an attempt, as it does in a worker process of generate_dataset.
dataset::GeneratedScene attempt_scene(const DatasetConfig& config, const dataset::SceneId& id, int attempt) try {
  return dataset::generate_scene(config, id, attempt);
} catch (const IoError&) {
  throw;
} catch (const ConfigError&) {
  throw;
} catch (const std::exception& error) {
  dataset::GeneratedScene failed;
  failed.failure = "crash";
  failed.failure_detail = error.what();
  return failed;
}

/// `request` has the keys tubes (one number), seed and cases: the scene is the last one that it asks for.
Scene generate(DatasetConfig config, const std::string& request) {
  check(config, read_yaml_text(request, "generate", fields_of(config)));
  config.output = {};  // the scene is not written
  const dataset::SceneId id{.set = config.set, .tubes = config.tubes.front(), .case_number = config.cases};
  std::string failure;
  for (int attempt = 0; attempt < config.attempts_max; ++attempt) {
    dataset::GeneratedScene made = attempt_scene(config, id, attempt);
    if (made.failure.empty()) return {std::move(made.content.record), std::move(made.content.cloud)};
    failure = made.failure + ": " + made.failure_detail;
  }
  throw GenerationError(
      fmt::format("{}: given up after {} attempts; last: {}", id.name(), config.attempts_max, failure));
}

cloud::Cloud scan(const Scene& scene) {
  if (scene.seen) return *scene.seen;
  return scan::scan_from_all(scene.record.scene, scene.record.seed).cloud;
}

}  // namespace

void bind_scene(nb::module_& module) {
  const nb::exception<GenerationError> generation_error(module, "GenerationError", PyExc_RuntimeError);
  nb::class_<DatasetConfig>(module, "Config");
  module.def("load_config", &dataset::load_config, nb::arg("path"));
  module.def("parse_config", &parse_config, nb::arg("text"));

  nb::class_<Scene>(module, "Scene",
                    "A settled scene: a bin, its tubes and the scanners that look at them. World frame: origin at the "
                    "middle of the bin's inner floor, z up; metres.")
      .def_prop_ro(
          "id", [](const Scene& self) { return self.record.id; }, "Name in its data set, as 'A10/001'.")
      .def_prop_ro(
          "seed", [](const Scene& self) { return self.record.seed; }, "Of the attempt that succeeded.")
      .def_prop_ro(
          "json", [](const Scene& self) { return scene::format_scene_json(self.record); },
          "The text of scene.json: shape, pose, colour, label and visibility of every tube, contacts, who "
          "covers whom. docs/scene.schema.json describes it; json.loads makes it a dict.")
      .def("scan", &scan, nb::call_guard<nb::gil_scoped_release>(),
           "What the scene's scanners see: a labelled Cloud of its own, organized where there is one scanner. Exact "
           "rays, and the configuration's scanner effects; the same bytes each time.")
      .def(
          "depth_image",
          [](const Scene& self) { return DepthImage(scene::depth_image(scan(self), self.record), self.record); },
          nb::call_guard<nb::gil_scoped_release>(),
          "The same as a DepthImage, with the depths of depth.png, which are rounded to 0.1 mm (in the paper's scene). "
          "Raises IoError where the cloud is not organized.");
  module.def("generate", &generate, nb::arg("config"), nb::arg("request"), nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace tubebin::python
