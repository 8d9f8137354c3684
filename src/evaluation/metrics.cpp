#include "tubebin/evaluation/metrics.hpp"

#include <algorithm>

namespace tubebin::evaluation {
namespace {

std::size_t columns_of(const Contingency& c) { return c.predicted_ids.size(); }

/// Whether a part of a region agrees with the whole, in the sense of Hoover et al.
bool agrees(std::int64_t part, std::int64_t whole) {
  return static_cast<double>(part) >= kHooverTolerance * static_cast<double>(whole);
}

/// The row that has most points of each predicted segment.
std::vector<std::size_t> main_rows(const Contingency& c) {
  std::vector<std::size_t> rows;
  for (Eigen::Index column = 0; column < c.counts.cols(); ++column) {
    Eigen::Index row = 0;
    c.counts.col(column).maxCoeff(&row);
    rows.push_back(static_cast<std::size_t>(row));
  }
  return rows;
}

TubeScore score_tube(const Contingency& c, const Matching& matching, const std::vector<std::size_t>& main_row,
                     std::size_t row) {
  TubeScore score;
  score.truth_id = c.truth_ids[row];
  score.points = c.truth_size(row);
  score.missed = c.unlabeled[row];
  const int matched = matching.column_of_row[row];
  for (std::size_t column = 0; column < columns_of(c); ++column) {
    if (static_cast<int>(column) == matched) {
      score.predicted_id = c.predicted_ids[column];
      score.predicted_points = c.predicted_size(column);
      score.correct = c.count(row, column);
    } else {
      (main_row[column] == row ? score.split : score.merged) += c.count(row, column);
    }
  }
  return score;
}

/// The predicted segments that have most of their points in a selected row.
std::vector<bool> columns_of_rows(const Contingency& c, const std::vector<bool>& selected) {
  std::vector<bool> columns;
  for (const std::size_t row : main_rows(c)) columns.push_back(selected[row]);
  return columns;
}

/// Points of the bin in the selected segments.
std::int64_t count_background(const Contingency& c, const std::vector<bool>& columns) {
  std::int64_t points = 0;
  for (std::size_t row = 0; row < c.truth_ids.size(); ++row)
    for (std::size_t column = 0; column < columns.size(); ++column)
      if (c.is_bin(row) && columns[column]) points += c.count(row, column);
  return points;
}

/// IoU pairs above one half are unique (Kirillov et al. 2019), so each needs no further matching.
void count_true_positives(const Contingency& c, const std::vector<bool>& rows, SegmentationScores& scores) {
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!rows[row]) continue;
    const std::int64_t truth_size = c.truth_size(row);
    for (std::size_t column = 0; column < columns_of(c); ++column) {
      const std::int64_t overlap = c.count(row, column);
      if (2 * overlap <= truth_size) continue;
      const double iou =
          static_cast<double>(overlap) / static_cast<double>(truth_size + c.predicted_size(column) - overlap);
      for (int i = 0; i < kIouThresholdCount; ++i)
        if (iou > iou_threshold(i)) ++scores.true_positives[static_cast<std::size_t>(i)];
      if (iou > iou_threshold(0)) scores.true_positive_iou += iou;
    }
  }
}

enum class HooverClass { missed, detected, over_segmented, under_segmented };

struct HooverClasses {
  std::vector<HooverClass> rows;
  std::vector<bool> column_is_used;
};

void find_detected(const Contingency& c, HooverClasses& classes) {
  for (std::size_t row = 0; row < classes.rows.size(); ++row)
    for (std::size_t column = 0; column < columns_of(c); ++column)
      if (agrees(c.count(row, column), c.truth_size(row)) && agrees(c.count(row, column), c.predicted_size(column))) {
        classes.rows[row] = HooverClass::detected;
        classes.column_is_used[column] = true;
      }
}

void find_over_segmented(const Contingency& c, HooverClasses& classes) {
  for (std::size_t row = 0; row < classes.rows.size(); ++row) {
    if (classes.rows[row] != HooverClass::missed) continue;
    std::vector<std::size_t> columns;
    std::int64_t covered = 0;
    for (std::size_t column = 0; column < columns_of(c); ++column) {
      if (c.count(row, column) == 0 || !agrees(c.count(row, column), c.predicted_size(column))) continue;
      columns.push_back(column);
      covered += c.count(row, column);
    }
    if (columns.size() < 2 || !agrees(covered, c.truth_size(row))) continue;
    classes.rows[row] = HooverClass::over_segmented;
    for (const std::size_t column : columns) classes.column_is_used[column] = true;
  }
}

