#include "tubebin/evaluation/result_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "evaluation/report/measures.hpp"

namespace tubebin::evaluation {
namespace {

Cell interval_cell(const Interval& interval, int decimals) {
  return {fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", interval.mean, decimals, interval.low, decimals, interval.high,
                      decimals),
          interval.mean};
}

template <typename Value, typename Get>
std::vector<Value> distinct(const std::vector<GroupSummary>& groups, Get get) {
  std::set<Value> values;
  for (const GroupSummary& group : groups) values.insert(get(group.key));
  return {values.begin(), values.end()};
}

template <typename Value>
Value nearest(const std::vector<Value>& values, Value wanted) {
  return *std::min_element(values.begin(), values.end(),
                           [&](Value a, Value b) { return std::abs(a - wanted) < std::abs(b - wanted); });
}

std::vector<int> tubes_of(const std::vector<GroupSummary>& groups) {
  return distinct<int>(groups, [](const GroupKey& key) { return key.tubes; });
}
std::vector<double> ratios_of(const std::vector<GroupSummary>& groups) {
  return distinct<double>(groups, [](const GroupKey& key) { return key.ratio; });
}

const GroupSummary* find_group(const std::vector<GroupSummary>& groups, const GroupKey& key) {
  const auto group = std::find_if(groups.begin(), groups.end(), [&](const GroupSummary& g) { return g.key == key; });
  return group == groups.end() ? nullptr : &*group;
}

std::vector<std::string> set_headers(std::string first, const std::vector<GroupSummary>& groups) {
  std::vector<std::string> headers = {std::move(first)};
  for (const std::string& set : sets_of(groups)) headers.push_back("set " + set);
  return headers;
}

/// A row's cells: the mean micro-recall of each set under the row's condition.
std::vector<Cell> recall_row(Cell first, const std::vector<GroupSummary>& groups, const std::string& method, int tubes,
                             double ratio, bool& has_value) {
  std::vector<Cell> row = {std::move(first)};
  for (const std::string& set : sets_of(groups)) {
    const GroupSummary* group = find_group(groups, {method, set, tubes, ratio});
    has_value = has_value || group != nullptr;
    row.push_back(group != nullptr ? interval_cell(group->micro_recall, 3) : Cell());
  }
  return row;
}

template <typename MakeCell>
Table grid(std::string title, const std::vector<GroupSummary>& groups, const std::string& method,
           const std::string& set, MakeCell make_cell) {
  Table table{std::move(title), {"ratio"}, {}, ""};
  const std::vector<int> tubes = tubes_of(groups);
  for (const int count : tubes) table.headers.push_back(fmt::format("{}", count));
  for (const double ratio : ratios_of(groups)) {
    std::vector<Cell> row = {Cell(fmt::format("{}", ratio), ratio)};
    bool has_value = false;
    for (const int count : tubes) {
      const GroupSummary* group = find_group(groups, {method, set, count, ratio});
      row.push_back(group != nullptr ? make_cell(*group) : Cell());
      has_value = has_value || row.back().value;
    }
    if (has_value) table.rows.push_back(std::move(row));
  }
  return table;
}

/// The visibility table of each method with its classes as columns.
std::vector<Table> visibility_tables(const Evaluation& evaluation) {
  std::map<std::string, Table> by_method;
  const Table all = visibility_table(evaluation);
  for (const auto& row : all.rows) {
    Table& table = by_method.try_emplace(row[0].text, Table{all.title + ", " + row[0].text, all.headers, {}, all.note})
                       .first->second;
    table.rows.push_back(row);
  }
  std::vector<Table> tables;
  for (auto& [method, table] : by_method) {
    for (auto& row : table.rows) row[0] = Cell();
    tables.push_back(transpose(table, 2));
  }
  return tables;
}

std::vector<std::string> with_measures(std::vector<std::string> headers) {
  append_measure_headers(headers);
  return headers;
}

std::map<std::pair<std::string, std::string>, std::vector<const RunScore*>> runs_by_method_and_set(
    const Evaluation& evaluation) {
  std::map<std::pair<std::string, std::string>, std::vector<const RunScore*>> runs;
  for (const RunScore& run : evaluation.runs) runs[{run.key.method, run.key.set}].push_back(&run);
  return runs;
}

}  // namespace

Conditions shown_conditions(const std::vector<GroupSummary>& groups) {
  const Conditions usual;
  return {nearest(ratios_of(groups), usual.ratio), nearest(tubes_of(groups), usual.tubes)};
}

std::vector<std::string> methods_of(const std::vector<GroupSummary>& groups) {
  return distinct<std::string>(groups, [](const GroupKey& key) { return key.method; });
}

std::vector<std::string> sets_of(const std::vector<GroupSummary>& groups) {
  return distinct<std::string>(groups, [](const GroupKey& key) { return key.set; });
}

Table overview_table(const Evaluation& evaluation) {
  Table table{"Overview: all runs of a method on a set together",
              with_measures({"method", "set", "runs", "failed", "micro-recall", "seconds a run"}),
              {},
              ""};
  for (const auto& [key, runs] : runs_by_method_and_set(evaluation)) {
    const GroupSummary group = summarize_together(key.first, key.second, runs);
    std::vector<Cell> row = {key.first,
                             key.second,
                             integer_cell(group.runs),
                             integer_cell(group.failed),
                             interval_cell(group.micro_recall, 4),
                             group.seconds ? number_cell(group.seconds->mean, 3) : Cell()};
    append_measures(group.pooled, row);
    table.rows.push_back(std::move(row));
  }
  table.note = "In brackets: 95 % bootstrap intervals. docs/metrics.md defines every measure.";
  return table;
}

