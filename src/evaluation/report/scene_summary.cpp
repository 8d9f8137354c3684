#include "evaluation/report/scene_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace tubebin::evaluation {
namespace {

constexpr double kMentioned = 0.1;        // of the wrong points
constexpr double kSpoiled = 0.2;          // of a tube's points: beyond it Hoover et al. call the tube not detected
constexpr double kMuchBackground = 0.01;  // of the points in segments
constexpr std::array<Reason, 4> kReasons = {Reason::split, Reason::merged, Reason::missed, Reason::background};

const char* name_of(Reason reason) {
  constexpr std::array<const char*, 4> names = {"split", "merged", "missed", "background"};
  return names[static_cast<std::size_t>(reason)];
}

/// Most points first.
std::array<Reason, 4> by_size(const Losses& lost) {
  std::array<Reason, 4> reasons = kReasons;
  std::stable_sort(reasons.begin(), reasons.end(), [&](Reason a, Reason b) { return lost.of(a) > lost.of(b); });
  return reasons;
}

Losses losses(const TubeScore& tube) { return {tube.split, tube.merged, tube.missed, 0}; }

/// "Tube 4 is", "Tubes 2, 4 and 7 are".
std::string tubes_are(const std::vector<SegmentId>& tubes) {
  std::string text = fmt::format("{} {}", tubes.size() == 1 ? "Tube" : "Tubes", tubes.front());
  for (std::size_t i = 1; i < tubes.size(); ++i)
    text += (i + 1 == tubes.size() ? " and " : ", ") + std::to_string(tubes[i]);
  return text + (tubes.size() == 1 ? " is" : " are");
}

std::string background_text(const SegmentationScores& scores) {
  std::int64_t in_segments = scores.background;
  for (const TubeScore& tube : scores.tubes) in_segments += tube.points - tube.missed;
  const double share =
      in_segments > 0 ? static_cast<double>(scores.background) / static_cast<double>(in_segments) : 0.0;
  return share > kMuchBackground
             ? fmt::format("Background is taken for tube: {:.1f} % of the points in segments. ", 100.0 * share)
             : "";
}

}  // namespace

std::int64_t Losses::of(Reason reason) const {
  return std::array{split, merged, missed, background}[static_cast<std::size_t>(reason)];
}

Losses operator+(const Losses& a, const Losses& b) {
  return {a.split + b.split, a.merged + b.merged, a.missed + b.missed, a.background + b.background};
}

Losses losses(const SegmentationScores& scores) {
  Losses sum{0, 0, 0, scores.background};
  for (const TubeScore& tube : scores.tubes) sum = sum + losses(tube);
  return sum;
}

std::vector<SceneSummary> summarize_scenes(std::span<const RunScore> runs) {
  std::map<std::pair<std::string, std::string>, std::vector<const RunScore*>> by_scene;
  for (const RunScore& run : runs) by_scene[{run.key.method, run.key.scene}].push_back(&run);
  std::vector<SceneSummary> scenes;
  for (const auto& [key, members] : by_scene) {
    SceneSummary scene{key.first, key.second, 0, 0.0, 0.0, {}, members.front()};
    for (const RunScore* run : members) {
      const double share = 1.0 / static_cast<double>(members.size());
      const int tubes = static_cast<int>(run->scores.tubes.size());
      scene.tubes = std::max(scene.tubes, tubes);
      scene.micro_recall += share * run->micro_recall;
      scene.detected += tubes > 0 ? share * run->scores.hoover.detected / tubes : 0.0;
      scene.lost = scene.lost + losses(run->scores);
      if (run->micro_recall < scene.worst->micro_recall) scene.worst = run;
    }
    scenes.push_back(std::move(scene));
  }
  std::stable_sort(scenes.begin(), scenes.end(), [](const SceneSummary& a, const SceneSummary& b) {
    return std::tie(a.method, a.micro_recall) < std::tie(b.method, b.micro_recall);
  });
  return scenes;
}

std::string reasons_text(const Losses& lost) {
  std::string text;
  for (const Reason reason : by_size(lost))
    if (static_cast<double>(lost.of(reason)) > kMentioned * static_cast<double>(lost.total()))
      text.append(text.empty() ? "" : ", ").append(name_of(reason));
  return text.empty() ? "-" : text;
}

std::string describe_errors(const RunScore& run) {
  if (run.failed) return "The method gave no result.";
  std::map<Reason, std::vector<SegmentId>> tubes;
  for (const TubeScore& tube : run.scores.tubes)
    if (tube.recall() < 1.0 - kSpoiled) tubes[by_size(losses(tube)).front()].push_back(tube.truth_id);
  std::string text;
  for (const auto& [reason, ids] : tubes)
    text += tubes_are(ids) + (reason == Reason::split    ? " split. "
                              : reason == Reason::merged ? " merged with others. "
                                                         : " missed. ");
  text += background_text(run.scores);
  if (text.empty()) return "No tube loses more than a fifth of its points.";
  text.pop_back();
  return text;
}

}  // namespace tubebin::evaluation
