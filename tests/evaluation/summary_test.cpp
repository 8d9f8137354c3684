#include "tubebin/evaluation/summary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tubebin/core/random.hpp"

namespace tubebin::evaluation {
namespace {

/// For many values the percentile bootstrap of the mean approaches mean +- 1.96 s / sqrt(n).
TEST(Bootstrap, ApproachesTheNormalInterval) {
  Random random(3);
  std::vector<double> values(400);
  for (double& value : values) value = 5.0 + 2.0 * random.normal();
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / 400.0;
  double variance = 0.0;
  for (const double value : values) variance += (value - mean) * (value - mean) / 399.0;
  const double half = 1.96 * std::sqrt(variance / 400.0);
  const Interval interval = bootstrap_mean(values, 1);
  EXPECT_DOUBLE_EQ(interval.mean, mean);
  EXPECT_NEAR(interval.low, mean - half, 0.15 * half);
  EXPECT_NEAR(interval.high, mean + half, 0.15 * half);
}

TEST(Bootstrap, CoversTheTrueMeanAboutNineteenTimesInTwenty) {
  Random random(4);
  int covered = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<double> values(20);
    for (double& value : values) value = random.normal();
    const Interval interval = bootstrap_mean(values, static_cast<std::uint64_t>(round));
    covered += interval.low <= 0.0 && interval.high >= 0.0;
  }
  EXPECT_GT(covered, 174);  // the percentile bootstrap of twenty values covers about 93 %
  EXPECT_LT(covered, 200);
}

TEST(Bootstrap, IsReproducibleAndDependsOnTheSeed) {
  std::vector<double> values(200);
  std::iota(values.begin(), values.end(), 0.5);
  EXPECT_EQ(bootstrap_mean(values, 1).low, bootstrap_mean(values, 1).low);
  EXPECT_NE(bootstrap_mean(values, 1).low, bootstrap_mean(values, 2).low);
}

TEST(Bootstrap, OneValueIsItsOwnInterval) {
  const std::vector<double> values = {0.25};
  const Interval interval = bootstrap_mean(values, 1);
  EXPECT_EQ(interval.low, 0.25);
  EXPECT_EQ(interval.high, 0.25);
}

TEST(Pool, SumsTubesBeforeItDivides) {
  SegmentationScores first;
  first.tubes.resize(1);  // one tube: no Rand index
  first.adjusted_rand_index = 0.0;
  first.tubes[0].points = 10;
  first.tubes[0].correct = 10;
  first.tubes[0].predicted_points = 20;
  first.predicted_tubes = 3;
  first.true_positives = {1};
  first.true_positive_iou = 0.6;
  SegmentationScores second;
  second.tubes.resize(3);
  second.predicted_tubes = 1;
  second.adjusted_rand_index = 0.5;
  second.hoover.missed = 3;
  const std::vector<const SegmentationScores*> both = {&first, &second};
  const PooledScores pooled = pool(both);
  EXPECT_EQ(pooled.tubes, 4);
  EXPECT_DOUBLE_EQ(pooled.recall, 0.25);
  EXPECT_DOUBLE_EQ(pooled.precision, 0.125);
  EXPECT_DOUBLE_EQ(pooled.panoptic_quality, 0.6 / 4.0);  // TP + FP / 2 + FN / 2 = (4 + 4) / 2
  EXPECT_DOUBLE_EQ(pooled.average_precision_50, 0.25 * 0.25);
  EXPECT_DOUBLE_EQ(pooled.average_precision, 0.25 * 0.25 / 10.0);
  EXPECT_DOUBLE_EQ(pooled.adjusted_rand_index, 0.5);
  EXPECT_DOUBLE_EQ(pooled.missed, 0.75);
  EXPECT_DOUBLE_EQ(pooled.tube_count_error, 2.0);
  EXPECT_DOUBLE_EQ(pooled.tube_count_bias, 0.0);
}

}  // namespace
}  // namespace tubebin::evaluation
