#include "evaluation/report/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "tubebin/evaluation/summary.hpp"
#include "tubebin/evaluation/table.hpp"

namespace tubebin::evaluation {
namespace {

constexpr std::size_t kFewScenes = 10;
constexpr std::uint64_t kIntervalSeed = 1;

const char* how_many(double detected) {
  if (detected >= 1.0) return "every tube";
  if (detected >= 0.95) return "nearly every tube";
  if (detected >= 0.8) return "most tubes";
  if (detected >= 0.5) return "more than half of the tubes";
  return detected > 0.0 ? "less than half of the tubes" : "no tube";
}

std::string percent_text(double share) { return percent_cell(share, 2).text; }

/// Scenes are drawn anew, not runs: the runs of a scene at several ratios are alike.
std::string how_sure(std::span<const SceneSummary> scenes) {
  if (scenes.size() == 1) return "One scene says nothing about others.";
  std::vector<double> values;
  for (const SceneSummary& scene : scenes) values.push_back(scene.micro_recall);
  const Interval interval = bootstrap_mean(values, kIntervalSeed);
  return fmt::format("Other scenes of this kind would give {} to {} (95 % interval of the mean over {} scenes).{}",
                     percent_text(interval.low), percent_text(interval.high), scenes.size(),
                     scenes.size() < kFewScenes ? " So few scenes leave much to chance." : "");
}

std::string reasons(std::span<const SceneSummary> scenes) {
  Losses lost;
  for (const SceneSummary& scene : scenes) lost = lost + scene.lost;
  if (lost.total() == 0) return "No point of a tube is wrong.";
  const auto share = [&](std::int64_t points) {
    return fmt::format("{:.0f} %", 100.0 * static_cast<double>(points) / static_cast<double>(lost.total()));
  };
  return fmt::format(
      "Of the wrong points {} lie in tubes that are split, {} are merged with another tube, {} are missed and {} are "
      "background taken for tube.",
      share(lost.split), share(lost.merged), share(lost.missed), share(lost.background));
}

/// The value with the lowest mean micro-recall; none where all are alike.
template <typename Value, typename Get>
std::optional<std::pair<Value, double>> worst_value(std::span<const RunScore* const> runs, Get get) {
  std::map<Value, std::pair<double, int>> sums;
  for (const RunScore* run : runs) {
    auto& [sum, count] = sums[get(*run)];
    sum += run->micro_recall;
    ++count;
  }
  std::vector<std::pair<Value, double>> means;
  for (const auto& [value, sum] : sums) means.emplace_back(value, sum.first / sum.second);
  const auto [low, high] =
      std::minmax_element(means.begin(), means.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return high->second - low->second > 1e-9 ? std::optional(*low) : std::nullopt;
}

std::string worst_conditions(std::span<const RunScore* const> runs) {
  std::vector<std::string> parts;
  if (const auto set = worst_value<std::string>(runs, [](const RunScore& run) { return run.key.set; }))
    parts.push_back(fmt::format("on set {} ({})", set->first, percent_text(set->second)));
  if (const auto tubes = worst_value<int>(runs, [](const RunScore& run) { return run.key.tubes; }))
    parts.push_back(fmt::format("with {} ({})", count_of_tubes(tubes->first), percent_text(tubes->second)));
  if (const auto ratio = worst_value<double>(runs, [](const RunScore& run) { return run.key.ratio; }))
    parts.push_back(fmt::format("at ratio {} ({})", ratio->first, percent_text(ratio->second)));
  return parts.empty() ? "" : fmt::format(" It is lowest {}.", fmt::join(parts, ", "));
}

}  // namespace

VerdictText describe_results(std::span<const RunScore* const> runs, std::span<const SceneSummary> scenes) {
  const GroupSummary all = summarize_together(runs.front()->key.method, "", runs);
  VerdictText text;
  text.headline = fmt::format("{} finds {}", all.key.method, how_many(all.pooled.detected));
  text.how_good = fmt::format("{} of the points carry the right tube (micro-recall), {} of the tubes are found whole.",
                              percent_text(all.micro_recall.mean), percent_text(all.pooled.detected));
  text.how_sure = how_sure(scenes);
  text.where_it_fails = reasons(scenes) + worst_conditions(runs);
  return text;
}

}  // namespace tubebin::evaluation
