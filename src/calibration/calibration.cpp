#include "tubebin/calibration/calibration.hpp"

#include <chrono>
#include <cmath>
#include <map>

#include "calibration/calibration_trials.hpp"
#include "evaluation/statistics.hpp"
#include "jobs/stop_note.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/core/shuffle.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/jobs/folder_lock.hpp"
#include "tubebin/results/cloud_files.hpp"

namespace tubebin::calibration {
namespace {

struct Split {
  std::vector<results::CloudFile> training, held_back;
};

/// Of the scenes with the same set and number of tubes the same share is held back. The training scenes' order is
/// random, so that the first of them stand for all.
Split split_scenes(const scene::DatasetFiles& dataset, const CalibrationOptions& options) {
  std::map<std::string, std::vector<results::CloudFile>> groups;
  const std::vector<results::CloudFile> clouds = results::find_clouds(dataset);
  for (const results::CloudFile& cloud : clouds) groups[cloud.scene.substr(0, cloud.scene.find('/'))].push_back(cloud);
  Random random(options.seed);
  Split split;
  std::size_t seen = 0;
  for (auto& [group, members] : groups) {
    shuffle(members, random);
    for (const results::CloudFile& cloud : members) {
      const auto wanted = static_cast<std::size_t>(std::round(static_cast<double>(++seen) * options.held_back));
      (split.held_back.size() < wanted ? split.held_back : split.training).push_back(cloud);
    }
  }
  shuffle(split.training, random);
  if (split.training.empty() || split.held_back.empty())
    throw_config_error("{}: its {} scenes give {} to tune on and {} to hold back; both need at least one",
                       options.dataset, clouds.size(), split.training.size(), split.held_back.size());
  return split;
}

std::vector<results::ModelingRun> runs_of(const std::vector<results::CloudFile>& clouds,
                                          modeling::ModelingMethod method, const std::vector<double>& ratios) {
  std::vector<results::ModelingRun> runs;
  for (const auto& [scene, file] : clouds)
    for (const double ratio : ratios) runs.push_back({scene, file, method, ratio});
  return runs;
}

std::vector<std::string> names_of(const std::vector<results::CloudFile>& clouds) {
  std::vector<std::string> names;
  for (const results::CloudFile& cloud : clouds) names.push_back(cloud.scene);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<TunedParameter> choose_parameters(const CalibrationOptions& options, modeling::ModelingMethod method) {
  if (options.parameters.empty()) {
    std::vector<TunedParameter> parameters = default_parameters(method);
    if (parameters.empty())
      throw_config_error("method {} has no parameters of its own to tune; name some with --parameter", name_of(method));
    return parameters;
  }
  for (std::size_t i = 0; i < options.parameters.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (options.parameters[i].key == options.parameters[j].key)
        throw_config_error("--parameter {} is there twice", options.parameters[i].key);
  return options.parameters;
}

/// Where the configuration came from, for whoever finds it later. No times, so that the same call gives the same bytes.
std::string describe_origin(const CalibrationReport& report, const CalibrationOptions& options) {
  std::string text = fmt::format(
      "# Made by calibrate_modeler {} on {} scenes, measured on {} others (seed {}, {} settings tried).\n"
      "# Mean micro-recall       before   after\n"
      "# of {:4} training runs   {:.4f}   {:.4f}\n"
      "# of {:4} held-back runs  {:.4f}   {:.4f}, {:+.4f} +- {:.4f} (standard error)\n"
      "# Tuned:\n",
      tool_version(), report.training_scenes.size(), report.held_back_scenes.size(), options.seed, report.setting_count,
      report.training.before.size(), report.training.mean_before(), report.training.mean_after(),
      report.held_back.before.size(), report.held_back.mean_before(), report.held_back.mean_after(),
      report.held_back.mean_gain(), report.held_back.gain_error());
  for (std::size_t p = 0; p < report.parameters.size(); ++p)
    text += fmt::format("#   {} {} -> {} (from {} to {})\n", report.parameters[p].key, report.before[p],
                        report.after[p], report.parameters[p].range.low, report.parameters[p].range.high);
  if (!report.is_recommended())
    text += "# Not recommended: worse on the scenes that were held back than the configuration it began with.\n";
  return text + "\n";
}

void write_output(const CalibrationReport& report, const CalibrationOptions& options,
                  const results::ModelConfig& start) {
  results::ModelConfig tuned = apply_setting(start, report.parameters, report.after);
  write_file_atomically(
      options.output, describe_origin(report, options) + write_yaml([&](Fields& fields) { describe(fields, tuned); }));
}

void calibrate(const CalibrationOptions& options, const results::ModelConfig& start, const Split& split,
               CalibrationTrials& trials, CalibrationReport& report) {
  const modeling::ModelingMethod method = start.modeling.method;
  const std::vector<results::ModelingRun> training = runs_of(split.training, method, options.ratios);
  const std::vector<results::ModelingRun> held_back = runs_of(split.held_back, method, options.ratios);
  std::vector<SearchRange> ranges;
  for (const TunedParameter& parameter : report.parameters) ranges.push_back(parameter.range);

  const auto score = [&](const std::vector<Setting>& settings, std::size_t run_count) {
    std::vector<double> scores;
    const std::vector<results::ModelingRun> first(training.begin(),
                                                  training.begin() + static_cast<std::ptrdiff_t>(run_count));
    for (const std::vector<double>& recalls : trials.recalls(settings, first))
      scores.push_back(evaluation::mean(recalls));
    return scores;
  };
  const SearchResult found = search_parameters(
      ranges, report.before, {.run_count = training.size(), .budget = options.budget, .seed = options.seed}, score);

  report.after = found.best;
  report.setting_count = found.setting_count;
  const auto compare = [&](const std::vector<results::ModelingRun>& runs) {
    const auto recalls = trials.recalls({report.before, report.after}, runs);
    return BeforeAfter{recalls[0], recalls[1]};
  };
  report.training = compare(training);
  report.held_back = compare(held_back);
  write_output(report, options, start);
}

}  // namespace

double BeforeAfter::mean_before() const { return evaluation::mean(before); }
double BeforeAfter::mean_after() const { return evaluation::mean(after); }

double BeforeAfter::gain_error() const {
  if (before.size() < 2) return 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) squares += std::pow(after[i] - before[i] - mean_gain(), 2);
  const auto count = static_cast<double>(before.size());
  return std::sqrt(squares / (count - 1.0) / count);
}

CalibrationReport calibrate_modeler(const CalibrationOptions& options, const results::ModelConfig& start,
                                    jobs::Progress::Style progress_style) {
  const auto began = std::chrono::steady_clock::now();
  CalibrationReport report;
  report.parameters = choose_parameters(options, start.modeling.method);
  report.before = setting_of(start, report.parameters);
  const scene::DatasetFiles dataset(options.dataset);
  const Split split = split_scenes(dataset, options);
  report.training_scenes = names_of(split.training);
  report.held_back_scenes = names_of(split.held_back);

  const std::string folder = options.output + ".trials";
  const OutputFolder trials_folder(folder);
  const jobs::FolderLock lock(trials_folder);
  const double scored =
      options.budget * static_cast<double>(split.training.size()) + 2.0 * static_cast<double>(split.held_back.size());
  jobs::Progress progress(static_cast<std::size_t>(scored * static_cast<double>(options.ratios.size())), "clouds",
                          progress_style);
  const jobs::StopNote stop_note;  // until now there was nothing that a signal could lose
  CalibrationTrials trials(trials_folder, options, dataset, start, report.parameters, progress);
  try {
    calibrate(options, start, split, trials, report);
  } catch (const CalibrationStopped& stopped) {
    report.signal = stopped.signal;
  }
  report.runs_made = trials.runs_made();
  report.runs_before = trials.runs_before();
  report.failed_runs = trials.failed_runs();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return report;
}

}  // namespace tubebin::calibration
