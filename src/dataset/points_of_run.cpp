#include "tubebin/dataset/points_of_run.hpp"

#include "scene/json_reader.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/dataset/model_cloud.hpp"

namespace tubebin {
namespace {

/// The options that model.json says the run had.
ModelConfig read_run_config(const std::string& path) {
  const nlohmann::json json = parse_json(read_file(path), path);
  ModelConfig config;
  JsonPlace(json, path).at("options").fields([&](Fields& fields) { describe(fields, config); });
  return config;
}

double micro_recall(const LabelledPoints& points) {
  return match_segments(count_pairs(points.truth, points.predicted, 0)).micro_recall();
}

std::optional<LabelledPoints> model_again(const RunScore& run) {
  if (run.folder.empty()) return std::nullopt;
  const DatasetFiles files(run.dataset);
  const CloudFile cloud{run.key.scene, files.cloud_of(run.key.scene)};
  if (cloud.file.empty()) return std::nullopt;
  const CloudToModel input = read_cloud_to_model(files, cloud);
  if (input.cloud.labels.empty() || !input.scene) return std::nullopt;
  const ModelingResult result = model_cloud(input, read_run_config(run.folder + "/model.json"));
  LabelledPoints points;
  points.scanner = input.scene->scene.scanner;
  points.ratio = run.key.ratio;
  points.predicted = result.labels;
  for (const std::uint32_t source : result.source) {
    points.points.push_back(input.cloud.points[source]);
    points.truth.push_back(input.cloud.labels[source]);
  }
  if (micro_recall(points) != run.micro_recall) return std::nullopt;
  return points;
}

}  // namespace

std::optional<LabelledPoints> points_of_run(const RunScore& run) {
  if (auto kept = read_points(run)) return kept;
  return run.dataset.empty() ? std::nullopt : model_again(run);
}

}  // namespace tubebin
