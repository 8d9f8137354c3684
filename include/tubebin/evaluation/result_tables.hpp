/// The tables that evaluate prints: what was measured, laid out as the paper lays it out.
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

/// The conditions of Figures 8 and 9: the ratio and the number of tubes among the groups that are nearest to
/// the paper's 0.3 and 10.
struct FigureConditions {
  double figure_8_ratio = 0.3;
  int figure_9_tubes = 10;
};
FigureConditions figure_conditions(const std::vector<GroupSummary>& groups);

/// The methods and sets that occur, each once, in order.
std::vector<std::string> methods_of(const std::vector<GroupSummary>& groups);
std::vector<std::string> sets_of(const std::vector<GroupSummary>& groups);

/// One row a method and set: all measures over all its runs.
Table overview_table(const Evaluation& evaluation);
/// Mean micro-recall by number of tubes (Figure 8), or by ratio (Figure 9), one column a set, with intervals.
Table figure_8_table(const std::vector<GroupSummary>& groups, const std::string& method);
Table figure_9_table(const std::vector<GroupSummary>& groups, const std::string& method);
/// Ratios by numbers of tubes, as Table 2: mean micro-recall, or mean modelling time.
Table recall_grid(const std::vector<GroupSummary>& groups, const std::string& method, const std::string& set);
Table time_grid(const std::vector<GroupSummary>& groups, const std::string& method, const std::string& set);
/// All measures split by the visible share of the tubes; no rows where no scene is known.
Table visibility_table(const Evaluation& evaluation);

/// Everything above that has rows.
std::vector<Table> result_tables(const Evaluation& evaluation, const std::vector<GroupSummary>& groups);

/// One row a group with every measure, for programs.
Table group_table(const std::vector<GroupSummary>& groups);

/// The evaluation in the format, with the paper's figures and claims where `generation` (maybe empty) is
/// given; `csv` is the group table alone.
std::string format_results(const Evaluation& evaluation, TableFormat format,
                           const GenerationSeconds* generation = nullptr);

/// A pair of clouds: one row a ground-truth segment with its match. Colours are written as #rrggbb.
Table matching_table(const Contingency& contingency, const Matching& matching, const PairedIds& pairs);

/// The pair's matching and micro-recall in the format; `csv` is the matching alone.
std::string format_pair(const PairedIds& pairs, TableFormat format);

}  // namespace tubebin::evaluation
