#include "tubebin/results/predictions.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "evaluation/parallel.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/evaluation/filtered_truth.hpp"
#include "tubebin/scene/dataset_files.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::results {
namespace {

namespace fs = std::filesystem;

/// The first of the files `stem`.pcd and `stem`.ply that exists; empty if neither does.
std::string find_cloud(const std::string& stem) {
  for (const char* format : {".pcd", ".ply"})
    if (is_regular_file(stem + format)) return stem + format;
  return "";
}

/// Names of the data set's scenes that have a cloud, in order.
std::vector<std::string> list_scenes(const scene::DatasetFiles& dataset) {
  if (!path_exists(dataset.dataset())) throw_io_error("{}: is no folder", dataset.dataset());
  std::vector<std::string> scenes = dataset.scenes();
  std::erase(scenes, ".");
  if (scenes.empty())
    throw_io_error("{}: no scene with a cloud.pcd or cloud.ply is in it, so it is no data set", dataset.dataset());
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

cloud::Cloud check_ground_truth(cloud::Cloud cloud, const std::string& path) {
  if (cloud.labels.empty()) throw_io_error("{}: has no label field, so it is no ground truth", path);
  cloud.colors.clear();
  return cloud;
}

/// Of the two fields of a prediction, the one that is asked for.
void keep_field(cloud::Cloud& cloud, evaluation::SegmentField field, const std::string& path) {
  if (field == evaluation::SegmentField::automatic) return;
  std::vector<std::uint32_t>& wanted = field == evaluation::SegmentField::label ? cloud.labels : cloud.colors;
  std::vector<std::uint32_t>& other = field == evaluation::SegmentField::label ? cloud.colors : cloud.labels;
  if (wanted.empty() && cloud.size() > 0)
    throw_io_error("{}: has no {}", path, field == evaluation::SegmentField::label ? "label field" : "colours");
  other.clear();
}

std::optional<scene::SceneRecord> read_record(const scene::DatasetFiles& dataset, const std::string& scene) {
  if (!dataset.has(scene, "scene.json")) return std::nullopt;
  return scene::parse_scene_json(dataset.read(scene, "scene.json"), dataset.place(scene, "scene.json"));
}

evaluation::RunScore score_scene(const scene::DatasetFiles& dataset, const std::string& scene,
                                 const PredictionFiles& files, evaluation::RunKey key, evaluation::SegmentField field) {
  const std::string cloud = dataset.cloud_of(scene), cloud_path = dataset.place(scene, cloud);
  const std::optional<scene::SceneRecord> record = read_record(dataset, scene);
  // A program's clouds are in the frame and unit of the cloud that it was given.
  const auto parse = [&](const std::string& bytes, const std::string& path) {
    return scene::parse_scene_cloud(bytes, path, record.value_or(scene::SceneRecord{}));
  };
  evaluation::FilteredTruth truth{.cloud =
                                      check_ground_truth(parse(dataset.read(scene, cloud), cloud_path), cloud_path)};
  if (!files.filtered.empty())
    truth = evaluation::filtered_truth({truth.cloud, cloud_path},
                                       {parse(read_file(files.filtered), files.filtered), files.filtered});
  const std::string& truth_path = files.filtered.empty() ? cloud_path : files.filtered;
  cloud::Cloud labeled;
  if (!files.labeled.empty()) {
    labeled = parse(read_file(files.labeled), files.labeled);
    keep_field(labeled, field, files.labeled);
  }
  const evaluation::PairedIds pairs = evaluation::pair_clouds({truth.cloud, truth_path}, {labeled, files.labeled});
  const evaluation::Contingency contingency = evaluation::count_pairs(pairs.truth, pairs.predicted, pairs.bin_id);
  const evaluation::Matching matching = evaluation::match_segments(
      contingency, files.filtered.empty() ? evaluation::BinPoints::left_out : evaluation::BinPoints::counted);

  std::optional<evaluation::SceneTruth> scene_truth;
  if (record) {
    if (files.filtered.empty())
      scene::require_same_scene(*record, truth.cloud, scene, dataset.place(scene, "scene.json"));
    key.tubes = static_cast<int>(record->scene.tubes.size());
    scene_truth.emplace(record->scene);
  }
  evaluation::RunScore run =
      evaluation::score_run(key, contingency, matching, scene_truth ? &*scene_truth : nullptr, {});
  run.failed = files.labeled.empty();
  if (!files.filtered.empty()) run.coverage = truth.coverage;
  if (scene_truth) run.dataset = dataset.dataset();
  run.filtered = truth_path;
  run.labeled = files.labeled;
  return run;
}

/// Of the scenes whose program told what it worked on; empty where none did.
std::string coverage_note(const std::vector<evaluation::RunScore>& runs) {
  std::size_t count = 0;
  double sum = 0.0;
  const evaluation::RunScore* least = nullptr;
  for (const evaluation::RunScore& run : runs) {
    if (!run.coverage) continue;
    ++count;
    sum += *run.coverage;
    if (least == nullptr || *run.coverage < *least->coverage) least = &run;
  }
  if (count == 0) return "";
  return fmt::format(
      "{} scenes are scored on the points of their filtered clouds: {:.1f} % of the tubes' points on average, at least "
      "{:.1f} % ({}); the rest counts neither as found nor as missed",
      count, 100.0 * sum / static_cast<double>(count), 100.0 * *least->coverage, least->key.scene);
}

/// One folder's predictions, added to the evaluation as `method`.
void score_folder(const scene::DatasetFiles& dataset, const std::vector<std::string>& scenes, const std::string& folder,
                  const std::string& method, const PredictionOptions& options, evaluation::Evaluation& evaluation) {
  if (!is_folder(folder)) throw_io_error("{}: is no folder", folder);
  std::vector<PredictionFiles> files;
  for (const std::string& scene : scenes) files.push_back(find_prediction(folder, scene));
  if (std::all_of(files.begin(), files.end(), [](const PredictionFiles& f) { return f.labeled.empty(); }))
    throw_io_error("{}: has no prediction for any of the {} scenes of {}; expected {}/{}.pcd or {}/{}/labeled.pcd",
                   folder, scenes.size(), dataset.dataset(), folder, scenes.front(), folder, scenes.front());

  std::vector<evaluation::RunScore> runs(scenes.size());
  evaluation::parallel_for(
      scenes.size(), options.jobs,
      [&](std::size_t i) {
        evaluation::RunKey key = evaluation::parse_scene_name(scenes[i]);
        key.method = method;
        runs[i] = score_scene(dataset, scenes[i], files[i], key, options.field);
      },
      options.on_progress);
  if (std::string note = coverage_note(runs); !note.empty()) evaluation.notes.push_back(std::move(note));
  evaluation.source += (evaluation.source.empty() ? "" : ", ") + folder;
  for (std::size_t i = 0; i < scenes.size(); ++i)
    if (files[i].labeled.empty()) evaluation.missing.push_back(scenes[i]);
  std::move(runs.begin(), runs.end(), std::back_inserter(evaluation.runs));
}

/// The last folder of each path, or the paths where these are not enough to tell them apart.
std::vector<std::string> prediction_names(const std::vector<std::string>& folders,
                                          const std::vector<std::string>& given) {
  if (!given.empty() && given.size() != folders.size())
    throw_config_error("--name is there {} times for {} folders; give each folder one name, in the same order",
                       given.size(), folders.size());
  const auto are_distinct = [](const std::vector<std::string>& names) {
    return std::set<std::string>(names.begin(), names.end()).size() == names.size();
  };
  std::vector<std::string> names = given;
  if (given.empty())
    for (const std::string& folder : folders) {
      const std::string name = fs::path(folder).lexically_normal().filename().string();
      names.push_back(name.empty() || name == "." ? "predictions" : name);
    }
  if (given.empty() && !are_distinct(names)) names = folders;
  if (!are_distinct(names)) throw_config_error("two predictions have one name: {}", fmt::join(names, ", "));
  return names;
}

}  // namespace

evaluation::Evaluation score_predictions(const std::string& dataset_path, const std::vector<std::string>& folders,
                                         const PredictionOptions& options) {
  const scene::DatasetFiles dataset(dataset_path);
  const std::vector<std::string> scenes = list_scenes(dataset);
  const std::vector<std::string> names = prediction_names(folders, options.names);
  evaluation::Evaluation evaluation;
  evaluation.missing_counts_as_zero = true;
  for (std::size_t i = 0; i < folders.size(); ++i)
    score_folder(dataset, scenes, folders[i], names[i], options, evaluation);
  return evaluation;
}

}  // namespace tubebin::results
