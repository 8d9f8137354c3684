#include "tubebin/dataset/generate_dataset.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>

#include "dataset/scene_packer.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/jobs/batch.hpp"

namespace tubebin::dataset {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// In a worker process: one attempt at a scene, whose folder is complete when `finish` has returned.
jobs::AttemptResult make_scene(const DatasetFolder& folder, const SceneId& id, int attempt) {
  GeneratedScene scene = generate_scene(folder.config(), id, attempt);
  if (!scene.failure.empty()) return jobs::failed_attempt(scene.failure, scene.failure_detail);

  ManifestRecord record{.id = id.name(),
                        .tubes = id.tubes,
                        .seed = scene.content.record.seed,
                        .rejected = {},
                        .seconds = std::move(scene.seconds),
                        .physics = scene.physics,
                        .files = {}};
  const auto start = std::chrono::steady_clock::now();
  const auto complete = folder.store().begin_write(record.id, scene.content);
  record.seconds["write"] = seconds_since(start);
  return jobs::successful_attempt([complete, record]() mutable {
    const auto wait_start = std::chrono::steady_clock::now();
    record.files = complete();
    record.seconds["wait_for_disk"] = seconds_since(wait_start);
    return format_manifest_record(record);
  });
}

std::string describe_failure(const SceneId& id, const jobs::JobOutcome& outcome) {
  std::map<std::string, int> reasons;
  for (const jobs::FailedAttempt& attempt : outcome.failed) ++reasons[attempt.reason];
  std::vector<std::string> parts;
  for (const auto& [reason, count] : reasons) parts.push_back(fmt::format("{} {}", count, reason));
  const jobs::FailedAttempt& last = outcome.failed.back();
  return fmt::format("{}: given up after {} attempts ({}); last: {}", id.name(), outcome.failed.size(),
                     fmt::join(parts, ", "), last.for_people());
}

void record_scene(DatasetFolder& folder, const jobs::JobOutcome& outcome) {
  ManifestRecord record = parse_manifest_record(outcome.text);
  record.rejected = outcome.failed;
  const auto preview = record.seconds.find("preview");
  record.seconds["total"] = outcome.seconds - (preview == record.seconds.end() ? 0.0 : preview->second);
  folder.manifest().append(record);
}

/// Scenes that were made and are not there: somebody removed them meanwhile.
void add_lost(GenerationReport& report, const DatasetFolder& folder, const std::vector<SceneId>& scenes,
              const std::vector<std::size_t>& made) {
  for (const std::size_t i : made)
    if (!folder.is_complete(scenes[i].name()))
      report.failed.push_back(fmt::format("{}: was removed after it was made", scenes[i].name()));
}

}  // namespace

std::size_t GenerationReport::rejects_total() const {
  return static_cast<std::size_t>(std::accumulate(rejects.begin(), rejects.end(), 0,
                                                  [](int sum, const auto& entry) { return sum + entry.second; }));
}

GenerationReport generate_dataset(DatasetFolder& folder, const std::vector<SceneId>& scenes, int jobs,
                                  jobs::Progress::Style progress_style, const std::string& pack) {
  GenerationReport report;
  std::optional<ScenePacker> packer;
  if (!pack.empty()) packer.emplace(folder, scenes, pack);
  std::vector<std::size_t> made;
  const jobs::BatchReport done =
      jobs::run_batch({.size = scenes.size(),
                       .noun = "scenes",
                       .pool = {.workers = jobs,
                                .attempts_max = folder.config().attempts_max,
                                .attempt_time_limit = folder.config().attempt_time_limit},
                       .progress = progress_style,
                       .is_done = [&](std::size_t job) { return folder.is_complete(scenes[job].name()); },
                       .work = [&](std::size_t job, int attempt) { return make_scene(folder, scenes[job], attempt); },
                       .on_finished =
                           [&](const jobs::JobOutcome& outcome) {
                             if (outcome.succeeded) made.push_back(outcome.job);
                             if (outcome.succeeded) record_scene(folder, outcome);
                             else report.failed.push_back(describe_failure(scenes[outcome.job], outcome));
                             if (packer && outcome.succeeded) packer->add(outcome.job);
                             else if (packer) packer->give_up(outcome.job);
                           },
                       .on_failed_attempt =
                           [&](std::size_t, const jobs::FailedAttempt& attempt) { ++report.rejects[attempt.reason]; }});
  if (packer) packer->finish(done.signal == 0);
  folder.restore_config();
  add_lost(report, folder, scenes, made);
  report.complete_before = done.done_before;
  report.signal = done.signal;
  report.made = done.made;
  report.seconds = done.seconds;
  return report;
}

}  // namespace tubebin::dataset