void find_under_segmented(const Contingency& c, HooverClasses& classes) {
  for (std::size_t column = 0; column < columns_of(c); ++column) {
    if (classes.column_is_used[column]) continue;
    std::vector<std::size_t> rows;
    std::int64_t covered = 0;
    for (std::size_t row = 0; row < classes.rows.size(); ++row) {
      if (classes.rows[row] != HooverClass::missed || !agrees(c.count(row, column), c.truth_size(row))) continue;
      rows.push_back(row);
      covered += c.count(row, column);
    }
    if (rows.size() < 2 || !agrees(covered, c.predicted_size(column))) continue;
    classes.column_is_used[column] = true;
    for (const std::size_t row : rows) classes.rows[row] = HooverClass::under_segmented;
  }
}

HooverCounts count_hoover(const Contingency& c, const std::vector<bool>& rows, const std::vector<bool>& columns) {
  HooverClasses classes{std::vector<HooverClass>(rows.size(), HooverClass::missed),
                        std::vector<bool>(columns.size(), false)};
  find_detected(c, classes);
  find_over_segmented(c, classes);
  find_under_segmented(c, classes);
  HooverCounts counts;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!rows[row]) continue;
    counts.detected += classes.rows[row] == HooverClass::detected;
    counts.over_segmented += classes.rows[row] == HooverClass::over_segmented;
    counts.under_segmented += classes.rows[row] == HooverClass::under_segmented;
    counts.missed += classes.rows[row] == HooverClass::missed;
  }
  for (std::size_t column = 0; column < columns.size(); ++column)
    counts.noise += columns[column] && !classes.column_is_used[column];
  return counts;
}

/// Counts of the selected rows, with the points without a segment as one more segment.
Counts partition_counts(const Contingency& c, const std::vector<bool>& rows) {
  Counts counts(std::count(rows.begin(), rows.end(), true), c.counts.cols() + 1);
  Eigen::Index next = 0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!rows[row]) continue;
    counts.row(next).head(c.counts.cols()) = c.counts.row(static_cast<Eigen::Index>(row));
    counts(next++, c.counts.cols()) = c.unlabeled[row];
  }
  return counts;
}

SegmentationScores score(const Contingency& c, const Matching& matching, const std::vector<bool>& rows,
                         const std::vector<bool>& columns) {
  SegmentationScores scores;
  const std::vector<std::size_t> main_row = main_rows(c);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!rows[row]) continue;
    scores.tubes.push_back(score_tube(c, matching, main_row, row));
    scores.points += scores.tubes.back().points;
    scores.correct += scores.tubes.back().correct;
  }
  scores.background = count_background(c, columns);
  scores.predicted_tubes = static_cast<int>(std::count(columns.begin(), columns.end(), true));
  count_true_positives(c, rows, scores);
  scores.adjusted_rand_index = adjusted_rand_index(partition_counts(c, rows));
  scores.hoover = count_hoover(c, rows, columns);
  return scores;
}

/// Tubes without a point in the cloud cannot be found in it.
std::vector<bool> rows_of_tubes(const Contingency& c) {
  std::vector<bool> rows(c.truth_ids.size());
  for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = !c.is_bin(row) && c.truth_size(row) > 0;
  return rows;
}

}  // namespace

SegmentationScores score_tubes(const Contingency& contingency, const Matching& matching) {
  return score(contingency, matching, rows_of_tubes(contingency), std::vector<bool>(columns_of(contingency), true));
}

SegmentationScores score_tubes(const Contingency& contingency, const Matching& matching,
                               const std::vector<bool>& selected) {
  std::vector<bool> rows = rows_of_tubes(contingency);
  for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = rows[row] && selected[row];
  return score(contingency, matching, rows, columns_of_rows(contingency, rows));
}

double panoptic_quality(int tubes, int predicted, int true_positives, double true_positive_iou) {
  // TP + FP / 2 + FN / 2 = (tubes + predicted) / 2
  return tubes + predicted > 0 && true_positives > 0 ? 2.0 * true_positive_iou / (tubes + predicted) : 0.0;
}

double average_precision(int tubes, int predicted, int true_positives) {
  if (tubes == 0 || predicted == 0) return 0.0;
  return (static_cast<double>(true_positives) / tubes) * (static_cast<double>(true_positives) / predicted);
}

double adjusted_rand_index(const Counts& counts) {
  const auto pairs = [](std::int64_t n) { return 0.5 * static_cast<double>(n) * static_cast<double>(n - 1); };
  double same_both = 0.0;
  double same_truth = 0.0;
  double same_predicted = 0.0;
  for (Eigen::Index i = 0; i < counts.size(); ++i) same_both += pairs(counts.data()[i]);
  for (Eigen::Index row = 0; row < counts.rows(); ++row) same_truth += pairs(counts.row(row).sum());
  for (Eigen::Index column = 0; column < counts.cols(); ++column) same_predicted += pairs(counts.col(column).sum());
  const double all = pairs(counts.sum());
  const double expected = all > 0.0 ? same_truth * same_predicted / all : 0.0;
  const double largest = 0.5 * (same_truth + same_predicted);
  return largest > expected ? (same_both - expected) / (largest - expected) : 1.0;
}

}  // namespace tubebin::evaluation
