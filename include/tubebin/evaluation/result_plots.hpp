/// Plots of what was measured, one series a method and set, with 95 % intervals.
#pragma once

#include <vector>

#include "tubebin/evaluation/plot.hpp"
#include "tubebin/evaluation/summary.hpp"

namespace tubebin::evaluation {

/// Mean micro-recall by number of tubes, or by ratio, under shown_conditions(); maybe without a series.
Plot recall_by_tubes_plot(const std::vector<GroupSummary>& groups);
Plot recall_by_ratio_plot(const std::vector<GroupSummary>& groups);
/// Modelling time in the same way.
Plot seconds_by_tubes_plot(const std::vector<GroupSummary>& groups);
Plot seconds_by_ratio_plot(const std::vector<GroupSummary>& groups);

/// Those of the above that have several values on their x axis.
std::vector<Plot> result_plots(const std::vector<GroupSummary>& groups);

}  // namespace tubebin::evaluation
