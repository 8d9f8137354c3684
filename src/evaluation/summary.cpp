#include "tubebin/evaluation/summary.hpp"

#include <bit>
#include <map>

#include "evaluation/statistics.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::evaluation {
namespace {

/// A seed that depends on the group alone, so that other groups in the same results don't change its
/// interval.
std::uint64_t seed_of(const GroupKey& key) {
  std::uint64_t seed = derive_seed({static_cast<std::uint64_t>(key.tubes), std::bit_cast<std::uint64_t>(key.ratio)});
  for (const char c : key.method + '\n' + key.set) seed = derive_seed({seed, static_cast<std::uint64_t>(c)});
  return seed;
}

/// Sums over tubes and runs, before they are divided.
struct Sums {
  std::array<int, kIouThresholdCount> true_positives{};
  double true_positive_iou = 0.0;
  double rand_index = 0.0;
  int runs_with_several_tubes = 0;
  HooverCounts hoover;
};

void add_tube(const TubeScore& tube, PooledScores& pooled) {
  pooled.recall += tube.recall();
  pooled.precision += tube.precision();
  pooled.iou += tube.iou();
  if (!tube.centerline_error) return;
  ++pooled.centerlines;
  pooled.centerline_model_mean += tube.centerline_error->model_mean;
  pooled.centerline_model_p95 += tube.centerline_error->model_p95;
  pooled.centerline_truth_mean += tube.centerline_error->truth_mean;
  pooled.centerline_truth_p95 += tube.centerline_error->truth_p95;
}

void add_scores(const SegmentationScores& scores, PooledScores& pooled, Sums& sums) {
  const int tubes = static_cast<int>(scores.tubes.size());
  ++pooled.runs;
  pooled.tubes += tubes;
  pooled.predicted_tubes += scores.predicted_tubes;
  pooled.tube_count_bias += scores.predicted_tubes - tubes;
  pooled.tube_count_error += std::abs(scores.predicted_tubes - tubes);
  for (const TubeScore& tube : scores.tubes) add_tube(tube, pooled);
  for (std::size_t i = 0; i < sums.true_positives.size(); ++i) sums.true_positives[i] += scores.true_positives[i];
  sums.true_positive_iou += scores.true_positive_iou;
  // With one tube any point without a segment makes the index 0, however many the segment has.
  if (tubes > 1) {
    ++sums.runs_with_several_tubes;
    sums.rand_index += scores.adjusted_rand_index;
  }
  sums.hoover.detected += scores.hoover.detected;
  sums.hoover.over_segmented += scores.hoover.over_segmented;
  sums.hoover.under_segmented += scores.hoover.under_segmented;
  sums.hoover.missed += scores.hoover.missed;
  sums.hoover.noise += scores.hoover.noise;
}

double share(double part, int whole) { return whole > 0 ? part / whole : 0.0; }

void divide(PooledScores& pooled, const Sums& sums) {
  for (double* value : {&pooled.recall, &pooled.precision, &pooled.iou}) *value = share(*value, pooled.tubes);
  for (double* value : {&pooled.tube_count_error, &pooled.tube_count_bias}) *value = share(*value, pooled.runs);
  for (double* value : {&pooled.centerline_model_mean, &pooled.centerline_model_p95, &pooled.centerline_truth_mean,
                        &pooled.centerline_truth_p95})
    *value = share(*value, pooled.centerlines);
  pooled.adjusted_rand_index = share(sums.rand_index, sums.runs_with_several_tubes);
  pooled.detected = share(sums.hoover.detected, pooled.tubes);
  pooled.over_segmented = share(sums.hoover.over_segmented, pooled.tubes);
  pooled.under_segmented = share(sums.hoover.under_segmented, pooled.tubes);
  pooled.missed = share(sums.hoover.missed, pooled.tubes);
  pooled.noise = share(sums.hoover.noise, pooled.predicted_tubes);
  pooled.panoptic_quality =
      panoptic_quality(pooled.tubes, pooled.predicted_tubes, sums.true_positives[0], sums.true_positive_iou);
  pooled.average_precision_50 = average_precision(pooled.tubes, pooled.predicted_tubes, sums.true_positives[0]);
  for (const int true_positives : sums.true_positives)
    pooled.average_precision +=
        average_precision(pooled.tubes, pooled.predicted_tubes, true_positives) / kIouThresholdCount;
}

GroupSummary summarize_group(const GroupKey& key, std::span<const RunScore* const> runs) {
  GroupSummary group;
  group.key = key;
  group.runs = static_cast<int>(runs.size());
  std::vector<double> micro_recall;
  std::vector<double> seconds;
  std::vector<const SegmentationScores*> scores;
  for (const RunScore* run : runs) {
    group.failed += run->failed;
    micro_recall.push_back(run->micro_recall);
    if (run->seconds) seconds.push_back(*run->seconds);
    scores.push_back(&run->scores);
  }
  const std::uint64_t seed = seed_of(key);
  group.micro_recall = bootstrap_mean(micro_recall, seed);
  if (!seconds.empty()) group.seconds = bootstrap_mean(seconds, seed);
  group.pooled = pool(scores);
  return group;
}

}  // namespace

Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed) {
  return bootstrap_of_means(
      {{values.begin(), values.end()}}, [](std::span<const double> means) { return means[0]; }, seed);
}

PooledScores pool(std::span<const SegmentationScores* const> scores) {
  PooledScores pooled;
  Sums sums;
  for (const SegmentationScores* one : scores) add_scores(*one, pooled, sums);
  divide(pooled, sums);
  return pooled;
}

std::vector<GroupSummary> summarize(std::span<const RunScore> runs) {
  std::map<GroupKey, std::vector<const RunScore*>> runs_of_group;
  for (const RunScore& run : runs)
    runs_of_group[{run.key.method, run.key.set, run.key.tubes, run.key.ratio}].push_back(&run);
  std::vector<GroupSummary> groups;
  for (const auto& [key, members] : runs_of_group) groups.push_back(summarize_group(key, members));
  return groups;
}

GroupSummary summarize_together(const std::string& method, const std::string& set,
                                std::span<const RunScore* const> runs) {
  return summarize_group({method, set, 0, 0.0}, runs);
}

}  // namespace tubebin::evaluation
