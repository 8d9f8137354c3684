#include "tubebin/results/labelled_points.hpp"

#include "core/json_reader.hpp"
#include "results/result_files.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/evaluation/cloud_pair.hpp"
#include "tubebin/evaluation/filtered_truth.hpp"
#include "tubebin/results/model_cloud.hpp"

namespace tubebin::results {
namespace {

/// The options that model.json says the run had.
ModelConfig read_run_config(const std::string& path) {
  const nlohmann::json json = parse_json(read_file(path), path);
  ModelConfig config;
  JsonPlace(json, path).at("options").fields([&](Fields& fields) { describe(fields, config); });
  return config;
}

/// From the clouds that the run kept. Points of the bin without a label are left out.
std::optional<evaluation::LabelledPoints> kept_points(const evaluation::RunScore& run) {
  if (run.dataset.empty() || run.filtered.empty() || run.labeled.empty()) return std::nullopt;
  const scene::DatasetFiles dataset(run.dataset);
  const std::string cloud = dataset.cloud_of(run.key.scene);
  if (cloud.empty()) return std::nullopt;
  const std::string path = dataset.place(run.key.scene, cloud);
  const scene::SceneRecord record =
      scene::parse_scene_json(dataset.read(run.key.scene, "scene.json"), dataset.place(run.key.scene, "scene.json"));
  // Clouds of model_tubes are in the world frame; another program's are as the cloud that it was given.
  const auto parse_kept = [&](const std::string& kept) {
    return run.folder.empty() ? scene::parse_scene_cloud(read_file(kept), kept, record) : cloud::read_cloud(kept);
  };
  cloud::Cloud filtered = scene::parse_scene_cloud(dataset.read(run.key.scene, cloud), path, record);
  if (filtered.labels.empty()) return std::nullopt;
  filtered.colors.clear();
  if (run.filtered != path)
    filtered = evaluation::filtered_truth({filtered, path}, {parse_kept(run.filtered), run.filtered}).cloud;
  const cloud::Cloud labeled = parse_kept(run.labeled);
  const evaluation::PairedIds pairs = evaluation::pair_clouds({filtered, run.filtered}, {labeled, run.labeled});
  evaluation::LabelledPoints result;
  result.scanner = record.scene.scanner;
  result.true_tubes = evaluation::tube_lines(record.scene);
  result.ratio = run.key.ratio;
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    if (pairs.truth[i] == 0 && pairs.predicted[i] == evaluation::kNullId) continue;
    result.points.push_back(filtered.points[pairs.points[i]]);
    result.truth.push_back(pairs.truth[i]);
    result.predicted.push_back(pairs.predicted[i]);
  }
  return result;
}

double micro_recall(const evaluation::LabelledPoints& points) {
  return evaluation::match_segments(evaluation::count_pairs(points.truth, points.predicted, 0)).micro_recall();
}

std::optional<evaluation::LabelledPoints> model_again(const evaluation::RunScore& run) {
  if (run.folder.empty()) return std::nullopt;
  const scene::DatasetFiles files(run.dataset);
  const CloudFile cloud{run.key.scene, files.cloud_of(run.key.scene)};
  if (cloud.file.empty()) return std::nullopt;
  const CloudToModel input = read_cloud_to_model(files, cloud);
  if (input.cloud.labels.empty() || !input.scene) return std::nullopt;
  const modeling::ModelingResult result = model_cloud(input, read_run_config(run.folder + "/model.json"));
  evaluation::LabelledPoints points;
  points.scanner = input.scene->scene.scanner;
  points.true_tubes = evaluation::tube_lines(input.scene->scene);
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

std::optional<evaluation::LabelledPoints> labelled_points(const evaluation::RunScore& run) {
  std::optional<evaluation::LabelledPoints> points = kept_points(run);
  if (!points && !run.dataset.empty()) points = model_again(run);
  if (const std::string model = run.folder + "/model.json"; points && !run.folder.empty() && path_exists(model))
    points->found_tubes = parse_model_tubes(read_file(model), model);
  return points;
}

}  // namespace tubebin::results
