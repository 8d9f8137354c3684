#include "tubebin/evaluation/result_plots.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tubebin/evaluation/result_tables.hpp"

namespace tubebin::evaluation {
namespace {

/// A series a method and set over the groups that `x_of` gives a place and `y_of` a value.
template <typename PlaceOf, typename ValueOf>
void add_series(Plot& plot, const std::vector<GroupSummary>& groups, PlaceOf x_of, ValueOf y_of) {
  const std::vector<std::string> methods = methods_of(groups);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    for (const std::string& set : sets_of(groups)) {
      PlotSeries series;
      series.name = fmt::format("{}, set {}", methods[m], set);
      series.color = static_cast<int>(plot.series.size());
      series.style = m == 0 ? SeriesStyle::measured : SeriesStyle::second;
      for (const GroupSummary& group : groups) {
        if (group.key.method != methods[m] || group.key.set != set) continue;
        const std::optional<double> x = x_of(group.key);
        const std::optional<Interval> y = y_of(group);
        if (x && y) series.points.push_back({*x, y->mean, y->low, y->high});
      }
      if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
  }
}

std::optional<Interval> recall_of(const GroupSummary& group) { return group.micro_recall; }
std::optional<Interval> seconds_of(const GroupSummary& group) { return group.seconds; }

template <typename ValueOf>
Plot by_tubes(const std::vector<GroupSummary>& groups, Plot plot, const char* subject, ValueOf y_of) {
  const double ratio = shown_conditions(groups).ratio;
  plot.title = fmt::format("{} by number of tubes, ratio {}", subject, ratio);
  plot.x_label = "number of tubes";
  add_series(
      plot, groups,
      [&](const GroupKey& key) { return key.ratio == ratio ? std::optional<double>(key.tubes) : std::nullopt; }, y_of);
  return plot;
}

template <typename ValueOf>
Plot by_ratio(const std::vector<GroupSummary>& groups, Plot plot, const char* subject, ValueOf y_of) {
  const int tubes = shown_conditions(groups).tubes;
  plot.title = fmt::format("{} by downsampling ratio, {}", subject, count_of_tubes(tubes));
  plot.x_label = "downsampling ratio";
  add_series(
      plot, groups,
      [&](const GroupKey& key) { return key.tubes == tubes ? std::optional<double>(key.ratio) : std::nullopt; }, y_of);
  return plot;
}

Plot recall_plot(const char* name) { return {name, "", "", "mean micro-recall", false, {}}; }
Plot seconds_plot(const char* name) { return {name, "", "", "seconds (logarithmic)", true, {}}; }

bool has_one_place(const Plot& plot) {
  std::optional<double> first;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points)
      if (point.x != first.value_or(point.x)) return false;
      else first = point.x;
  return true;
}

}  // namespace

Plot recall_by_tubes_plot(const std::vector<GroupSummary>& groups) {
  return by_tubes(groups, recall_plot("recall_by_tubes"), "Micro-recall", recall_of);
}
Plot recall_by_ratio_plot(const std::vector<GroupSummary>& groups) {
  return by_ratio(groups, recall_plot("recall_by_ratio"), "Micro-recall", recall_of);
}
Plot seconds_by_tubes_plot(const std::vector<GroupSummary>& groups) {
  return by_tubes(groups, seconds_plot("seconds_by_tubes"), "Seconds to model a cloud", seconds_of);
}
Plot seconds_by_ratio_plot(const std::vector<GroupSummary>& groups) {
  return by_ratio(groups, seconds_plot("seconds_by_ratio"), "Seconds to model a cloud", seconds_of);
}

std::vector<Plot> result_plots(const std::vector<GroupSummary>& groups) {
  std::vector<Plot> plots = {recall_by_tubes_plot(groups), recall_by_ratio_plot(groups), seconds_by_tubes_plot(groups),
                             seconds_by_ratio_plot(groups)};
  std::erase_if(plots, has_one_place);
  return plots;
}

}  // namespace tubebin::evaluation
