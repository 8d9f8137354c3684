#include "tubebin/evaluation/metrics.hpp"

#include <gmock/gmock.h>

#include "tubebin/core/random.hpp"

namespace tubebin::evaluation {
namespace {

/// Rows: ground-truth tubes 1, 2, ...; columns: predicted segments 1, 2, ...; the last column is "no
/// segment".
Contingency contingency(const std::vector<std::vector<int>>& rows) {
  std::vector<SegmentId> truth, predicted;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t column = 0; column < rows[row].size(); ++column)
      for (int i = 0; i < rows[row][column]; ++i) {
        truth.push_back(static_cast<SegmentId>(row + 1));
        predicted.push_back(column + 1 < rows[row].size() ? static_cast<SegmentId>(column + 1) : kNullId);
      }
  return count_pairs(truth, predicted, 0);
}

SegmentationScores scores(const std::vector<std::vector<int>>& rows) {
  const Contingency c = contingency(rows);
  return score_tubes(c, match_segments(c));
}

TEST(Metrics, PaperExampleTubeByTube) {
  const SegmentationScores s = scores({{26, 2, 11, 0}, {2, 24, 7, 0}});
  ASSERT_EQ(s.tubes.size(), 2U);
  EXPECT_DOUBLE_EQ(s.tubes[0].recall(), 26.0 / 39.0);
  EXPECT_DOUBLE_EQ(s.tubes[0].precision(), 26.0 / 28.0);
  EXPECT_DOUBLE_EQ(s.tubes[0].iou(), 26.0 / 41.0);
  EXPECT_DOUBLE_EQ(s.tubes[1].iou(), 24.0 / 35.0);
  EXPECT_EQ(s.predicted_tubes, 3);
  EXPECT_EQ(s.correct, 50);
  EXPECT_EQ(s.points, 72);
  EXPECT_EQ(s.true_positives[0], 2);  // IoU 0.634 and 0.686
  EXPECT_EQ(s.true_positives[3], 1);  // above 0.65
  EXPECT_EQ(s.true_positives[4], 0);  // above 0.70
}

TEST(Metrics, PerfectLabelsScoreOneEverywhere) {
  const SegmentationScores s = scores({{100, 0, 0}, {0, 40, 0}});
  EXPECT_EQ(s.true_positives[9], 2);
  EXPECT_DOUBLE_EQ(panoptic_quality(2, s.predicted_tubes, s.true_positives[0], s.true_positive_iou), 1.0);
  EXPECT_DOUBLE_EQ(average_precision(2, s.predicted_tubes, s.true_positives[9]), 1.0);
  EXPECT_DOUBLE_EQ(s.adjusted_rand_index, 1.0);
  EXPECT_EQ(s.hoover.detected, 2);
  EXPECT_EQ(s.hoover.noise, 0);
}

TEST(Metrics, PanopticQualityIsSegmentationTimesRecognitionQuality) {
  // Three tubes, four segments, two pairs above one half with IoU 0.8 and 0.6: SQ = 0.7, RQ = 2 / (2 + 1 +
  // 0.5).
  EXPECT_DOUBLE_EQ(panoptic_quality(3, 4, 2, 1.4), 0.7 * 2.0 / 3.5);
  EXPECT_EQ(panoptic_quality(3, 0, 0, 0.0), 0.0);
}

TEST(Metrics, AveragePrecisionIsTheOneStepOfItsCurve) {
  EXPECT_DOUBLE_EQ(average_precision(4, 5, 3), (3.0 / 4.0) * (3.0 / 5.0));
  EXPECT_EQ(average_precision(4, 0, 0), 0.0);
}

TEST(Metrics, HooverClasses) {
  const HooverCounts over = scores({{50, 48, 2}}).hoover;
  EXPECT_EQ(over.over_segmented, 1);
  EXPECT_EQ(over.noise, 0);
  const HooverCounts under = scores({{50, 0}, {60, 0}}).hoover;
  EXPECT_EQ(under.under_segmented, 2);
  EXPECT_EQ(under.noise, 0);
  const HooverCounts missed = scores({{100, 0, 0}, {0, 20, 80}}).hoover;
  EXPECT_EQ(missed.detected, 1);
  EXPECT_EQ(missed.missed, 1);
  EXPECT_EQ(missed.noise, 1);
}

/// Over all pairs of points: agreement of "same tube" with "same segment", corrected for chance.
double adjusted_rand_index_by_pairs(const std::vector<int>& a, const std::vector<int>& b) {
  double both = 0, in_a = 0, in_b = 0, all = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = i + 1; j < a.size(); ++j) {
      both += a[i] == a[j] && b[i] == b[j];
      in_a += a[i] == a[j];
      in_b += b[i] == b[j];
      ++all;
    }
  const double expected = in_a * in_b / all;
  return (both - expected) / (0.5 * (in_a + in_b) - expected);
}

