#include "evaluation/report/side_by_side.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "evaluation/statistics.hpp"

namespace tubebin::evaluation {
namespace {

/// Micro-recalls of a scene by ratio.
using SceneRecalls = std::map<double, double>;
/// By set and scene.
using MethodRecalls = std::map<std::string, std::map<std::string, SceneRecalls>>;

struct Methods {
  std::vector<std::string> names;  ///< as they appear
  std::map<std::string, MethodRecalls> recalls;
};

Methods collect(std::span<const RunScore> runs) {
  Methods methods;
  for (const RunScore& run : runs) {
    if (!methods.recalls.contains(run.key.method)) methods.names.push_back(run.key.method);
    methods.recalls[run.key.method][run.key.set][run.key.scene][run.key.ratio] = run.micro_recall;
  }
  return methods;
}

/// The scene's two means over the ratios that both have.
void add_scene(const SceneRecalls& first, const SceneRecalls& second, std::vector<double>& firsts,
               std::vector<double>& seconds) {
  std::vector<double> a, b;
  for (const auto& [ratio, recall] : first)
    if (const auto other = second.find(ratio); other != second.end()) {
      a.push_back(recall);
      b.push_back(other->second);
    }
  if (a.empty()) return;
  firsts.push_back(mean(a));
  seconds.push_back(mean(b));
}

void fill_in(const std::vector<double>& first, const std::vector<double>& second, Comparison& comparison) {
  std::vector<double> gains;
  for (std::size_t i = 0; i < first.size(); ++i) {
    gains.push_back(second[i] - first[i]);
    comparison.better += gains.back() > 0.0 ? 1 : 0;
    comparison.worse += gains.back() < 0.0 ? 1 : 0;
  }
  comparison.scenes = static_cast<int>(first.size());
  comparison.recall_first = mean(first);
  comparison.recall_second = mean(second);
  comparison.gain = bootstrap_mean(gains, kBootstrapSeed);
}

}  // namespace

std::vector<Comparison> compare_methods(std::span<const RunScore> runs) {
  Methods methods = collect(runs);
  std::vector<Comparison> comparisons;
  for (std::size_t m = 1; m < methods.names.size(); ++m)
    for (auto& [set, scenes] : methods.recalls[methods.names.front()]) {
      std::vector<double> firsts, seconds;
      for (const auto& [scene, recalls] : scenes)
        add_scene(recalls, methods.recalls[methods.names[m]][set][scene], firsts, seconds);
      if (firsts.empty()) continue;
      comparisons.push_back({.set = set, .first = methods.names.front(), .second = methods.names[m]});
      fill_in(firsts, seconds, comparisons.back());
    }
  return comparisons;
}

Table side_by_side_table(std::span<const Comparison> comparisons) {
  Table table{"Side by side: mean micro-recall on the scenes and ratios that both have",
              {"first", "second", "set", "scenes", "recall of first", "recall of second", "difference", "better",
               "worse", "alike"},
              {},
              "In brackets: 95 % bootstrap interval of the mean difference over the scenes. Better, worse: scenes in "
              "which the second is so."};
  for (const Comparison& one : comparisons)
    table.rows.push_back(
        {one.first, one.second, one.set, integer_cell(one.scenes), number_cell(one.recall_first, 4),
         number_cell(one.recall_second, 4),
         Cell(fmt::format("{:+.4f} [{:+.4f}, {:+.4f}]", one.gain.mean, one.gain.low, one.gain.high), one.gain.mean),
         integer_cell(one.better), integer_cell(one.worse), integer_cell(one.scenes - one.better - one.worse)});
  return table;
}

}  // namespace tubebin::evaluation
