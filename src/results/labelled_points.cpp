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
ModelConfig parse_run_config(const std::string& text, const std::string& path) {
  const nlohmann::json json = parse_json(text, path);
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

evaluation::LabelledPoints with_truth(const CloudToModel& input, const modeling::ModelingResult& result, double ratio) {
  evaluation::LabelledPoints points;
  points.scanner = input.scene->scene.scanner;
  points.true_tubes = evaluation::tube_lines(input.scene->scene);
  points.ratio = ratio;
  points.predicted = result.labels;
  for (const std::uint32_t source : result.source) {
    points.points.push_back(input.cloud.points[source]);
    points.truth.push_back(input.cloud.labels[source]);
  }
  return points;
}

/// From the tubes in model.json, or from modelling again, whichever gives the labels that result.json counted.
std::optional<evaluation::LabelledPoints> label_again(const evaluation::RunScore& run) {
  if (run.folder.empty()) return std::nullopt;
  const scene::DatasetFiles files(run.dataset);
  const CloudFile cloud{run.key.scene, files.cloud_of(run.key.scene)};
  if (cloud.file.empty()) return std::nullopt;
  const CloudToModel input = read_cloud_to_model(files, cloud);
  if (input.cloud.labels.empty() || !input.scene) return std::nullopt;

  const std::string model_path = run.folder + "/model.json", counts_path = run.folder + "/result.json";
  const std::string model = read_file(model_path);
  const ModelConfig config = parse_run_config(model, model_path);
  const evaluation::Contingency counted = parse_run_counts(read_file(counts_path), counts_path).contingency;
  const auto if_as_counted = [&](const modeling::ModelingResult& result) -> std::optional<evaluation::LabelledPoints> {
    evaluation::LabelledPoints points = with_truth(input, result, run.key.ratio);
    if (evaluation::count_pairs(points.truth, points.predicted, 0) != counted) return std::nullopt;
    return points;
  };
  if (auto points = if_as_counted(label_cloud(input, config, parse_labeling_tubes(model, model_path)))) return points;
  return if_as_counted(model_cloud(input, config));
}

}  // namespace

std::optional<evaluation::LabelledPoints> labelled_points(const evaluation::RunScore& run) {
  std::optional<evaluation::LabelledPoints> points = kept_points(run);
  if (!points && !run.dataset.empty()) points = label_again(run);
  if (const std::string model = run.folder + "/model.json"; points && !run.folder.empty() && path_exists(model))
    points->found_tubes = parse_model_tubes(read_file(model), model);
  return points;
}

}  // namespace tubebin::results
