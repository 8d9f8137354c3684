#include "tubebin/results/viewed_scenes.hpp"

#include <filesystem>

#include "results/result_files.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/evaluation/cloud_pair.hpp"
#include "tubebin/evaluation/html_report.hpp"
#include "tubebin/results/labelled_points.hpp"
#include "tubebin/results/model_cloud.hpp"
#include "tubebin/results/results_folder.hpp"

namespace tubebin::results {
namespace {

namespace fs = std::filesystem;

evaluation::LabelledPoints cloud_points(const CloudToModel& input) {
  evaluation::LabelledPoints points;
  points.points = input.cloud.points;
  points.truth = input.cloud.labels;
  points.scanner.position = input.cloud.world_from_sensor.translation();
  if (input.scene) points.true_tubes = evaluation::tube_lines(input.scene->scene);
  return points;
}

bool is_pack(const std::string& path) { return path.ends_with(".tar") && is_regular_file(path); }

/// The scene that DATASET/A10/007 or PACK.tar/A10/007 names, where it is packed.
std::optional<CloudToModel> packed_scene(const std::string& path) {
  fs::path scene;
  for (fs::path dataset = path; !dataset.empty() && dataset.has_relative_path(); dataset = dataset.parent_path()) {
    scene = scene.empty() ? dataset.filename() : dataset.filename() / scene;
    const std::string holder = dataset.has_parent_path() ? dataset.parent_path().string() : ".";
    if (!is_pack(holder) && !is_folder(scene::packs_folder(holder))) continue;
    const scene::DatasetFiles files(holder);
    const std::string cloud = files.cloud_of(scene.string());
    if (cloud.empty()) throw_io_error("{}: the data set {} has no scene {}", path, holder, scene.string());
    return read_cloud_to_model(files, {scene.string(), cloud});
  }
  return std::nullopt;
}

/// With the ground truth where filtered.pcd has it.
evaluation::LabelledPoints model_points(const std::string& folder) {
  const std::string filtered_path = folder + "/filtered.pcd", labeled_path = folder + "/labeled.pcd";
  for (const std::string& file : {filtered_path, labeled_path})
    if (!path_exists(file))
      throw_io_error(
          "{}: is not there; model_tubes DATASET --keep-clouds keeps it, and evaluate RESULTS --html shows "
          "scenes without it",
          file);
  const cloud::Cloud filtered = cloud::read_cloud(filtered_path);
  const cloud::Cloud labeled = cloud::read_cloud(labeled_path);
  evaluation::LabelledPoints points;
  points.scanner.position = labeled.world_from_sensor.translation();
  points.found_tubes = parse_model_tubes(read_file(folder + "/model.json"), folder + "/model.json");
  if (filtered.labels.empty()) {
    points.points = labeled.points;
    points.predicted = labeled.labels;
    return points;
  }
  const evaluation::PairedIds pairs =
      evaluation::pair_clouds({filtered, filtered_path}, {labeled, labeled_path}, evaluation::SegmentField::label);
  for (const std::uint32_t i : pairs.points) points.points.push_back(filtered.points[i]);
  points.truth = pairs.truth;
  points.predicted = pairs.predicted;
  return points;
}

std::vector<evaluation::SceneView> worst_scenes(const std::string& folder) {
  const evaluation::Evaluation evaluation = read_results({folder}, {});
  std::vector<evaluation::SceneView> views;
  for (const evaluation::RunScore* run : evaluation::pictured_runs(evaluation.runs))
    if (auto points = labelled_points(*run)) views.push_back({run->key.name(), std::move(*points)});
  if (views.empty()) throw_io_error("{}: its data set's clouds are not there to show", folder);
  return views;
}

}  // namespace

std::vector<evaluation::SceneView> viewed_scenes(const std::string& named) {
  const std::string path = named.substr(0, named.find_last_not_of('/') + 1);
  if (!path_exists(path))
    if (const auto scene = packed_scene(path)) return {{path, cloud_points(*scene)}};
  if (!is_folder(path) && !is_pack(path)) return {{path, cloud_points(read_cloud_to_model(path))}};
  for (const char* file : {"/cloud.pcd", "/cloud.ply"})
    if (path_exists(path + file)) return {{path, cloud_points(read_cloud_to_model(path + file))}};
  if (path_exists(path + "/model.json")) return {{path, model_points(path)}};
  if (path_exists(path + "/index.json")) return worst_scenes(path);
  if (const auto scenes = scene::DatasetFiles(path).scenes(); !scenes.empty())
    throw_io_error("{0}: is a data set of {1} scenes; name one: {0}/{2}", path, scenes.size(), scenes.front());
  throw_io_error(
      "{}: holds nothing to show; valid: a cloud file, a scene of a data set (DATASET/A10/001, PACK.tar/A10/001), or "
      "what model_tubes wrote",
      path);
}

}  // namespace tubebin::results
