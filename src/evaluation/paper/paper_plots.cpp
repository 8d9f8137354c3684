#include <fmt/format.h>

#include <algorithm>

#include "evaluation/statistics.hpp"
#include "tubebin/evaluation/paper_comparison.hpp"
#include "tubebin/evaluation/paper_figures.hpp"
#include "tubebin/evaluation/result_plots.hpp"
#include "tubebin/evaluation/result_tables.hpp"

namespace tubebin::evaluation {
namespace {

constexpr int kBlack = 6;

PlotPoint point(double x, const Interval& interval) { return {x, interval.mean, interval.low, interval.high}; }
PlotPoint point(double x, double y) { return {x, y, y, y}; }

void add_paper_points(Plot& plot, const std::map<double, double>& points, const std::string& name) {
  PlotSeries series{name, kBlack, SeriesStyle::paper, {}, false};
  for (const auto& [x, y] : points) series.points.push_back(point(x, y));
  if (!plot.series.empty()) plot.series.push_back(std::move(series));
}

Plot figure_8(const std::vector<GroupSummary>& groups) {
  Plot plot = recall_by_tubes_plot(groups);
  plot.name = "figure_8";
  plot.title = "Figure 8: " + plot.title;
  const auto& paper = paper_figures().micro_recall_set_b;
  if (shown_conditions(groups).ratio == Conditions().ratio)
    add_paper_points(plot, {paper.begin(), paper.end()}, "paper, set B (values in its text)");
  return plot;
}

Plot figure_9(const std::vector<GroupSummary>& groups) {
  Plot plot = recall_by_ratio_plot(groups);
  plot.name = "figure_9";
  plot.title = "Figure 9: " + plot.title;
  const auto& paper = paper_figures().micro_recall_set_b;
  if (const auto value = paper.find(shown_conditions(groups).tubes); value != paper.end())
    add_paper_points(plot, {{Conditions().ratio, value->second}}, "paper, set B (value in its text)");
  return plot;
}

Plot table_1(const GenerationSeconds& seconds) {
  Plot plot{"table_1", "Table 1: seconds to generate a test case", "number of tubes", "seconds (logarithmic)", true,
            {}};
  for (const auto& [set, by_tubes] : seconds) {
    const int color = static_cast<int>(plot.series.size()) / 2;
    PlotSeries ours{fmt::format("here, set {}", set), color, SeriesStyle::measured, {}};
    for (const auto& [tubes, values] : by_tubes) ours.points.push_back(point(tubes, bootstrap_mean(values, 1)));
    plot.series.push_back(std::move(ours));
    const auto paper = paper_figures().generation_seconds.find(set);
    if (paper == paper_figures().generation_seconds.end()) continue;
    PlotSeries theirs{fmt::format("paper, set {}", set), color, SeriesStyle::paper, {}};
    for (const auto& [tubes, value] : paper->second) theirs.points.push_back(point(tubes, value));
    plot.series.push_back(std::move(theirs));
  }
  return plot;
}

Plot table_2(const std::vector<GroupSummary>& groups, const std::string& method) {
  Plot plot{fmt::format("table_2_{}", method),
            fmt::format("Table 2: seconds to model a cloud of set A, {}", method),
            "downsampling ratio",
            "seconds (logarithmic)",
            true,
            {}};
  int color = 0;
  for (const auto& [tubes, unused] : paper_figures().modelling_seconds.begin()->second) {
    PlotSeries ours{"here, " + count_of_tubes(tubes), color, SeriesStyle::measured, {}};
    for (const GroupSummary& group : groups)
      if (group.key.method == method && group.key.set == "A" && group.key.tubes == tubes && group.seconds)
        ours.points.push_back(point(group.key.ratio, *group.seconds));
    if (ours.points.empty()) continue;
    plot.series.push_back(std::move(ours));
    PlotSeries theirs{"paper, " + count_of_tubes(tubes), color++, SeriesStyle::paper, {}};
    for (const auto& [ratio, by_tubes] : paper_figures().modelling_seconds)
      theirs.points.push_back(point(ratio, by_tubes.at(tubes)));
    plot.series.push_back(std::move(theirs));
  }
  return plot;
}

}  // namespace

std::vector<Plot> paper_plots(const std::vector<GroupSummary>& groups, const GenerationSeconds& seconds) {
  std::vector<Plot> plots = {figure_8(groups), figure_9(groups), table_1(seconds)};
  for (const std::string& method : methods_of(groups)) plots.push_back(table_2(groups, method));
  std::erase_if(plots, [](const Plot& plot) { return plot.series.empty(); });
  return plots;
}

}  // namespace tubebin::evaluation
