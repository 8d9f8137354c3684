/// The few statistics that claims are tested with.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tubebin/evaluation/summary.hpp"

namespace tubebin::evaluation {

double mean(std::span<const double> values);

/// Least squares y = intercept + slope x.
struct LineFit {
  double slope = 0.0;
  double r_squared = 0.0;  ///< share of y's variance that the line explains; 1 where y is constant
};
LineFit fit_line(std::span<const double> x, std::span<const double> y);

/// Spearman's rank correlation; ties get their mean rank. 0 where a side is constant.
double rank_correlation(std::span<const double> x, std::span<const double> y);
/// Claims that something rises with another hold from this rank correlation on.
inline constexpr double kMonotone = 0.9;

/// A statistic of the groups' means with its percentile bootstrap interval: each group's values are
/// resampled.
Interval bootstrap_of_means(const std::vector<std::vector<double>>& groups,
                            const std::function<double(std::span<const double> means)>& statistic, std::uint64_t seed);
inline constexpr std::uint64_t kBootstrapSeed = 1;  ///< of the claims' intervals

}  // namespace tubebin::evaluation
