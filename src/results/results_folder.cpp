#include "tubebin/results/results_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "evaluation/parallel.hpp"
#include "results/result_files.hpp"
#include "results/results_index.hpp"
#include "results/setting_names.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/scene/dataset_files.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::results {
namespace {

namespace fs = std::filesystem;

ResultsIndex read_index(const std::string& folder) {
  if (!is_folder(folder)) throw_io_error("{}: is no folder", folder);
  const std::string path = folder + "/index.json";
  if (!path_exists(path))
    throw_io_error(
        "{}: has no index.json, so it is no results folder of model_tubes{}", folder,
        path_exists(folder + "/manifest.jsonl") ? "; it is a data set, which --predictions can be scored on" : "");
  return parse_results_index(read_file(path), path);
}

/// Of the last call, and of the shards of one.
std::map<std::string, std::string> read_failures(const std::string& folder) {
  std::map<std::string, std::string> failures;
  for (const std::string& name : names_in_folder(folder)) {
    const std::string path = folder + "/" + name;
    if (name.starts_with("failures.") && name.ends_with(".jsonl"))
      failures.merge(parse_failures(read_file(path), path));
  }
  return failures;
}

/// A scene of the data set as it is now, and what is known about it.
struct CurrentScene {
  std::string place;
  scene::InputHashes hashes;
  std::optional<scene::SceneRecord> record;
  std::optional<evaluation::SceneTruth> truth;
};

CurrentScene read_scene(const scene::DatasetFiles& dataset, const scene::DatasetHashes& hashes,
                        const std::string& scene) {
  CurrentScene current{dataset.dataset() + "/" + scene, hashes.of(scene), {}, {}};
  if (!dataset.has(scene, "scene.json")) return current;
  const std::string place = dataset.place(scene, "scene.json");
  current.record = scene::parse_scene_json(dataset.read(scene, "scene.json"), place);
  current.truth.emplace(current.record->scene);
  return current;
}

evaluation::RunScore read_run(const std::string& folder, evaluation::RunKey key, const CurrentScene& scene) {
  const std::string path = folder + "/result.json";
  const RunCounts counts = parse_run_counts(read_file(path), path);
  scene::require_same(counts.made_from, scene.hashes, path, scene.place);
  const evaluation::SceneTruth* truth = scene.truth ? &*scene.truth : nullptr;
  if (counts.scene != key.scene)
    throw_io_error("{}: /scene: \"{}\" is not valid; valid: \"{}\", the folder's scene", path, counts.scene, key.scene);
  key.set = counts.set;
  key.tubes = counts.tubes;
  key.case_number = counts.case_number;
  std::vector<evaluation::Centerline> model;
  if (const std::string file = folder + "/model.json"; truth != nullptr && path_exists(file))
    for (evaluation::TubeLine& tube : parse_model_tubes(read_file(file), file))
      model.push_back(std::move(tube.centerline));
  evaluation::RunScore run =
      evaluation::score_run(key, counts.contingency, evaluation::match_segments(counts.contingency), truth, model);
  // Segments without a point in the filtered cloud are tubes of the model all the same.
  run.scores.predicted_tubes = std::max(run.scores.predicted_tubes, counts.model_tubes);
  run.folder = folder;
  if (path_exists(folder + "/filtered.pcd") && path_exists(folder + "/labeled.pcd")) {
    run.filtered = folder + "/filtered.pcd";
    run.labeled = folder + "/labeled.pcd";
  }
  if (const std::string file = folder + "/times.json"; path_exists(file))
    run.seconds = parse_modeling_seconds(read_file(file), file);
  return run;
}

/// A run without a result, with every tube of the scene missed.
evaluation::RunScore failed_run(evaluation::RunKey key, const CurrentScene& scene) {
  evaluation::Contingency contingency;
  if (scene.record) {
    for (std::size_t k = 0; k < scene.record->tube_pixels.size(); ++k) {
      contingency.truth_ids.push_back(static_cast<evaluation::SegmentId>(k + 1));
      contingency.unlabeled.push_back(static_cast<std::int64_t>(scene.record->tube_pixels[k]));
    }
    key.tubes = static_cast<int>(scene.record->scene.tubes.size());
  }
  contingency.counts.resize(static_cast<Eigen::Index>(contingency.truth_ids.size()), 0);
  evaluation::RunScore run = evaluation::score_run(key, contingency, evaluation::match_segments(contingency),
                                                   scene.truth ? &*scene.truth : nullptr, {});
  run.failed = true;
  return run;
}

/// What one scene adds to the evaluation.
struct SceneRuns {
  std::vector<evaluation::RunScore> runs;
  std::vector<std::string> missing;
  std::vector<std::string> failed;
  bool has_truth = false;
};

/// A results folder, and what its methods are called.
struct NamedFolder {
  std::string folder;
  ResultsIndex index;
  std::string setting;       ///< empty: it is not compared with another
  bool has_methods = false;  ///< several methods are there, each in this setting

