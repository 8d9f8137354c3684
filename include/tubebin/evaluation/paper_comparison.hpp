/// What the paper found (Section 6) against what was measured here.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tubebin/evaluation/evaluation.hpp"
#include "tubebin/evaluation/plot.hpp"
#include "tubebin/evaluation/summary.hpp"
#include "tubebin/evaluation/table.hpp"

namespace tubebin::evaluation {

/// Seconds to generate each test case, by set and number of tubes; empty where they are not known.
using GenerationSeconds = std::map<std::string, std::map<int, std::vector<double>>>;

enum class Verdict { not_measured, confirmed, not_confirmed };
/// "confirmed", "not confirmed", "not measured".
const char* to_string(Verdict verdict);

/// A statement of the paper, tested on our runs.
struct Claim {
  std::string statement;
  std::string paper;  ///< its figures
  std::string here;   ///< ours, by how much it holds or fails
  Verdict verdict = Verdict::not_measured;
};

/// Claims about the modelling algorithm (Section 6.2), tested on the runs of one method. docs/metrics.md says
/// how each is tested.
std::vector<Claim> modelling_claims(const std::vector<RunScore>& runs, const std::string& method);
/// Claims about the generator (Section 6.1).
std::vector<Claim> generation_claims(const GenerationSeconds& seconds);

Table claims_table(const std::string& title, const std::vector<Claim>& claims);

/// Table 1 with the paper's columns beside ours; no rows without generation times.
Table paper_table_1(const GenerationSeconds& seconds);
/// Table 2 (set A) with the paper's columns beside ours.
Table paper_table_2(const std::vector<GroupSummary>& groups, const std::string& method);

/// Figures 8 and 9 as tables: our values under the paper's conditions, or the nearest to them.
std::vector<Table> figure_tables(const std::vector<GroupSummary>& groups, const std::string& method);

/// Everything above that has rows: claims, then tables and figures.
std::vector<Table> paper_tables(const Evaluation& evaluation, const std::vector<GroupSummary>& groups,
                                const GenerationSeconds& seconds);

/// Figures 8 and 9, and Tables 1 and 2 as plots, with the paper's values; those that have data.
std::vector<Plot> paper_plots(const std::vector<GroupSummary>& groups, const GenerationSeconds& seconds);

}  // namespace tubebin::evaluation
