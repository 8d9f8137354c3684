/// The tables that evaluate prints.
#pragma once

#include <string>
#include <vector>

#include "tubebin/evaluation/cloud_pair.hpp"
#include "tubebin/evaluation/evaluation.hpp"
#include "tubebin/evaluation/paper_comparison.hpp"
#include "tubebin/evaluation/summary.hpp"
#include "tubebin/evaluation/table.hpp"

namespace tubebin::evaluation {

enum class TableFormat { table, markdown, csv, json };

/// Micro-recall by number of tubes is shown at one ratio, by ratio for one number of tubes.
struct Conditions {
  double ratio = 0.3;
  int tubes = 10;
};
/// Those among the groups that are nearest to the defaults above.
Conditions shown_conditions(const std::vector<GroupSummary>& groups);

/// The methods and sets that occur, each once, in order.
std::vector<std::string> methods_of(const std::vector<GroupSummary>& groups);
std::vector<std::string> sets_of(const std::vector<GroupSummary>& groups);

/// One row a method and set: all measures over all its runs.
Table overview_table(const Evaluation& evaluation);
/// Mean micro-recall by number of tubes, or by ratio, one column a set, with intervals.
Table recall_by_tubes_table(const std::vector<GroupSummary>& groups, const std::string& method);
Table recall_by_ratio_table(const std::vector<GroupSummary>& groups, const std::string& method);
/// Ratios by numbers of tubes: mean micro-recall, or mean modelling time.
Table recall_grid(const std::vector<GroupSummary>& groups, const std::string& method, const std::string& set);
Table time_grid(const std::vector<GroupSummary>& groups, const std::string& method, const std::string& set);
/// All measures split by the visible share of the tubes; no rows where no scene is known.
Table visibility_table(const Evaluation& evaluation);

/// By number of tubes and by ratio for every method, where there are several of these.
std::vector<Table> condition_tables(const std::vector<GroupSummary>& groups);
/// The grids of every method and set and the measures by visibility, those that have rows.
std::vector<Table> detail_tables(const Evaluation& evaluation, const std::vector<GroupSummary>& groups);

/// One row a group with every measure, for programs.
Table group_table(const std::vector<GroupSummary>& groups);

/// The evaluation in the format, with the comparison with the paper where `generation` (maybe empty) is
/// given; `csv` is the group table alone.
std::string format_results(const Evaluation& evaluation, TableFormat format,
                           const GenerationSeconds* generation = nullptr);

/// A pair of clouds: one row a ground-truth segment with its match. Colours are written as `#rrggbb`.
Table matching_table(const Contingency& contingency, const Matching& matching, const PairedIds& pairs);

/// The pair's matching and micro-recall in the format; `csv` is the matching alone.
std::string format_pair(const PairedIds& pairs, TableFormat format);

}  // namespace tubebin::evaluation