TEST(Metrics, AdjustedRandIndexEqualsItsDefinitionOverPairs) {
  Random random(8);
  for (int round = 0; round < 30; ++round) {
    std::vector<int> a, b;
    Counts counts = Counts::Zero(4, 5);
    for (int i = 0; i < 120; ++i) {
      a.push_back(random.integer(0, 3));
      b.push_back(random.uniform(0, 1) < 0.6 ? a.back() : random.integer(0, 4));
      ++counts(a.back(), b.back());
    }
    EXPECT_NEAR(adjusted_rand_index(counts), adjusted_rand_index_by_pairs(a, b), 1e-12);
  }
}

TEST(Metrics, AdjustedRandIndexOfIndependentPartitionsIsNearZero) {
  Random random(9);
  Counts counts = Counts::Zero(5, 5);
  for (int i = 0; i < 20000; ++i) ++counts(random.integer(0, 4), random.integer(0, 4));
  EXPECT_NEAR(adjusted_rand_index(counts), 0.0, 0.002);
}

TEST(Metrics, UnlabelledPointsAreOneClusterOfTheRandIndex) {
  const SegmentationScores s = scores({{30, 10}, {0, 40}});
  EXPECT_DOUBLE_EQ(s.adjusted_rand_index, adjusted_rand_index((Counts(2, 2) << 30, 10, 0, 40).finished()));
}

TEST(Metrics, TheBinIsNoTubeButItsPointsSpoilPrecision) {
  std::vector<SegmentId> truth(100, 1), predicted(100, 5);
  truth.insert(truth.end(), 50, 0);
  predicted.insert(predicted.end(), 50, 5);
  const Contingency c = count_pairs(truth, predicted, 0);
  const Matching matching = match_segments(c);
  const SegmentationScores s = score_tubes(c, matching);
  ASSERT_EQ(s.tubes.size(), 1U);
  EXPECT_DOUBLE_EQ(s.tubes[0].recall(), 1.0);
  EXPECT_DOUBLE_EQ(s.tubes[0].precision(), 100.0 / 150.0);
  EXPECT_DOUBLE_EQ(matching.micro_recall(),
                   100.0 / 150.0);  // Equation 1 counts every point of the filtered cloud
}

TEST(Metrics, AnySplitOfTheTubesSumsToTheWhole) {
  const Contingency c = contingency({{80, 5, 0, 0, 3}, {4, 70, 0, 9, 0}, {0, 6, 20, 30, 1}, {0, 0, 0, 40, 0}});
  const Matching matching = match_segments(c);
  const SegmentationScores whole = score_tubes(c, matching);
  const SegmentationScores first = score_tubes(c, matching, {true, false, true, false});
  const SegmentationScores second = score_tubes(c, matching, {false, true, false, true});
  EXPECT_EQ(first.correct + second.correct, whole.correct);
  EXPECT_EQ(first.points + second.points, whole.points);
  EXPECT_EQ(first.predicted_tubes + second.predicted_tubes, whole.predicted_tubes);
  EXPECT_EQ(first.tubes.size() + second.tubes.size(), whole.tubes.size());
  for (std::size_t i = 0; i < kIouThresholdCount; ++i)
    EXPECT_EQ(first.true_positives[i] + second.true_positives[i], whole.true_positives[i]);
  EXPECT_DOUBLE_EQ(first.true_positive_iou + second.true_positive_iou, whole.true_positive_iou);
  EXPECT_EQ(first.hoover.missed + second.hoover.missed, whole.hoover.missed);
}

}  // namespace
}  // namespace tubebin::evaluation
