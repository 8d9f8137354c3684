#include "tubebin/results/model_dataset.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "core/json_writer.hpp"
#include "results/result_files.hpp"
#include "results/results_index.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/core/utf8.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/evaluation/run_score.hpp"
#include "tubebin/jobs/atomic_folder.hpp"
#include "tubebin/jobs/batch.hpp"
#include "tubebin/jobs/folder_lock.hpp"
#include "tubebin/modeling/model_json.hpp"
#include "tubebin/results/cloud_files.hpp"
#include "tubebin/results/modeling_run.hpp"

namespace tubebin::results {
namespace {

using Json = nlohmann::ordered_json;

/// The data set's clouds, of each set and number of tubes the first ones alone where options say so.
std::vector<CloudFile> choose_clouds(const scene::DatasetFiles& files, const BatchOptions& options) {
  std::vector<CloudFile> clouds = find_clouds(files);
  if (!options.scenes.empty()) {
    const std::set<std::string> wanted(options.scenes.begin(), options.scenes.end());
    std::erase_if(clouds, [&](const CloudFile& cloud) { return !wanted.contains(cloud.scene); });
  }
  if (options.cases > 0) {
    std::map<std::string, int> taken;
    std::erase_if(clouds, [&](const CloudFile& cloud) {
      return ++taken[cloud.scene.substr(0, cloud.scene.find('/'))] > options.cases;
    });
  }
  return clouds;
}

void add_contingency(Json& json, const CloudToModel& input, const modeling::ModelingResult& result) {
  const std::vector<cloud::Label> truth = truth_labels(input);
  if (truth.empty()) return;
  std::map<std::pair<cloud::Label, cloud::Label>, std::size_t> counts;
  std::map<cloud::Label, std::size_t> truth_points;
  if (input.scene)
    for (cloud::Label k = 0; k <= input.scene->scene.tubes.size(); ++k) truth_points[k] = 0;
  for (std::size_t k = 0; k < result.source.size(); ++k) {
    const cloud::Label label = truth[result.source[k]];
    ++counts[{label, result.labels[k]}];
    ++truth_points[label];
  }
  json["truth_labels"] = Json::array();
  json["truth_points"] = Json::array();
  for (const auto& [label, points] : truth_points) {
    json["truth_labels"].push_back(label);
    json["truth_points"].push_back(points);
  }
  json["contingency"] = Json::array();
  for (const auto& [pair, points] : counts) json["contingency"].push_back({pair.first, pair.second, points});
}

std::string format_result(const ModelingRun& run, const CloudToModel& input, const modeling::ModelingResult& result,
                          std::uint64_t seed) {
  const evaluation::RunKey name = evaluation::parse_scene_name(run.scene);
  const std::size_t tubes = input.scene ? input.scene->scene.tubes.size() : static_cast<std::size_t>(name.tubes);
  const auto unlabeled = std::count(result.labels.begin(), result.labels.end(), cloud::Label{0});
  Json json = {{"format", "tubebin result 1"},
               {"scene", run.scene},
               {"set", name.set},
               {"tubes", tubes},
               {"case", name.case_number},
               {"method", name_of(run.method)},
               {"ratio", run.ratio},
               {"seed", seed},
               {"cloud_points", std::count_if(input.cloud.points.begin(), input.cloud.points.end(), cloud::is_finite)},
               {"filtered_points", result.labels.size()},
               {"labeled_points", result.labels.size() - static_cast<std::size_t>(unlabeled)},
               {"model_tubes", result.tubes.size()},
               {"cloud_xxh128", input.hashes.cloud_xxh128},
               {"scene_json_xxh128", input.hashes.scene_json_xxh128}};
  add_contingency(json, input, result);
  return json.dump() + "\n";
}

/// What all runs of a call read from and write to.
struct Batch {
  const scene::DatasetFiles& dataset;
  scene::DatasetHashes hashes;
  OutputFolder results;
};

/// In a worker process, on one core.
jobs::AttemptResult do_run(const ModelingRun& run, const Batch& batch, const BatchOptions& options,
                           const ModelConfig& config) {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  CloudToModel input;
  modeling::ModelingResult result;
  ModelConfig own = run_config(config, run);
  try {
    input = read_cloud_to_model(batch.dataset, {run.scene, run.cloud});
    batch.hashes.require_recorded(run.scene, input.hashes);
    result = model_cloud(input, own);
  } catch (const IoError& error) {
    return jobs::failed_attempt("unreadable", error.what());  // this cloud's fault: the others go on
  }
  std::map<std::string, std::string> files;
  files["model.json"] = modeling::format_model_json(
      result, model_colors(result), [&](Fields& fields) { describe(fields, own); }, false);
  files["times.json"] = modeling::format_times_json(result.seconds, input.read_seconds);
  files["result.json"] = format_result(run, input, result, own.modeling.seed);
  if (options.keep_clouds) {
    files["filtered.pcd"] =
        cloud::format_cloud(filtered_cloud(input.cloud, result), cloud::CloudFormat::pcd_compressed);
    files["labeled.pcd"] = cloud::format_cloud(labeled_cloud(input.cloud, result), cloud::CloudFormat::pcd_compressed);
  }
  return jobs::successful_attempt([finish = jobs::begin_whole_folder(batch.results, run.folder(), files)] {
    finish();
    return std::string();
  });
}

std::string relative_dataset(const BatchOptions& options) {
  std::string path = relative_path(options.dataset, options.results);
  if (!is_utf8(path))
    throw_io_error("{}: its path is no UTF-8 text, which {} needs; give the data set another name", options.dataset,
                   kResultsIndexFile);
  return path;
}

ResultsIndex index_of(const BatchOptions& options, const ModelConfig& config, const std::vector<CloudFile>& clouds) {
  ResultsIndex index{.tool_version = tool_version(),
                     .dataset = relative_dataset(options),
                     .methods = {},
                     .ratios = options.ratios,
                     .seed = config.modeling.seed,
                     .scenes = {},
                     .options = {}};
  for (const CloudFile& cloud : clouds) index.scenes.push_back(cloud.scene);
  for (const modeling::ModelingMethod method : options.methods) index.methods.push_back(name_of(method));
  ModelConfig described = config;
  index.options = fields_to_json([&](Fields& fields) { describe(fields, described); });
  return index;
}

/// Those whose runs this call does.
std::vector<CloudFile> clouds_of_shard(const std::vector<CloudFile>& all, const BatchOptions& options) {
  if (!options.shard) return all;
  std::vector<std::int64_t> costs;
  for (const CloudFile& cloud : all)
    costs.push_back(jobs::modeling_cost(evaluation::parse_scene_name(cloud.scene).tubes));
  std::vector<CloudFile> own;
  std::int64_t cost = 0;
  for (const std::size_t i : items_of_shard(costs, *options.shard)) {
    own.push_back(all[i]);
    cost += costs[i];
  }
  const std::int64_t whole = std::accumulate(costs.begin(), costs.end(), std::int64_t{0});
  options.on_shard(own.size(), all.size(), static_cast<double>(cost) / static_cast<double>(whole));
  return own;
}

/// All shards of a call write the same index, whose scenes are those of the whole call.
void write_index(const OutputFolder& results, const ResultsIndex& wanted) {
  const std::string path = results.place(kResultsIndexFile);
  const FolderEntry entry = results.make_entry(kResultsIndexFile);
  if (!path_exists(path) && create_atomically(entry, format_results_index(wanted))) return;
  const std::string held = read_file(path);
  const std::string merged = format_results_index(merge_results_index(parse_results_index(held, path), wanted, path));
  if (merged != held) write_atomically(entry, merged);
}

ConfinedPath failures_file(const BatchOptions& options) {
  return options.shard ? "failures." + options.shard->name() + ".jsonl" : "failures.jsonl";
}

std::string format_failure(const ModelingRun& run, const std::string& why) {
  return Json{{"scene", run.scene}, {"method", name_of(run.method)}, {"ratio", run.ratio}, {"error", why}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

std::vector<ModelingRun> list_runs(const BatchOptions& options, const std::vector<CloudFile>& clouds) {
  std::vector<ModelingRun> runs;
  for (const auto& [scene, file] : clouds)
    for (const modeling::ModelingMethod method : options.methods)
      for (const double ratio : options.ratios) runs.push_back({scene, file, method, ratio});
  return runs;
}

/// Which runs one of the results folders has already, of the clouds as they are now.
class CompleteRuns {
 public:
  CompleteRuns(const BatchOptions& options, const scene::DatasetHashes& hashes)
      : folders_(options.other_results), hashes_(hashes) {
    folders_.insert(folders_.begin(), options.results);
  }

  bool contains(const ModelingRun& run) {
    return std::ranges::any_of(folders_, [&](const std::string& folder) {
      const std::string path = fmt::format("{}/{}/result.json", folder, run.folder());
      return path_exists(path) && is_current(path, run);
    });
  }

 private:
  bool is_current(const std::string& path, const ModelingRun& run) try {
    const auto known = hashes_of_scene_.find(run.scene);
    const scene::InputHashes& now =
        known != hashes_of_scene_.end() ? known->second : hashes_of_scene_[run.scene] = hashes_.of(run.scene);
    return parse_run_counts(read_file(path), path).made_from == now;
  } catch (const IoError&) {  // a result that can't be read is none
    return false;
  }

  std::vector<std::string> folders_;
  const scene::DatasetHashes& hashes_;
  std::map<std::string, scene::InputHashes> hashes_of_scene_;
};

/// Removes what a killed run left of the runs that it was writing; at the end, too, what an interrupted one leaves.
class UnfinishedCleanup {
 public:
  UnfinishedCleanup(const OutputFolder& results, bool is_shard, const std::vector<CloudFile>& clouds)
      : results_(results), is_shard_(is_shard), clouds_(clouds) {
    remove();
  }
  ~UnfinishedCleanup() try {
    // For a shard the next call does it: another host may have been given this one's work.
    if (!is_shard_) remove();
  } catch (const std::exception&) {  // the next call tries again
  }
  UnfinishedCleanup(const UnfinishedCleanup&) = delete;
  UnfinishedCleanup& operator=(const UnfinishedCleanup&) = delete;

 private:
  void remove() const {
    for (const CloudFile& cloud : clouds_) jobs::remove_unfinished(results_, cloud.scene);
    if (!is_shard_) jobs::remove_unfinished(results_, {});
  }

  const OutputFolder& results_;
  bool is_shard_;
  const std::vector<CloudFile>& clouds_;
};

}  // namespace

BatchReport model_dataset(const BatchOptions& options, const ModelConfig& config,
                          jobs::Progress::Style progress_style) {
  const auto start = std::chrono::steady_clock::now();
  const scene::DatasetFiles dataset(options.dataset);
  const auto all_clouds = choose_clouds(dataset, options);
  const auto clouds = clouds_of_shard(all_clouds, options);
  const Batch batch{dataset, scene::DatasetHashes(dataset), OutputFolder(options.results)};
  const jobs::FolderLock lock(batch.results,
                              options.shard ? jobs::FolderLock::Kind::shard : jobs::FolderLock::Kind::exclusive);
  const ResultsIndex index = index_of(options, config, all_clouds);
  write_index(batch.results, index);
  const UnfinishedCleanup cleanup(batch.results, options.shard.has_value(), clouds);

  const std::vector<ModelingRun> runs = list_runs(options, clouds);
  CompleteRuns complete(options, batch.hashes);
  BatchReport report{.runs = runs.size(), .failed = {}};
  std::string failures;
  const auto add_failure = [&](const ModelingRun& run, const std::string& why) {
    report.failed.push_back(fmt::format("{}: {}", run.folder(), why));
    failures += format_failure(run, why) + "\n";
  };
  std::vector<std::size_t> made;
  const jobs::BatchReport done =
      jobs::run_batch({.size = runs.size(),
                       .noun = "clouds",
                       .pool = {.workers = options.jobs, .attempts_max = 1, .attempt_time_limit = options.time_limit},
                       .progress = progress_style,
                       .is_done = [&](std::size_t job) { return complete.contains(runs[job]); },
                       .work = [&](std::size_t job, int) { return do_run(runs[job], batch, options, config); },
                       .on_finished =
                           [&](const jobs::JobOutcome& outcome) {
                             if (outcome.succeeded) made.push_back(outcome.job);
                             else add_failure(runs[outcome.job], outcome.failed.back().for_people());
                           }});
  for (const std::size_t i : made)
    if (!batch.results.has_folder(runs[i].folder())) add_failure(runs[i], "was removed after it was made");
  write_index(batch.results, index);
  const FolderEntry failures_entry = batch.results.make_entry(failures_file(options));
  if (!failures.empty()) write_atomically(failures_entry, failures);
  else remove_entry(failures_entry);
  report.complete_before = done.done_before;
  report.made = done.made;
  report.signal = done.signal;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace tubebin::results
