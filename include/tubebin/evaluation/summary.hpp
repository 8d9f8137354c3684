/// Runs brought together: means with bootstrap intervals by group, and pooled measures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tubebin/evaluation/run_score.hpp"

namespace tubebin::evaluation {

/// A mean and its 95 % confidence interval.
struct Interval {
  double mean = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// Percentile bootstrap of the mean (Efron 1979) with kBootstrapResamples resamples; the same values and seed
/// give the same interval. One value is its own interval. `values` is not empty.
Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed);

constexpr int kBootstrapResamples = 2000;

/// Measures of several scenes or runs together (docs/metrics.md). Shares are of tubes, distances metres.
struct PooledScores {
  int runs = 0;
  int tubes = 0;
  int predicted_tubes = 0;
  double recall = 0.0;  ///< means over the tubes
  double precision = 0.0;
  double iou = 0.0;
  double panoptic_quality = 0.0;      ///< of all tubes together, as the two below
  double average_precision_50 = 0.0;  ///< at IoU 0.5
  double average_precision = 0.0;     ///< mean over IoU 0.5 to 0.95
  double adjusted_rand_index = 0.0;   ///< mean over the runs that have several tubes
  double detected = 0.0;
  double over_segmented = 0.0;
  double under_segmented = 0.0;
  double missed = 0.0;
  double noise = 0.0;                  ///< share of the predicted tubes
  double tube_count_error = 0.0;       ///< mean over the runs of |predicted - real|
  double tube_count_bias = 0.0;        ///< mean over the runs of predicted - real
  int centerlines = 0;                 ///< tubes with a centreline error
  double centerline_model_mean = 0.0;  ///< means over these tubes, of CenterlineError's fields
  double centerline_model_p95 = 0.0;
  double centerline_truth_mean = 0.0;
  double centerline_truth_p95 = 0.0;
};

PooledScores pool(std::span<const SegmentationScores* const> scores);

struct GroupKey {
  std::string method;
  std::string set;
  int tubes = 0;
  double ratio = 1.0;

  auto operator<=>(const GroupKey&) const = default;
};

/// All cases of one method, set, number of tubes and ratio.
struct GroupSummary {
  GroupKey key;
  int runs = 0;
  int failed = 0;
  Interval micro_recall;
  std::optional<Interval> seconds;  ///< over the runs that have a time
  PooledScores pooled;
};

/// Groups in ascending order of their keys.
std::vector<GroupSummary> summarize(std::span<const RunScore> runs);

/// The summary of one method and set over all its tubes and ratios, or of those runs that `runs` holds.
GroupSummary summarize_together(const std::string& method, const std::string& set,
                                std::span<const RunScore* const> runs);

}  // namespace tubebin::evaluation
