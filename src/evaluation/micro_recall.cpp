#include "tubebin/evaluation/micro_recall.hpp"

namespace tubebin {

Matching match_segments(const Contingency& contingency) {
  Matching matching;
  matching.column_of_row = max_weight_assignment(contingency.counts);
  matching.total = contingency.total();
  for (std::size_t row = 0; row < matching.column_of_row.size(); ++row) {
    const int column = matching.column_of_row[row];
    if (column != kUnmatched) matching.correct += contingency.count(row, static_cast<std::size_t>(column));
  }
  return matching;
}

}  // namespace tubebin
