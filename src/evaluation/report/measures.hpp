/// The measures of docs/metrics.md as tables show them: one list for people's tables and for programs' columns.
#pragma once

#include <string>
#include <vector>

#include "tubebin/evaluation/summary.hpp"
#include "tubebin/evaluation/table.hpp"

namespace tubebin::evaluation {

struct Measure {
  const char* header;  ///< of people's tables; null: a column for programs alone
  const char* key;     ///< of the column in CSV and JSON
  double PooledScores::*member;
  Cell (*cell)(double value);  ///< as people read it
  const char* sentence;        ///< its meaning, for the report; null where there is no header
  bool of_centerlines = false;
};

/// In the order of the columns.
const std::vector<Measure>& measures();

/// The headers of people's tables, and their cells. A measure of centrelines is empty where no tube has one.
void append_measure_headers(std::vector<std::string>& headers);
void append_measures(const PooledScores& pooled, std::vector<Cell>& row);
/// The same for programs, with every measure.
void append_measure_keys(std::vector<std::string>& headers);
void append_exact_measures(const PooledScores& pooled, std::vector<Cell>& row);

/// A sentence on the row or column of the overview; empty for a header that it does not have.
std::string sentence_of(const std::string& header);

/// A number as programs read it.
inline Cell exact_cell(double value) { return number_cell(value, 6); }

}  // namespace tubebin::evaluation
