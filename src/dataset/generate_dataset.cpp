#include "tubebin/dataset/generate_dataset.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "dataset/bins_alone.hpp"
#include "dataset/scene_packer.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/jobs/batch.hpp"

namespace tubebin::dataset {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Scenes of one pile, which one job makes, as a range of the list of scenes.
struct PileScenes {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<PileScenes> group_by_pile(const std::vector<SceneId>& scenes) {
  std::vector<PileScenes> groups;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (i > 0 && scenes[i].pile() == scenes[i - 1].pile()) ++groups.back().end;
    else groups.push_back({i, i + 1});
  }
  return groups;
}

/// Writes a scene, whose folder is complete when the returned function has returned its line of the manifest.
std::function<std::string()> begin_scene(const DatasetFolder& folder, const SceneId& id, GeneratedScene scene) {
  ManifestRecord record{.id = id.name(),
                        .tubes = id.tubes_in_bin(),
                        .seed = scene.content.record.seed,
                        .rejected = {},
                        .seconds = std::move(scene.seconds),
                        .physics = scene.physics,
                        .files = {}};
  const auto start = std::chrono::steady_clock::now();
  const auto complete = folder.store().begin_write(record.id, std::move(scene.content));
  record.seconds["write"] = seconds_since(start);
  return [complete, record]() mutable {
    const auto wait_start = std::chrono::steady_clock::now();
    record.files = complete();
    record.seconds["wait_for_disk"] = seconds_since(wait_start);
    return format_manifest_record(record);
  };
}

/// In a worker process: one attempt at what is not complete of a pile's scenes. All are done when `finish` has returned.
jobs::AttemptResult make_scenes(const DatasetFolder& folder, std::span<const SceneId> scenes, int attempt,
                                BinsAlone& bins_alone) {
  const Piles made = make_piles(folder.config(), scenes.front(), attempt, std::max(scenes.back().step, 0));
  if (!made.failure.empty()) return jobs::failed_attempt(made.failure, made.failure_detail);
  std::vector<std::function<std::string()>> written;
  for (const SceneId& id : scenes) {
    if (folder.is_complete(id.name())) continue;
    GeneratedScene scene = show_pile(made, id, bins_alone.of(made));
    if (!scene.failure.empty()) return jobs::failed_attempt(scene.failure, scene.failure_detail);
    written.push_back(begin_scene(folder, id, std::move(scene)));
  }
  return jobs::successful_attempt([written] {
    std::string lines;
    for (const auto& finish : written) lines += finish() + '\n';
    return lines;
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

/// The first of a pile's scenes tells of the attempts before; all share the time. Returns their names.
std::set<std::string> record_scenes(DatasetFolder& folder, const jobs::JobOutcome& outcome) {
  std::set<std::string> names;
  std::istringstream lines(outcome.text);
  const auto scenes = static_cast<double>(std::ranges::count(outcome.text, '\n'));
  std::vector<jobs::FailedAttempt> rejected = outcome.failed;
  for (std::string line; std::getline(lines, line);) {
    ManifestRecord record = parse_manifest_record(line);
    record.rejected = std::exchange(rejected, {});
    const auto preview = record.seconds.find("preview");
    record.seconds["total"] = outcome.seconds / scenes - (preview == record.seconds.end() ? 0.0 : preview->second);
    folder.manifest().append(record);
    names.insert(record.id.str());
  }
  return names;
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
  const std::vector<PileScenes> piles = group_by_pile(scenes);
  const auto complete_scenes = [&](const PileScenes& pile) {
    std::size_t count = 0;
    for (std::size_t i = pile.begin; i < pile.end; ++i) count += folder.is_complete(scenes[i].name());
    return count;
  };
  for (const PileScenes& pile : piles) report.complete_before += complete_scenes(pile);
  std::vector<std::size_t> made;
  BinsAlone bins_alone;  // each worker process fills its copy
  const jobs::BatchReport done = jobs::run_batch(
      {.size = piles.size(),
       .noun = piles.size() == scenes.size() ? "scenes" : "piles",
       .pool = {.workers = jobs,
                .attempts_max = folder.config().attempts_max,
                .attempt_time_limit = folder.config().attempt_time_limit * (1 + folder.config().sequence.lifts)},
       .progress = progress_style,
       .is_done = [&](std::size_t job) { return complete_scenes(piles[job]) == piles[job].end - piles[job].begin; },
       .work =
           [&](std::size_t job, int attempt) {
             const PileScenes& pile = piles[job];
             return make_scenes(folder, std::span(scenes).subspan(pile.begin, pile.end - pile.begin), attempt,
                                bins_alone);
           },
       .on_finished =
           [&](const jobs::JobOutcome& outcome) {
             const PileScenes& pile = piles[outcome.job];
             if (!outcome.succeeded) report.failed.push_back(describe_failure(scenes[pile.begin].pile(), outcome));
             std::set<std::string> recorded;
             if (outcome.succeeded) recorded = record_scenes(folder, outcome);
             for (std::size_t i = pile.begin; i < pile.end; ++i) {
               const bool is_made = recorded.contains(scenes[i].name());
               if (is_made) made.push_back(i);
               if (packer && is_made) packer->add(i);
               else if (packer && !folder.is_complete(scenes[i].name())) packer->give_up(i);
             }
           },
       .on_failed_attempt = [&](std::size_t,
                                const jobs::FailedAttempt& attempt) { ++report.rejects[attempt.reason]; }});
  if (packer) packer->finish(done.signal == 0);
  folder.restore_config();
  add_lost(report, folder, scenes, made);
  report.signal = done.signal;
  report.made = made.size();
  report.seconds = done.seconds;
  return report;
}

}  // namespace tubebin::dataset
