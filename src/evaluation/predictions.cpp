#include "tubebin/evaluation/predictions.hpp"

#include <algorithm>
#include <filesystem>

#include "parallel.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin {
namespace {

namespace fs = std::filesystem;

/// The first of the files `stem`.pcd and `stem`.ply that exists; empty if neither does.
std::string find_cloud(const std::string& stem) {
  for (const char* format : {".pcd", ".ply"})
    if (fs::is_regular_file(stem + format)) return stem + format;
  return "";
}

/// Folders below the data set that hold a cloud, as "A10/007", in order.
std::vector<std::string> list_scenes(const std::string& dataset) {
  if (!fs::is_directory(dataset)) throw_io_error("{}: is no folder", dataset);
  std::vector<std::string> scenes;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dataset)) {
    if (!entry.is_directory() || entry.path().filename().string().starts_with('.')) continue;
    if (!find_cloud((entry.path() / "cloud").string()).empty())
      scenes.push_back(fs::relative(entry.path(), dataset).generic_string());
  }
  if (scenes.empty())
    throw_io_error("{}: no scene with a cloud.pcd or cloud.ply is in it, so it is no data set", dataset);
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

/// The files of a prediction; `labeled` is empty where there is none.
struct PredictionFiles {
  std::string labeled;
  std::string filtered;  ///< empty: the scene's own cloud
};

PredictionFiles find_prediction(const std::string& folder, const std::string& scene) {
  const std::string stem = folder + "/" + scene;
  if (std::string file = find_cloud(stem); !file.empty()) return {file, ""};
  return {find_cloud(stem + "/labeled"), find_cloud(stem + "/filtered")};
}

Cloud read_ground_truth(const std::string& path) {
  Cloud cloud = read_cloud(path);
  if (cloud.labels.empty()) throw_io_error("{}: has no label field, so it is no ground truth", path);
  cloud.colors.clear();
  return cloud;
}

/// Of the two fields of a prediction, the one that is asked for.
void keep_field(Cloud& cloud, SegmentField field, const std::string& path) {
  if (field == SegmentField::automatic) return;
  std::vector<std::uint32_t>& wanted = field == SegmentField::label ? cloud.labels : cloud.colors;
  std::vector<std::uint32_t>& other = field == SegmentField::label ? cloud.colors : cloud.labels;
  if (wanted.empty() && cloud.size() > 0)
    throw_io_error("{}: has no {}", path, field == SegmentField::label ? "label field" : "colours");
  other.clear();
}

RunScore score_scene(const std::string& dataset, const std::string& scene, const PredictionFiles& files, RunKey key,
                     SegmentField field) {
  const std::string truth_path = files.filtered.empty() ? find_cloud(dataset + "/" + scene + "/cloud") : files.filtered;
  const Cloud truth = read_ground_truth(truth_path);
  Cloud labeled;
  if (!files.labeled.empty()) {
    labeled = read_cloud(files.labeled);
    keep_field(labeled, field, files.labeled);
  }
  const PairedIds pairs = pair_clouds({truth, truth_path}, {labeled, files.labeled});
  const Contingency contingency = count_pairs(pairs.truth, pairs.predicted, pairs.bin_id);
  const Matching matching =
      match_segments(contingency, files.filtered.empty() ? BinPoints::left_out : BinPoints::counted);

  std::optional<SceneTruth> scene_truth;
  if (const std::string path = dataset + "/" + scene + "/scene.json"; fs::exists(path)) {
    const SceneRecord record = read_scene_json(path);
    key.tubes = static_cast<int>(record.scene.tubes.size());
    scene_truth.emplace(record.scene);
  }
  RunScore run = score_run(key, contingency, matching, scene_truth ? &*scene_truth : nullptr, {});
  run.failed = files.labeled.empty();
  if (scene_truth) run.dataset = dataset;
  run.filtered = truth_path;
  run.labeled = files.labeled;
  return run;
}

}  // namespace

Evaluation score_predictions(const std::string& dataset, const std::string& folder, const PredictionOptions& options) {
  const std::vector<std::string> scenes = list_scenes(dataset);
  if (!fs::is_directory(folder)) throw_io_error("{}: is no folder", folder);
  std::vector<PredictionFiles> files;
  for (const std::string& scene : scenes) files.push_back(find_prediction(folder, scene));
  if (std::all_of(files.begin(), files.end(), [](const PredictionFiles& f) { return f.labeled.empty(); }))
    throw_io_error("{}: has no prediction for any of the {} scenes of {}; expected {}/{}.pcd or {}/{}/labeled.pcd",
                   folder, scenes.size(), dataset, folder, scenes.front(), folder, scenes.front());

  Evaluation evaluation;
  evaluation.source = folder;

  evaluation.missing_counts_as_zero = true;
  evaluation.runs.resize(scenes.size());
  const std::string method = fs::path(folder).lexically_normal().filename().string();
  parallel_for(
      scenes.size(), options.jobs,
      [&](std::size_t i) {
        RunKey key = parse_scene_name(scenes[i]);
        key.method = method.empty() || method == "." ? "predictions" : method;
        evaluation.runs[i] = score_scene(dataset, scenes[i], files[i], key, options.field);
      },
      options.on_progress);
  for (std::size_t i = 0; i < scenes.size(); ++i)
    if (files[i].labeled.empty()) evaluation.missing.push_back(scenes[i]);
  return evaluation;
}

}  // namespace tubebin
