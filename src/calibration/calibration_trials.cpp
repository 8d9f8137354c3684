#include "calibration/calibration_trials.hpp"

#include <tbb/global_control.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/json_reader.hpp"
#include "core/number_fields.hpp"
#include "jobs/stop_note.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/evaluation/micro_recall.hpp"

namespace tubebin::calibration {
namespace {

using Json = nlohmann::ordered_json;

/// All that a recall depends on beside what each line of the journal says.
std::string format_header(const results::ModelConfig& start) {
  results::ModelConfig config = start;
  Json options = Json::object();
  for (const auto& [key, value] : list_fields([&](Fields& fields) { describe(fields, config); }))
    if (key != "filtering.ratio") options[key] = value;
  return Json{{"format", "tubebin calibration 1"}, {"tool_version", tool_version()}, {"options", options}}.dump();
}

double micro_recall_of(const results::CloudToModel& input, const modeling::ModelingResult& result) {
  const std::vector<cloud::Label> truth = results::truth_labels(input);
  std::vector<evaluation::SegmentId> truth_ids, predicted_ids;
  for (std::size_t k = 0; k < result.source.size(); ++k) {
    truth_ids.push_back(truth[result.source[k]]);
    predicted_ids.push_back(result.labels[k]);
  }
  return evaluation::match_segments(evaluation::count_pairs(truth_ids, predicted_ids, evaluation::SegmentId{0}))
      .micro_recall();
}

}  // namespace

results::ModelConfig apply_setting(const results::ModelConfig& config, const std::vector<TunedParameter>& parameters,
                                   const Setting& setting) {
  results::ModelConfig own = config;
  const auto fields = number_fields([&](Fields& visitor) { describe(visitor, own); });
  for (std::size_t p = 0; p < parameters.size(); ++p) fields.at(parameters[p].key).set(setting[p]);
  return own;
}

Setting setting_of(const results::ModelConfig& config, const std::vector<TunedParameter>& parameters) {
  results::ModelConfig own = config;
  const auto fields = number_fields([&](Fields& visitor) { describe(visitor, own); });
  Setting setting;
  for (const TunedParameter& parameter : parameters) setting.push_back(fields.at(parameter.key).get());
  return setting;
}

CalibrationTrials::CalibrationTrials(const OutputFolder& folder, const CalibrationOptions& options,
                                     const scene::DatasetFiles& dataset, const results::ModelConfig& start,
                                     std::vector<TunedParameter> parameters, jobs::Progress& progress)
    : options_(options),
      dataset_(dataset),
      hashes_(dataset),
      start_(start),
      parameters_(std::move(parameters)),
      progress_(progress),
      journal_(folder, "runs.jsonl") {
  read_journal();
}

void CalibrationTrials::read_journal() {
  const std::string header = format_header(start_);
  if (journal_.lines().empty()) return journal_.append(header);
  if (journal_.lines().front() != header)
    throw_config_error("{}: is of another configuration or version; remove its folder or choose another --output",
                       journal_.path());
  for (std::size_t i = 1; i < journal_.lines().size(); ++i) {
    try {
      Json line = parse_ordered_json(journal_.lines()[i], journal_.path());
      const double recall = line.at("micro_recall");
      line.erase("micro_recall");
      line.erase("failed");
      recall_of_[line.dump()] = recall;
    } catch (const std::exception& error) {
      throw_io_error("{}:{}: is no trial: {}; remove the line", journal_.path(), i + 1, error.what());
    }
  }
}

/// The line without its result. The files' hashes are in it, so that no recall is of a scene that was made anew.
CalibrationTrials::Key CalibrationTrials::key_of(const Setting& setting, const results::ModelingRun& run) {
  Json values = Json::object();
  for (std::size_t p = 0; p < parameters_.size(); ++p) values[parameters_[p].key] = setting[p];
  const scene::InputHashes& hashes = hashes_of(run);
  return Json{{"scene", run.scene},
              {"cloud", hashes.cloud_xxh128},
              {"scene_json", hashes.scene_json_xxh128},
              {"ratio", run.ratio},
              {"setting", values}}
      .dump();
}

/// Reading a pack takes its time, in which a signal is heard.
const scene::InputHashes& CalibrationTrials::hashes_of(const results::ModelingRun& run) {
  if (const int signal = jobs::StopNote::received(); signal != 0) throw CalibrationStopped{signal};
  const auto known = hashes_of_scene_.find(run.scene);
  return known != hashes_of_scene_.end() ? known->second : hashes_of_scene_[run.scene] = hashes_.of(run.scene);
}

std::vector<std::vector<double>> CalibrationTrials::recalls(const std::vector<Setting>& settings,
                                                            const std::vector<results::ModelingRun>& runs) {
  std::vector<Trial> missing;
  std::vector<std::vector<Key>> keys;
  std::set<Key> wanted;
  for (const Setting& setting : settings) {
    keys.emplace_back();
    for (const results::ModelingRun& run : runs) {
      const Key key = key_of(setting, run);
      keys.back().push_back(key);
      if (!recall_of_.contains(key)) {
        if (wanted.insert(key).second) missing.push_back({setting, run, key});
      } else if (!std::exchange(used_[key], true)) {
        ++runs_before_;
        progress_.count_done();
      }
    }
  }
  find_missing(missing);
  std::vector<std::vector<double>> recalls;
  for (const std::vector<Key>& of_setting : keys) {
    recalls.emplace_back();
    for (const Key& key : of_setting) recalls.back().push_back(recall_of_.at(key));
  }
  return recalls;
}

void CalibrationTrials::find_missing(const std::vector<Trial>& missing) {
  if (const int signal = jobs::StopNote::received(); signal != 0) throw CalibrationStopped{signal};
  if (missing.empty()) return;
  const jobs::BatchReport report =
      jobs::run_batch({.size = missing.size(),
                       .noun = "clouds",
                       .pool = {.workers = options_.jobs, .attempts_max = 1, .attempt_time_limit = options_.time_limit},
                       .shared_progress = &progress_,
                       .work = [&](std::size_t job, int) { return attempt(missing[job]); },
                       .on_finished = [&](const jobs::JobOutcome& outcome) { keep(missing[outcome.job], outcome); }});
  if (report.signal != 0) throw CalibrationStopped{report.signal};
}

/// In a worker process, on one core.
jobs::AttemptResult CalibrationTrials::attempt(const Trial& trial) const {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const results::CloudToModel input = results::read_cloud_to_model(dataset_, {trial.run.scene, trial.run.cloud});
  hashes_.require_recorded(trial.run.scene, input.hashes);
  if (results::truth_labels(input).empty())
    throw_io_error("{}: has no labels, and no colours of a scene.json beside it, to compare with", input.path);
  const results::ModelConfig config = results::run_config(apply_setting(start_, parameters_, trial.setting), trial.run);
  const double recall = micro_recall_of(input, results::model_cloud(input, config));
  return jobs::successful_attempt([recall] { return fmt::format("{}", recall); });
}

void CalibrationTrials::keep(const Trial& trial, const jobs::JobOutcome& outcome) {
  Json line = Json::parse(trial.key);
  if (!outcome.succeeded) {
    const jobs::FailedAttempt& last = outcome.failed.back();
    if (last.reason == "killed")
      throw_io_error("{}: {}", dataset_.place(trial.run.scene, trial.run.cloud), last.detail);
    line["failed"] = last.reason;
    ++failed_;
  }
  const double recall = outcome.succeeded ? std::stod(outcome.text) : 0.0;
  line["micro_recall"] = recall;
  journal_.append(line.dump());
  recall_of_[trial.key] = recall;
  used_[trial.key] = true;
  ++runs_made_;
}

}  // namespace tubebin::calibration