Table recall_by_tubes_table(const std::vector<GroupSummary>& groups, const std::string& method) {
  const double ratio = shown_conditions(groups).ratio;
  Table table{fmt::format("Mean micro-recall by number of tubes, ratio {}, {}", ratio, method),
              set_headers("tubes", groups),
              {},
              ""};
  for (const int tubes : tubes_of(groups)) {
    bool has_value = false;
    std::vector<Cell> row = recall_row(integer_cell(tubes), groups, method, tubes, ratio, has_value);
    if (has_value) table.rows.push_back(std::move(row));
  }
  return table;
}

Table recall_by_ratio_table(const std::vector<GroupSummary>& groups, const std::string& method) {
  const int tubes = shown_conditions(groups).tubes;
  Table table{fmt::format("Mean micro-recall by ratio, {}, {}", count_of_tubes(tubes), method),
              set_headers("ratio", groups),
              {},
              ""};
  for (const double ratio : ratios_of(groups)) {
    bool has_value = false;
    std::vector<Cell> row = recall_row({fmt::format("{}", ratio), ratio}, groups, method, tubes, ratio, has_value);
    if (has_value) table.rows.push_back(std::move(row));
  }
  return table;
}

Table recall_grid(const std::vector<GroupSummary>& groups, const std::string& method, const std::string& set) {
  return grid(fmt::format("Mean micro-recall by ratio and number of tubes, {}, set {}", method, set), groups, method,
              set, [](const GroupSummary& group) { return number_cell(group.micro_recall.mean, 3); });
}

Table time_grid(const std::vector<GroupSummary>& groups, const std::string& method, const std::string& set) {
  return grid(fmt::format("Mean modelling time in seconds by ratio and number of tubes, {}, set {}", method, set),
              groups, method, set,
              [](const GroupSummary& group) { return group.seconds ? number_cell(group.seconds->mean, 3) : Cell(); });
}

Table visibility_table(const Evaluation& evaluation) {
  Table table{"By the visible share of the tube's centreline",
              with_measures({"method", "visible", "tubes", "micro-recall"}),
              {},
              ""};
  std::map<std::string, std::vector<const RunScore*>> runs_of_method;
  for (const RunScore& run : evaluation.runs)
    if (!run.by_visibility.empty()) runs_of_method[run.key.method].push_back(&run);
  for (const auto& [method, runs] : runs_of_method) {
    for (int c = 0; c < kVisibilityClasses; ++c) {
      std::vector<const SegmentationScores*> scores;
      std::int64_t correct = 0;
      std::int64_t points = 0;
      for (const RunScore* run : runs) {
        scores.push_back(&run->by_visibility[static_cast<std::size_t>(c)]);
        correct += scores.back()->correct;
        points += scores.back()->points;
      }
      const PooledScores pooled = pool(scores);
      if (points == 0) continue;
      std::vector<Cell> row = {method, visibility_class_name(c), integer_cell(pooled.tubes),
                               number_cell(static_cast<double>(correct) / static_cast<double>(points), 4)};
      append_measures(pooled, row);
      table.rows.push_back(std::move(row));
    }
  }
  table.note = "Micro-recall here is over the points of these tubes in all runs together.";
  return table;
}

std::vector<Table> condition_tables(const std::vector<GroupSummary>& groups) {
  std::vector<Table> tables;
  for (const std::string& method : methods_of(groups)) {
    tables.push_back(recall_by_tubes_table(groups, method));
    tables.push_back(recall_by_ratio_table(groups, method));
  }
  std::erase_if(tables, [](const Table& table) { return table.rows.size() < 2; });
  return tables;
}

std::vector<Table> detail_tables(const Evaluation& evaluation, const std::vector<GroupSummary>& groups) {
  std::vector<Table> tables;
  for (const std::string& method : methods_of(groups)) {
    for (const std::string& set : sets_of(groups)) tables.push_back(recall_grid(groups, method, set));
    for (const std::string& set : sets_of(groups)) tables.push_back(time_grid(groups, method, set));
  }
  for (Table& table : visibility_tables(evaluation)) tables.push_back(std::move(table));
  std::erase_if(tables, [](const Table& table) { return table.rows.empty(); });
  return tables;
}

Table group_table(const std::vector<GroupSummary>& groups) {
  Table table{"Groups",
              {"method", "set", "tubes", "ratio", "runs", "failed", "micro_recall", "micro_recall_low",
               "micro_recall_high", "seconds", "seconds_low", "seconds_high"},
              {},
              ""};
  append_measure_keys(table.headers);
  for (const GroupSummary& group : groups) {
    std::vector<Cell> row = {group.key.method,
                             group.key.set,
                             integer_cell(group.key.tubes),
                             number_cell(group.key.ratio, 2),
                             integer_cell(group.runs),
                             integer_cell(group.failed)};
    for (const std::optional<Interval>& interval : {std::optional(group.micro_recall), group.seconds})
      for (double Interval::*member : {&Interval::mean, &Interval::low, &Interval::high})
        row.push_back(interval ? exact_cell((*interval).*member) : Cell());
    append_exact_measures(group.pooled, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace tubebin::evaluation
