#include <nlohmann/json.hpp>

#include "tubebin/evaluation/result_tables.hpp"

namespace tubebin {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson rows_as_objects(const Table& table) {
  OrderedJson rows = OrderedJson::array();
  for (const auto& cells : table.rows) {
    OrderedJson row;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].value)
        row[table.headers[i]] = *cells[i].value;
      else if (cells[i].text.empty())
        row[table.headers[i]] = nullptr;
      else
        row[table.headers[i]] = cells[i].text;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string format_json(const Evaluation& evaluation, const std::vector<GroupSummary>& groups) {
  OrderedJson json;
  json["source"] = evaluation.source;
  json["runs"] = evaluation.runs.size();
  json["missing"] = evaluation.missing;
  json["failed"] = evaluation.failed;
  json["notes"] = evaluation.notes;
  json["overview"] = rows_as_objects(overview_table(evaluation));
  json["groups"] = rows_as_objects(group_table(groups));
  json["by_visibility"] = rows_as_objects(visibility_table(evaluation));
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace

std::string format_results(const Evaluation& evaluation, TableFormat format) {
  const std::vector<GroupSummary> groups = summarize(evaluation.runs);
  if (format == TableFormat::json) return format_json(evaluation, groups);
  if (format == TableFormat::csv) return format_csv(group_table(groups));
  std::string text;
  for (const Table& table : result_tables(evaluation, groups)) {
    if (!text.empty()) text += "\n";
    text += format == TableFormat::markdown ? format_markdown(table) : format_text(table);
  }
  return text;
}

}  // namespace tubebin