  std::string name_of(const std::string& method) const {
    return setting.empty() ? method : has_methods ? method + ", " + setting : setting;
  }
};

SceneRuns read_scene_runs(const NamedFolder& named, const CurrentScene& current, const std::string& scene,
                          const std::map<std::string, std::string>& failures) {
  const auto& [folder, index, setting, has_methods] = named;
  SceneRuns result;
  result.has_truth = current.truth.has_value();
  for (const std::string& method : index.methods) {
    for (const double ratio : index.ratios) {
      evaluation::RunKey key = evaluation::parse_scene_name(scene);
      key.method = named.name_of(method);
      key.ratio = ratio;
      const std::string run = run_folder(scene, method, ratio);
      if (path_exists(folder + "/" + run)) {
        result.runs.push_back(read_run(folder + "/" + run, key, current));
        if (current.truth) result.runs.back().dataset = index.dataset;
      } else if (const auto failure = failures.find(run); failure != failures.end()) {
        result.runs.push_back(failed_run(key, current));
        result.failed.push_back(fmt::format("{}: {}", key.name(), failure->second));
      } else {
        result.missing.push_back(key.name());
      }
    }
  }
  return result;
}

void append(evaluation::Evaluation& evaluation, SceneRuns& scene) {
  const auto move_all = [](auto& from, auto& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move_all(scene.runs, evaluation.runs);
  move_all(scene.missing, evaluation.missing);
  move_all(scene.failed, evaluation.failed);
}

/// The runs that a folder has or is to have.
struct FolderRuns {
  const NamedFolder* named;
  std::set<std::string> names;
};

std::vector<NamedFolder> name_folders(const std::vector<std::string>& folders, const ResultsOptions& options) {
  std::vector<IndexedFolder> indexed;
  std::set<std::string> methods;
  for (const std::string& folder : folders) {
    indexed.push_back({folder, read_index(folder)});
    methods.insert(indexed.back().index.methods.begin(), indexed.back().index.methods.end());
  }
  const std::vector<std::string> names = setting_names(indexed, options.names);
  std::vector<NamedFolder> named;
  for (std::size_t i = 0; i < folders.size(); ++i)
    named.push_back({folders[i], std::move(indexed[i].index), names[i], methods.size() > 1});
  for (NamedFolder& folder : named)
    folder.index.dataset = options.dataset.empty()
                               ? (fs::path(folder.folder) / folder.index.dataset).lexically_normal().string()
                               : options.dataset;
  return named;
}

std::vector<SceneRuns> read_scenes(const NamedFolder& named, const ResultsOptions& options) {
  const ResultsIndex& index = named.index;
  const std::map<std::string, std::string> failures = read_failures(named.folder);
  const scene::DatasetFiles dataset(index.dataset);
  const scene::DatasetHashes hashes(dataset);
  std::vector<SceneRuns> scenes(index.scenes.size());
  evaluation::parallel_for(
      scenes.size(), options.jobs,
      [&](std::size_t i) {
        const std::string& scene = index.scenes[i];
        scenes[i] = read_scene_runs(named, read_scene(dataset, hashes, scene), scene, failures);
      },
      options.on_progress);
  return scenes;
}

std::string describe_folder(const NamedFolder& named) {
  const std::string config = named.index.dataset + "/config.yaml";
  const std::string name = named.setting.empty() ? "" : fmt::format(" ({})", named.setting);
  return fmt::format("{}{}:\n{}\n", named.folder, name, named.index.configuration()) +
         (path_exists(config) ? fmt::format("\n{}:\n{}\n", config, read_file(config)) : "");
}

/// One folder's runs, added to the evaluation.
FolderRuns read_folder(const NamedFolder& named, const ResultsOptions& options, evaluation::Evaluation& evaluation) {
  std::vector<SceneRuns> scenes = read_scenes(named, options);
  FolderRuns read{.named = &named, .names = {}};
  const std::size_t runs_before = evaluation.runs.size();
  const std::size_t missing_before = evaluation.missing.size();
  std::size_t without_truth = 0;
  for (SceneRuns& scene : scenes) {
    without_truth += scene.has_truth ? 0 : 1;
    append(evaluation, scene);
  }
  if (evaluation.runs.size() == runs_before)
    throw_io_error("{}: has none of the runs that its index.json names", named.folder);
  if (without_truth > 0)
    evaluation.notes.push_back(
        fmt::format("{} of {} scenes have no scene.json in {}: they add nothing to centreline errors and "
                    "visibility (--dataset "
                    "DIR says where the data set is)",
                    without_truth, scenes.size(), named.index.dataset));
  evaluation.source += (evaluation.source.empty() ? "" : ", ") + named.folder;
  evaluation.configuration += describe_folder(named);
  for (std::size_t i = runs_before; i < evaluation.runs.size(); ++i) read.names.insert(evaluation.runs[i].key.name());
  read.names.insert(evaluation.missing.begin() + static_cast<std::ptrdiff_t>(missing_before), evaluation.missing.end());
  return read;
}

/// Folders that are to have the same run are shards of one call, and then they must have been made alike.
void require_same_conditions(const std::vector<FolderRuns>& folders) {
  std::map<std::string, const NamedFolder*> asked;
  for (const FolderRuns& folder : folders)
    for (const std::string& name : folder.names) {
      const NamedFolder& other = *asked.try_emplace(name, folder.named).first->second;
      if (&other != folder.named && other.index.conditions() != folder.named->index.conditions())
        throw_io_error("{} and {}: both are to have the run {}, but with {}; give them different names (--name)",
                       other.folder, folder.named->folder, name, describe_difference(other.index, folder.named->index));
    }
}

void require_distinct_runs(const evaluation::Evaluation& evaluation) {
  std::set<std::string> names;
  for (const evaluation::RunScore& run : evaluation.runs)
    if (!names.insert(run.key.name()).second)
      throw_io_error("{}: the run {} is there twice; --name A --name B gives each folder a name and compares them",
                     evaluation.source, run.key.name());
}

/// Each shard's index asks for all runs of the call; what no folder has is missing, once.
void keep_really_missing(evaluation::Evaluation& evaluation) {
  std::set<std::string> known;
  for (const evaluation::RunScore& run : evaluation.runs) known.insert(run.key.name());
  std::erase_if(evaluation.missing, [&](const std::string& name) { return !known.insert(name).second; });
}

/// As they would stand in the index of one folder: scenes in order, then methods and ratios.
void sort_runs(evaluation::Evaluation& evaluation) {
  std::ranges::stable_sort(evaluation.runs, {}, [](const evaluation::RunScore& run) {
    return std::tuple(run.key.tubes, run.key.set, run.key.case_number, run.key.scene);
  });
}

/// The folders of each call that lacks runs.
std::vector<std::vector<std::string>> unfinished_calls(const std::vector<FolderRuns>& folders,
                                                       const std::vector<std::string>& missing) {
  std::map<std::string, std::vector<std::string>> calls;
  std::set<std::string> unfinished;
  for (const FolderRuns& folder : folders) {
    const std::string& setting = folder.named->setting;
    calls[setting].push_back(folder.named->folder);
    if (std::any_of(missing.begin(), missing.end(),
                    [&](const std::string& name) { return folder.names.contains(name); }))
      unfinished.insert(setting);
  }
  std::vector<std::vector<std::string>> commands;
  for (const std::string& setting : unfinished) commands.push_back(calls[setting]);
  return commands;
}

}  // namespace

evaluation::Evaluation read_results(const std::vector<std::string>& folders, const ResultsOptions& options) {
  const std::vector<NamedFolder> named = name_folders(folders, options);
  evaluation::Evaluation evaluation;
  std::vector<FolderRuns> read;
  for (const NamedFolder& folder : named) read.push_back(read_folder(folder, options, evaluation));
  require_same_conditions(read);
  require_distinct_runs(evaluation);
  if (folders.size() > 1) {
    keep_really_missing(evaluation);
    sort_runs(evaluation);
  }
  evaluation.unfinished_calls = unfinished_calls(read, evaluation.missing);
  return evaluation;
}

}  // namespace tubebin::results
