#include "evaluation/report/measures.hpp"

#include <fmt/format.h>

namespace tubebin::evaluation {
namespace {

Cell number(double value) { return number_cell(value, 3); }
Cell percent(double share) { return percent_cell(share); }
Cell count(double value) { return number_cell(value, 2); }
Cell signed_count(double value) { return {fmt::format("{:+.2f}", value), value}; }
Cell millimetres(double metres) { return {fmt::format("{:.2f}", 1000.0 * metres), metres}; }

Cell shown(const Measure& measure, const PooledScores& pooled, Cell (*cell)(double)) {
  return measure.of_centerlines && pooled.centerlines == 0 ? Cell() : cell(pooled.*measure.member);
}

}  // namespace

const std::vector<Measure>& measures() {
  using P = PooledScores;
  static const std::vector<Measure> list = {
      {"tube recall", "tube_recall", &P::recall, number, "Share of a tube's points in its matched segment."},
      {"tube precision", "tube_precision", &P::precision, number, "Share of a matched segment's points on its tube."},
      {"tube IoU", "tube_iou", &P::iou, number, "Points that a tube and its segment share, of all that either has."},
      {"panoptic quality", "panoptic_quality", &P::panoptic_quality, number,
       "How many tubes are found and how well, in one number."},
      {"AP at 0.5", "ap50", &P::average_precision_50, number, "Precision times recall of tubes with an IoU above 0.5."},
      {"AP at 0.5:0.95", "ap", &P::average_precision, number, "The same, as a mean over IoU 0.50 to 0.95."},
      {"Rand index", "adjusted_rand_index", &P::adjusted_rand_index, number,
       "Agreement of the two partitions: 1 is the same, 0 is chance."},
      {"detected", "detected", &P::detected, percent, "Tubes that one segment covers to 80 %, and hardly more."},
      {"over-segmented", "over_segmented", &P::over_segmented, percent, "Tubes that several segments share."},
      {"under-segmented", "under_segmented", &P::under_segmented, percent, "Tubes that one segment takes together."},
      {"missed", "missed", &P::missed, percent, "Tubes that are none of the three above."},
      {"noise", "noise", &P::noise, percent, "Segments that belong to no tube of the first three kinds."},
      {"tube count error", "tube_count_error", &P::tube_count_error, count, "Tubes too many or too few a scene."},
      {"tube count bias", "tube_count_bias", &P::tube_count_bias, signed_count,
       "Found less real tubes a scene: above 0, too many are found."},
      {"model to tube, mm", "centerline_model_mean_m", &P::centerline_model_mean, millimetres,
       "Mean distance of the modelled centreline to the real one.", true},
      {nullptr, "centerline_model_p95_m", &P::centerline_model_p95, millimetres, nullptr, true},
      {"tube to model, mm", "centerline_truth_mean_m", &P::centerline_truth_mean, millimetres,
       "Mean distance of the real centreline's visible part to the modelled one.", true},
      {nullptr, "centerline_truth_p95_m", &P::centerline_truth_p95, millimetres, nullptr, true},
  };
  return list;
}

void append_measure_headers(std::vector<std::string>& headers) {
  for (const Measure& measure : measures())
    if (measure.header != nullptr) headers.emplace_back(measure.header);
}

void append_measures(const PooledScores& pooled, std::vector<Cell>& row) {
  for (const Measure& measure : measures())
    if (measure.header != nullptr) row.push_back(shown(measure, pooled, measure.cell));
}

void append_measure_keys(std::vector<std::string>& headers) {
  for (const Measure& measure : measures()) headers.emplace_back(measure.key);
}

void append_exact_measures(const PooledScores& pooled, std::vector<Cell>& row) {
  for (const Measure& measure : measures()) row.push_back(shown(measure, pooled, exact_cell));
}

std::string sentence_of(const std::string& header) {
  if (header == "runs") return "Clouds modelled, each at each ratio.";
  if (header == "failed") return "Runs without a result; they count as zero.";
  if (header == "micro-recall") return "Share of the points that carry the right tube; in brackets, its 95 % interval.";
  if (header == "seconds a run") return "Mean time to model a cloud.";
  for (const Measure& measure : measures())
    if (measure.header != nullptr && measure.header == header) return measure.sentence;
  return "";
}

}  // namespace tubebin::evaluation
