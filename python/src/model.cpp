// Tubes from points.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bindings.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/modeling/model_json.hpp"
#include "tubebin/results/model_cloud.hpp"

namespace tubebin::python {
namespace {

using results::ModelConfig;

struct Tube {
  modeling::TubeModel model;
  std::uint32_t label = 0;

  double evidence() const {
    double sum = 0.0;
    for (const modeling::TubePath& path : model.paths) sum += path.evidence;
    return sum;
  }
};

struct Model {
  modeling::ModelingResult result;
  ModelConfig config;
  std::uint32_t height = 1;
  std::uint32_t width = 0;
};

ModelConfig parse_model_config(const std::string& text) {
  ModelConfig config;
  check(config.modeling, read_yaml_text(text, "config", [&](Fields& fields) { describe(fields, config); }));
  return config;
}

/// `request` has further keys of the configuration.
Model model(const PointArray& points, const PoseArray& viewpoint, ModelConfig config, const std::string& request) {
  results::CloudToModel input{.path = "points", .cloud = cloud_of_points(points), .scene = std::nullopt, .hashes = {}};
  input.cloud.world_from_sensor = pose_of(viewpoint);
  const nb::gil_scoped_release without_lock;
  check(config.modeling, read_yaml_text(request, "model", [&](Fields& fields) { describe(fields, config); }));
  config.modeling.label_all = true;
  modeling::ModelingResult result = results::model_cloud(input, config);
  return {std::move(result), std::move(config), points.ndim() == 3 ? input.cloud.height : 1, input.cloud.width};
}

std::vector<Tube> tubes_of(const Model& model) {
  std::vector<Tube> tubes;
  for (const modeling::TubeModel& found : model.result.tubes)
    tubes.push_back({found, static_cast<std::uint32_t>(tubes.size() + 1)});
  return tubes;
}

std::string json_of(const Model& model) {
  ModelConfig config = model.config;
  return modeling::format_model_json(
      model.result, results::model_colors(model.result), [&](Fields& fields) { describe(fields, config); }, false);
}

void bind_tube(nb::module_& module) {
  nb::class_<Tube>(module, "Tube", "A tube that was found. Metres, in the frame of the points.")
      .def_ro("label", &Tube::label, "Of its points, from 1.")
      .def_prop_ro(
          "radius", [](const Tube& self) { return self.model.radius; }, "Outer radius, metres.")
      .def_prop_ro(
          "length", [](const Tube& self) { return self.model.length(); }, "Of all paths, metres.")
      .def_prop_ro(
          "centerline", [](const Tube& self) { return array_of(self.model.paths.front().nodes); },
          nb::rv_policy::automatic,
          "(N, 3) float64: ends and joints of the N - 1 cylinders in a row; of a tube that branches, of its "
          "longest path; of a ball, its centre.")
      .def_prop_ro(
          "bridged", [](const Tube& self) { return self.model.paths.front().bridged; },
          "Of each of the centreline's N - 1 cylinders: it spans a stretch that the scanner did not see.")
      .def_prop_ro(
          "branches",
          [](const Tube& self) {
            std::vector<Array<double>> branches;
            for (std::size_t k = 1; k < self.model.paths.size(); ++k)
              branches.push_back(array_of(self.model.paths[k].nodes));
            return branches;
          },
          nb::rv_policy::automatic,
          "Further paths of a tube that branches, each (N, 3) float64, one end on a path before it.")
      .def_prop_ro("confidence", &Tube::evidence,
                   "Nats: log of how much likelier its points are of a tube than of flat strips (log_odds in "
                   "model.json); 0 where that was not looked at.")
      .def_prop_ro(
          "whole_log_odds", [](const Tube& self) { return self.model.whole_odds; },
          "Nats: log of how much likelier the best explanation of the scan is than the best one in which its pieces are "
          "not one tube by themselves; 10: at least. None where that was not looked at.")
      .def_prop_ro(
          "bridge_log_odds", [](const Tube& self) { return self.model.paths.front().bridge_odds; },
          "Nats, of the centreline's bridged cylinders in order: the same against the best explanation in which the "
          "pieces on both sides are different tubes'. Empty where that was not looked at.");
}

}  // namespace

void bind_model(nb::module_& module) {
  bind_tube(module);
  nb::class_<ModelConfig>(module, "ModelConfig");
  module.def("load_model_config", &results::load_model_config, nb::arg("path"));
  module.def("parse_model_config", &parse_model_config, nb::arg("text"));

  nb::class_<Model>(module, "Model", "What was found in a cloud.")
      .def_prop_ro(
          "labels",
          [](nb::handle self) {
            Model& model = nb::cast<Model&>(self);
            return per_point(model.result.all_labels, model.height, model.width, model.height > 1, self);
          },
          "(H, W) or (N,) uint32, as the points: k of tubes[k - 1], 0 of no tube. A view.")
      .def_prop_ro("tubes", &tubes_of, "The tubes, that of label 1 first.")
      .def_prop_ro(
          "warnings", [](const Model& self) { return self.result.found.doubts; },
          "Why the result may not be trusted, as sentences; empty where nothing looks wrong.")
      .def_prop_ro(
          "radius", [](const Model& self) { return self.result.radius; },
          "Of the most tubes, metres: as told, or as estimated.")
      .def_prop_ro(
          "noise", [](const Model& self) { return self.result.noise; },
          "Metres, standard deviation of the points' distances to the fitted surfaces.")
      .def_prop_ro("json", &json_of,
                   "The text of model.json, without times. docs/model.schema.json describes it; json.loads makes it a "
                   "dict.");
  module.def("model", &model, nb::arg("points"), nb::arg("viewpoint"), nb::arg("config"), nb::arg("request"));
}

}  // namespace tubebin::python
