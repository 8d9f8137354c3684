// The scenes of a data set, loose or packed.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "depth_image.hpp"
#include "scene.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/results/cloud_files.hpp"

namespace tubebin::python {
namespace {

using scene::DatasetFiles;

std::vector<std::string> names_of(const DatasetFiles& files) {
  std::vector<std::string> names;
  for (const results::CloudFile& cloud : results::find_clouds(files)) names.push_back(cloud.scene);
  return names;
}

std::optional<Scene> read_scene(const DatasetFiles& files, const std::string& name) {
  if (!files.has(name, "scene.json")) return std::nullopt;
  Scene scene{scene::parse_scene_json(files.read(name, "scene.json"), files.place(name, "scene.json"))};
  scene::Bin& bin = scene.record.scene.bin;
  if (bin.has_mesh() && path_exists(files.dataset() + "/" + bin.mesh)) load_mesh(bin, files.dataset());
  return scene;
}

/// In the world frame and metres.
cloud::Cloud read_cloud(const DatasetFiles& files, const std::string& name) {
  const std::string file = files.cloud_of(name);
  const std::optional<Scene> scene = read_scene(files, name);
  return scene::parse_scene_cloud(files.read(name, file), files.place(name, file),
                                  scene ? scene->record : scene::SceneRecord{});
}

DepthImage read_depth_image(const DatasetFiles& files, const std::string& name) {
  const std::optional<Scene> scene = read_scene(files, name);
  if (!scene)
    throw_io_error("{}: has no scene.json, and so no camera for a depth image", files.place(name, "scene.json"));
  return {scene::read_depth_image(files, name, scene->record), scene->record};
}

}  // namespace

void bind_dataset(nb::module_& module) {
  const nb::call_guard<nb::gil_scoped_release> without_lock;
  nb::class_<DatasetFiles>(module, "DatasetFiles")
      .def(nb::init<const std::string&>(), nb::arg("folder"), without_lock)
      .def("names", &names_of, without_lock)
      .def("read_cloud", &read_cloud, nb::arg("name"), without_lock)
      .def("read_depth_image", &read_depth_image, nb::arg("name"), without_lock)
      .def("read_scene", &read_scene, nb::arg("name"), without_lock);
}

}  // namespace tubebin::python
