#include <fmt/format.h>

#include <algorithm>

#include "evaluation/statistics.hpp"
#include "tubebin/evaluation/paper_comparison.hpp"
#include "tubebin/evaluation/paper_figures.hpp"
#include "tubebin/evaluation/result_tables.hpp"

namespace tubebin::evaluation {

Table claims_table(const std::string& title, const std::vector<Claim>& claims) {
  Table table{title, {"claim", "paper", "here", "verdict"}, {}, ""};
  for (const Claim& claim : claims)
    table.rows.push_back(
        {claim.statement, claim.paper, claim.here.empty() ? "-" : claim.here, to_string(claim.verdict)});
  table.note = "In brackets: 95 % bootstrap intervals. docs/metrics.md says how each claim is tested.";
  return table;
}

Table paper_table_1(const GenerationSeconds& seconds) {
  Table table{"Seconds to generate a test case (Table 1)", {"tubes"}, {}, ""};
  std::map<int, std::vector<Cell>> rows;
  for (const auto& [set, by_tubes] : seconds) {
    for (const char* column : {"", " paper", " speed-up"}) table.headers.push_back(set + column);
    for (const auto& [tubes, values] : by_tubes) rows.try_emplace(tubes, std::vector<Cell>{integer_cell(tubes)});
  }
  for (auto& [tubes, row] : rows) {
    for (const auto& [set, by_tubes] : seconds) {
      const auto values = by_tubes.find(tubes);
      const auto paper_set = paper_figures().generation_seconds.find(set);
      const bool has_paper = paper_set != paper_figures().generation_seconds.end() && paper_set->second.contains(tubes);
      const bool has_ours = values != by_tubes.end();
      row.push_back(has_ours ? number_cell(mean(values->second), 3) : Cell());
      row.push_back(has_paper ? number_cell(paper_set->second.at(tubes), 2) : Cell());
      row.push_back(has_ours && has_paper ? number_cell(paper_set->second.at(tubes) / mean(values->second), 0)
                                          : Cell());
    }
    table.rows.push_back(row);
  }
  return table;
}

Table paper_table_2(const std::vector<GroupSummary>& groups, const std::string& method) {
  Table table{fmt::format("Seconds to model a cloud of set A, {} (Table 2)", method), {"ratio"}, {}, ""};
  const auto seconds = [&](double ratio, int tubes) -> Cell {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const GroupSummary& g) {
      return g.key == GroupKey{method, "A", tubes, ratio};
    });
    return group != groups.end() && group->seconds ? number_cell(group->seconds->mean, 3) : Cell();
  };
  const auto& paper = paper_figures().modelling_seconds;
  for (const auto& [tubes, value] : paper.begin()->second) {
    table.headers.push_back(count_of_tubes(tubes));
    table.headers.push_back("paper");
  }
  for (const auto& [ratio, by_tubes] : paper) {
    std::vector<Cell> row = {Cell(fmt::format("{}", ratio), ratio)};
    bool has_value = false;
    for (const auto& [tubes, value] : by_tubes) {
      row.push_back(seconds(ratio, tubes));
      has_value = has_value || row.back().value;
      row.push_back(number_cell(value, 2));
    }
    if (has_value) table.rows.push_back(std::move(row));
  }
  return table;
}

/// Our Figures 8 and 9 in numbers.
std::vector<Table> figure_tables(const std::vector<GroupSummary>& groups, const std::string& method) {
  std::vector<Table> tables = {recall_by_tubes_table(groups, method), recall_by_ratio_table(groups, method)};
  tables[0].title += " (Figure 8)";
  tables[1].title += " (Figure 9)";
  return tables;
}

std::vector<Table> paper_tables(const Evaluation& evaluation, const std::vector<GroupSummary>& groups,
                                const GenerationSeconds& seconds) {
  std::vector<Table> tables;
  const auto add_claims = [&](const std::string& title, const std::vector<Claim>& claims) {
    const bool is_measured = std::any_of(claims.begin(), claims.end(),
                                         [](const Claim& claim) { return claim.verdict != Verdict::not_measured; });
    if (is_measured) tables.push_back(claims_table(title, claims));
  };
  add_claims("Claims of Section 6.1", generation_claims(seconds));
  for (const std::string& method : methods_of(groups))
    add_claims(fmt::format("Claims of Section 6.2, {}", method), modelling_claims(evaluation.runs, method));
  tables.push_back(paper_table_1(seconds));
  for (const std::string& method : methods_of(groups)) {
    tables.push_back(paper_table_2(groups, method));
    for (Table& table : figure_tables(groups, method)) tables.push_back(std::move(table));
  }
  std::erase_if(tables, [](const Table& table) { return table.rows.empty(); });
  return tables;
}

}  // namespace tubebin::evaluation
