#include "tubebin/dataset/verify_dataset.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include "dataset/verify_scene.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/jobs/batch.hpp"

namespace tubebin::dataset {
namespace {

jobs::AttemptResult check_scene(const scene::DatasetFiles& files, const DatasetConfig& config, const SceneId& id,
                                const ManifestRecord& record) {
  return jobs::successful_attempt(fmt::format("{}", fmt::join(verify_scene(files, config, id, record), "\n")));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void add_damaged(VerificationReport& report, const SceneId& id, const std::vector<std::string>& problems) {
  report.damaged.push_back(id);
  for (const std::string& problem : problems) report.problems.push_back(id.name() + ": " + problem);
}

void add_outcome(VerificationReport& report, const SceneId& id, const jobs::JobOutcome& outcome) {
  ++report.checked;
  if (!outcome.succeeded)
    add_damaged(report, id, {fmt::format("could not be checked: {}", outcome.failed.back().detail)});
  else if (!outcome.text.empty()) add_damaged(report, id, lines_of(outcome.text));
}

}  // namespace

VerificationReport verify_dataset(const std::string& folder, int jobs, jobs::Progress::Style progress_style) {
  const DatasetConfig config = read_dataset_config(folder);
  require_own_version(config, folder);
  const jobs::FolderLock lock(folder);
  const Manifest manifest(folder);
  const scene::DatasetFiles files(folder);
  VerificationReport report;
  report.problems = manifest.damaged_lines();

  const std::vector<SceneId> scenes = list_scenes(config);
  std::vector<std::size_t> recorded;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (manifest.find(scenes[i].name()) != nullptr) recorded.push_back(i);
    else if (path_exists(folder + "/" + scenes[i].name())) add_damaged(report, scenes[i], {"is not in the manifest"});
    else ++report.missing;
  }

  report.signal =
      jobs::run_batch(
          {.size = recorded.size(),
           .noun = "scenes",
           .pool = {.workers = jobs, .attempts_max = 1, .attempt_time_limit = config.attempt_time_limit},
           .progress = progress_style,
           .work =
               [&](std::size_t job, int) {
                 const SceneId& id = scenes[recorded[job]];
                 return check_scene(files, config, id, *manifest.find(id.name()));
               },
           .on_finished =
               [&](const jobs::JobOutcome& outcome) { add_outcome(report, scenes[recorded[outcome.job]], outcome); }})
          .signal;
  std::sort(report.problems.begin(), report.problems.end());
  std::sort(report.damaged.begin(), report.damaged.end());
  return report;
}

void forget_damage(DatasetFolder& folder, const VerificationReport& report) {
  std::set<std::string> names;
  for (const SceneId& id : report.damaged) names.insert(id.name());
  folder.manifest().rewrite_without(names);
}

}  // namespace tubebin::dataset
