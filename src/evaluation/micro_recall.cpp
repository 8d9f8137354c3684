#include "tubebin/evaluation/micro_recall.hpp"

namespace tubebin::evaluation {

Matching match_segments(const Contingency& contingency, BinPoints bin_points) {
  Counts weights = contingency.counts;
  Matching matching;
  for (std::size_t row = 0; row < contingency.truth_ids.size(); ++row) {
    if (bin_points == BinPoints::left_out && contingency.is_bin(row))
      weights.row(static_cast<Eigen::Index>(row)).setZero();
    else matching.total += contingency.truth_size(row);
  }
  matching.column_of_row = max_weight_assignment(weights);
  for (std::size_t row = 0; row < matching.column_of_row.size(); ++row) {
    const int column = matching.column_of_row[row];
    if (column != kUnmatched) matching.correct += contingency.count(row, static_cast<std::size_t>(column));
  }
  return matching;
}

}  // namespace tubebin::evaluation
