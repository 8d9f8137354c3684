/// The paper's metric (Section 5): ground-truth segments matched with predicted ones, and micro-recall.
#pragma once

#include "tubebin/evaluation/contingency.hpp"

namespace tubebin::evaluation {

/// The matching M between ground-truth and predicted segments.
struct Matching {
  std::vector<int> column_of_row;  ///< into the contingency's rows and columns; kUnmatched where there is none
  std::int64_t correct = 0;        ///< points whose predicted segment is the one matched with their own
  std::int64_t total = 0;          ///< points of the filtered cloud

  /// Equation 1; 0 for a cloud without points.
  double micro_recall() const { return total > 0 ? static_cast<double>(correct) / static_cast<double>(total) : 0.0; }
};

/// What becomes of the bin's points, where the contingency tells them apart.
enum class BinPoints {
  counted,  ///< in a filtered cloud: the filter left them, so they count, and their segment takes part
  left_out  ///< in an unfiltered cloud: they are neither points to label nor a segment to match
};

/// The null segment is never matched.
Matching match_segments(const Contingency& contingency, BinPoints bin_points = BinPoints::counted);

}  // namespace tubebin::evaluation
