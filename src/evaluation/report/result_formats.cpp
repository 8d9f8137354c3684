#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "evaluation/report/side_by_side.hpp"
#include "tubebin/evaluation/result_tables.hpp"

namespace tubebin::evaluation {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson rows_as_objects(const Table& table) {
  OrderedJson rows = OrderedJson::array();
  for (const auto& cells : table.rows) {
    OrderedJson row;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].value) row[table.headers[i]] = *cells[i].value;
      else if (cells[i].text.empty()) row[table.headers[i]] = nullptr;
      else row[table.headers[i]] = cells[i].text;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

OrderedJson claims_as_objects(const std::vector<Claim>& claims) {
  OrderedJson list = OrderedJson::array();
  for (const Claim& claim : claims)
    list.push_back({{"claim", claim.statement},
                    {"paper", claim.paper},
                    {"here", claim.here},
                    {"verdict", to_string(claim.verdict)}});
  return list;
}

OrderedJson comparisons_as_objects(const std::vector<Comparison>& comparisons) {
  OrderedJson list = OrderedJson::array();
  for (const Comparison& one : comparisons)
    list.push_back({{"first", one.first},
                    {"second", one.second},
                    {"set", one.set},
                    {"scenes", one.scenes},
                    {"micro_recall_first", one.recall_first},
                    {"micro_recall_second", one.recall_second},
                    {"gain", one.gain.mean},
                    {"gain_low", one.gain.low},
                    {"gain_high", one.gain.high},
                    {"better", one.better},
                    {"worse", one.worse}});
  return list;
}

std::string format_json(const Evaluation& evaluation, const std::vector<GroupSummary>& groups,
                        const GenerationSeconds* generation) {
  OrderedJson json;
  json["source"] = evaluation.source;
  json["runs"] = evaluation.runs.size();
  json["missing"] = evaluation.missing;
  json["failed"] = evaluation.failed;
  json["notes"] = evaluation.notes;
  json["overview"] = rows_as_objects(overview_table(evaluation));
  json["side_by_side"] = comparisons_as_objects(compare_methods(evaluation.runs));
  json["groups"] = rows_as_objects(group_table(groups));
  json["by_visibility"] = rows_as_objects(visibility_table(evaluation));
  if (generation != nullptr) {
    json["claims"]["generation"] = claims_as_objects(generation_claims(*generation));
    for (const std::string& method : methods_of(groups))
      json["claims"][method] = claims_as_objects(modelling_claims(evaluation.runs, method));
  }
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

/// A ground-truth segment with its match.
std::vector<Cell> matching_row(const Contingency& contingency, const Matching& matching, const PairedIds& pairs,
                               std::size_t row) {
  const auto name = [](SegmentId id, bool is_color) {
    return fmt::format(fmt::runtime(is_color ? "#{:06x}" : "{}"), id);
  };
  const std::int64_t truth_size = contingency.truth_size(row);
  const std::string bin = contingency.is_bin(row) ? " (bin)" : "";
  std::vector<Cell> cells = {name(contingency.truth_ids[row], pairs.truth_is_color) + bin, integer_cell(truth_size)};
  std::int64_t predicted_size = 0;
  std::int64_t correct = 0;
  if (const int matched = matching.column_of_row[row]; matched != kUnmatched) {
    const auto column = static_cast<std::size_t>(matched);
    predicted_size = contingency.predicted_size(column);
    correct = contingency.count(row, column);
    cells.push_back(name(contingency.predicted_ids[column], pairs.predicted_is_color));
  } else {
    cells.push_back("none");
  }
  cells.push_back(integer_cell(predicted_size));
  cells.push_back(integer_cell(correct));
  for (const std::int64_t whole : {truth_size, predicted_size, truth_size + predicted_size - correct})
    cells.push_back(number_cell(whole > 0 ? static_cast<double>(correct) / static_cast<double>(whole) : 0.0, 4));
  return cells;
}

std::string pair_summary(const PairedIds& pairs, const Contingency& contingency, const Matching& matching) {
  std::string text = fmt::format("{} ground-truth segments, {} labels; ", contingency.truth_ids.size(),
                                 contingency.predicted_ids.size());
  const std::int64_t unlabeled =
      std::accumulate(contingency.unlabeled.begin(), contingency.unlabeled.end(), std::int64_t{0});
  text += fmt::format("{} points without a label", unlabeled);
  if (pairs.missing > 0) text += fmt::format(" ({} of them not in the labelled cloud)", pairs.missing);
  if (pairs.unannotated > 0) text += fmt::format("; {} black points without ground truth left out", pairs.unannotated);
  return text + fmt::format("\nmicro-recall {:.6f} = {} / {} points\n", matching.micro_recall(), matching.correct,
                            matching.total);
}

}  // namespace

Table matching_table(const Contingency& contingency, const Matching& matching, const PairedIds& pairs) {
  Table table{"Matching of ground truth and labels",
              {"ground truth", "points", "label", "points of label", "correct", "recall", "precision", "IoU"},
              {},
              ""};
  for (std::size_t row = 0; row < contingency.truth_ids.size(); ++row)
    table.rows.push_back(matching_row(contingency, matching, pairs, row));
  return table;
}

std::string format_pair(const PairedIds& pairs, TableFormat format) {
  const Contingency contingency = count_pairs(pairs.truth, pairs.predicted, pairs.bin_id);
  const Matching matching = match_segments(contingency);
  const Table table = matching_table(contingency, matching, pairs);
  if (format == TableFormat::csv) return format_csv(table);
  if (format == TableFormat::json)
    return OrderedJson{{"micro_recall", matching.micro_recall()},
                       {"correct", matching.correct},
                       {"points", matching.total},
                       {"missing", pairs.missing},
                       {"unannotated", pairs.unannotated},
                       {"labels", contingency.predicted_ids.size()},
                       {"matching", rows_as_objects(table)}}
               .dump(2) +
           "\n";
  return (format == TableFormat::markdown ? format_markdown(table) : format_text(table)) + "\n" +
         pair_summary(pairs, contingency, matching);
}

std::string format_results(const Evaluation& evaluation, TableFormat format, const GenerationSeconds* generation) {
  const std::vector<GroupSummary> groups = summarize(evaluation.runs);
  if (format == TableFormat::json) return format_json(evaluation, groups, generation);
  if (format == TableFormat::csv) return format_csv(group_table(groups));
  std::vector<Table> tables =
      generation != nullptr ? paper_tables(evaluation, groups, *generation) : condition_tables(groups);
  if (const auto comparisons = compare_methods(evaluation.runs); !comparisons.empty())
    tables.insert(tables.begin(), side_by_side_table(comparisons));
  tables.insert(tables.begin(), transpose(overview_table(evaluation), 2));
  for (Table& table : detail_tables(evaluation, groups)) tables.push_back(std::move(table));
  std::string text;
  for (const Table& table : tables) {
    if (!text.empty()) text += "\n";
    text += format == TableFormat::markdown ? format_markdown(table) : format_text(table);
  }
  return text;
}

}  // namespace tubebin::evaluation
