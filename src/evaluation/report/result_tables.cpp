#include "tubebin/evaluation/result_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace tubebin::evaluation {
namespace {

constexpr double kPaperFigure8Ratio = 0.3;
constexpr int kPaperFigure9Tubes = 10;

Cell interval_cell(const Interval& interval, int decimals) {
  return {fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", interval.mean, decimals, interval.low, decimals, interval.high,
                      decimals),
          interval.mean};
}

Cell millimetre_cell(double metres) { return {fmt::format("{:.2f}", 1000.0 * metres), metres}; }

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

const std::vector<std::string> kMeasureHeaders = {
    "tube recall",      "tube precision",  "tube IoU",          "panoptic quality", "AP at 0.5", "AP at 0.5:0.95",
    "Rand index",       "detected",        "over-segmented",    "under-segmented",  "missed",    "noise",
    "tube count error", "tube count bias", "model to tube, mm", "tube to model, mm"};

void append_measures(const PooledScores& pooled, std::vector<Cell>& row) {
  for (const double value : {pooled.recall, pooled.precision, pooled.iou, pooled.panoptic_quality,
                             pooled.average_precision_50, pooled.average_precision, pooled.adjusted_rand_index})
    row.push_back(number_cell(value, 3));
  for (const double share :
       {pooled.detected, pooled.over_segmented, pooled.under_segmented, pooled.missed, pooled.noise})
    row.push_back(percent_cell(share));
  row.push_back(number_cell(pooled.tube_count_error, 2));
  row.push_back({fmt::format("{:+.2f}", pooled.tube_count_bias), pooled.tube_count_bias});
  row.push_back(pooled.centerlines > 0 ? millimetre_cell(pooled.centerline_model_mean) : Cell());
  row.push_back(pooled.centerlines > 0 ? millimetre_cell(pooled.centerline_truth_mean) : Cell());
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
  headers.insert(headers.end(), kMeasureHeaders.begin(), kMeasureHeaders.end());
  return headers;
}

std::map<std::pair<std::string, std::string>, std::vector<const RunScore*>> runs_by_method_and_set(
    const Evaluation& evaluation) {
  std::map<std::pair<std::string, std::string>, std::vector<const RunScore*>> runs;
  for (const RunScore& run : evaluation.runs) runs[{run.key.method, run.key.set}].push_back(&run);
  return runs;
}

}  // namespace

FigureConditions figure_conditions(const std::vector<GroupSummary>& groups) {
  return {nearest(ratios_of(groups), kPaperFigure8Ratio), nearest(tubes_of(groups), kPaperFigure9Tubes)};
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

Table figure_8_table(const std::vector<GroupSummary>& groups, const std::string& method) {
  const double ratio = figure_conditions(groups).figure_8_ratio;
  Table table{fmt::format("Mean micro-recall by number of tubes, ratio {}, {} (Figure 8)", ratio, method),
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

Table figure_9_table(const std::vector<GroupSummary>& groups, const std::string& method) {
  const int tubes = figure_conditions(groups).figure_9_tubes;
  Table table{fmt::format("Mean micro-recall by ratio, {}, {} (Figure 9)", count_of_tubes(tubes), method),
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
  return grid(
      fmt::format("Mean modelling time in seconds by ratio and number of tubes, {}, set {} (Table 2)", method, set),
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

std::vector<Table> result_tables(const Evaluation& evaluation, const std::vector<GroupSummary>& groups) {
  std::vector<Table> tables = {transpose(overview_table(evaluation), 2)};
  for (const std::string& method : methods_of(groups)) {
    tables.push_back(figure_8_table(groups, method));
    tables.push_back(figure_9_table(groups, method));
    for (const std::string& set : sets_of(groups)) tables.push_back(recall_grid(groups, method, set));
    for (const std::string& set : sets_of(groups)) tables.push_back(time_grid(groups, method, set));
  }
  for (Table& table : visibility_tables(evaluation)) tables.push_back(std::move(table));
  std::erase_if(tables, [](const Table& table) { return table.rows.empty(); });
  return tables;
}

Table group_table(const std::vector<GroupSummary>& groups) {
  Table table{"Groups",
              {"method",
               "set",
               "tubes",
               "ratio",
               "runs",
               "failed",
               "micro_recall",
               "micro_recall_low",
               "micro_recall_high",
               "seconds",
               "seconds_low",
               "seconds_high",
               "tube_recall",
               "tube_precision",
               "tube_iou",
               "panoptic_quality",
               "ap50",
               "ap",
               "adjusted_rand_index",
               "detected",
               "over_segmented",
               "under_segmented",
               "missed",
               "noise",
               "tube_count_error",
               "tube_count_bias",
               "centerline_model_mean_m",
               "centerline_model_p95_m",
               "centerline_truth_mean_m",
               "centerline_truth_p95_m"},
              {},
              ""};
  for (const GroupSummary& group : groups) {
    const PooledScores& p = group.pooled;
    std::vector<Cell> row = {group.key.method,
                             group.key.set,
                             integer_cell(group.key.tubes),
                             number_cell(group.key.ratio, 2),
                             integer_cell(group.runs),
                             integer_cell(group.failed)};
    const auto add = [&](double value) { row.push_back(number_cell(value, 6)); };
    for (const double value : {group.micro_recall.mean, group.micro_recall.low, group.micro_recall.high}) add(value);
    if (group.seconds)
      for (const double value : {group.seconds->mean, group.seconds->low, group.seconds->high}) add(value);
    else row.insert(row.end(), 3, Cell());
    for (const double value : {p.recall, p.precision, p.iou, p.panoptic_quality, p.average_precision_50,
                               p.average_precision, p.adjusted_rand_index, p.detected, p.over_segmented,
                               p.under_segmented, p.missed, p.noise, p.tube_count_error, p.tube_count_bias})
      add(value);
    if (p.centerlines > 0)
      for (const double value :
           {p.centerline_model_mean, p.centerline_model_p95, p.centerline_truth_mean, p.centerline_truth_p95})
        add(value);
    else row.insert(row.end(), 4, Cell());
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace tubebin::evaluation
