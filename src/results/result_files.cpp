#include "results/result_files.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "core/json_reader.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::results {
namespace {

constexpr const char* kResultFormat = "tubebin result 1";
constexpr int kMaxPoints = std::numeric_limits<int>::max();
constexpr std::uint64_t kMaxLabel = std::numeric_limits<std::uint32_t>::max();
// Tubes are compared at samples 5 mm apart, so there must be an end to their length.
constexpr Limits kCoordinate = {-1000.0, 1000.0};
constexpr double kMaxModelLength = 10'000.0;
constexpr Limits kRadius = {0.0, 1000.0};
constexpr Limits kLabelingRadius = {1e-6, 1000.0};  // a surface has one
constexpr Limits kSeconds = {0.0, 1e9};

void check_format(const JsonPlace& root, const char* expected) {
  if (root.at("format").text() != expected) root.at("format").fail(fmt::format("\"{}\"", expected));
}

std::string optional_text(const JsonPlace& root, const char* key) { return root.has(key) ? root.at(key).text() : ""; }

evaluation::Contingency read_contingency(const JsonPlace& root, const std::string& name) {
  if (!root.has("contingency"))
    throw_io_error("{}: /contingency: missing; the cloud has neither labels nor known colours, so it cannot be scored",
                   name);
  std::vector<std::tuple<evaluation::SegmentId, evaluation::SegmentId, std::int64_t>> entries;
  std::set<evaluation::SegmentId> truth_ids;
  std::set<evaluation::SegmentId> predicted_ids;
  for (const JsonPlace& entry : root.at("contingency").elements()) {
    const std::vector<JsonPlace> parts = entry.elements(3);
    const auto truth = static_cast<evaluation::SegmentId>(parts[0].whole(0, kMaxLabel));
    const auto predicted = static_cast<evaluation::SegmentId>(parts[1].whole(0, kMaxLabel));
    entries.emplace_back(truth, predicted, static_cast<std::int64_t>(parts[2].whole(0, kMaxPoints)));
    truth_ids.insert(truth);
    if (predicted != evaluation::kNullId) predicted_ids.insert(predicted);
  }
  evaluation::require_segments(truth_ids.size(), predicted_ids.size(), name);
  evaluation::Contingency contingency;
  contingency.bin_id = 0;
  contingency.truth_ids.assign(truth_ids.begin(), truth_ids.end());
  contingency.predicted_ids.assign(predicted_ids.begin(), predicted_ids.end());
  contingency.unlabeled.assign(truth_ids.size(), 0);
  contingency.counts = evaluation::Counts::Zero(static_cast<Eigen::Index>(truth_ids.size()),
                                                static_cast<Eigen::Index>(predicted_ids.size()));
  for (const auto& [truth, predicted, points] : entries) {
    const auto row = std::distance(truth_ids.begin(), truth_ids.find(truth));
    if (predicted == evaluation::kNullId) contingency.unlabeled[static_cast<std::size_t>(row)] += points;
    else contingency.counts(row, std::distance(predicted_ids.begin(), predicted_ids.find(predicted))) += points;
  }
  const auto filtered_points = static_cast<std::int64_t>(root.at("filtered_points").whole(0, kMaxPoints));
  if (contingency.total() != filtered_points)
    root.at("filtered_points").fail(fmt::format("{}, which the contingency's points sum to", contingency.total()));
  return contingency;
}

void check_length(double length, const std::string& name) {
  if (length > kMaxModelLength)
    throw_io_error("{}: /tubes: their cylinders are {} m long together; valid: up to {} m", name, length,
                   kMaxModelLength);
}

/// Of a ball, which has no cylinders: its joint alone.
std::vector<Vec3> centers_of_balls(const JsonPlace& tube) {
  std::vector<Vec3> centers;
  if (!tube.at("cylinders").elements().empty() || !tube.has("joints")) return centers;
  for (const JsonPlace& joint : tube.at("joints").elements())
    centers.push_back(joint.at("position").vector(kCoordinate));
  return centers;
}

/// Of a tube, or of a bridge in it: the least counts.
void add_log_odds(const JsonPlace& part, const char* key, evaluation::TubeLine& tube) {
  if (!part.has(key)) return;
  const double log_odds = part.at(key).number();
  tube.log_odds = std::min(log_odds, tube.log_odds.value_or(log_odds));
}

}  // namespace

RunCounts parse_run_counts(std::string_view text, const std::string& name) {
  const nlohmann::json json = parse_json(text, name);
  const JsonPlace root(json, name);
  check_format(root, kResultFormat);
  return {.scene = root.at("scene").text(),
          .set = root.at("set").text(),
          .tubes = root.at("tubes").integer({0, 1000000}),
          .case_number = root.at("case").integer({0, 1000000000}),
          .model_tubes = root.at("model_tubes").integer({0, kMaxPoints}),
          .made_from = {.cloud_xxh128 = optional_text(root, "cloud_xxh128"),
                        .scene_json_xxh128 = optional_text(root, "scene_json_xxh128")},
          .contingency = read_contingency(root, name)};
}

std::vector<evaluation::TubeLine> parse_model_tubes(std::string_view text, const std::string& name) {
  const nlohmann::json json = parse_json(text, name);
  std::vector<evaluation::TubeLine> model;
  double length = 0.0;
  for (const JsonPlace& tube : JsonPlace(json, name).at("tubes").elements()) {
    evaluation::TubeLine line;
    if (tube.has("radius")) line.radius = tube.at("radius").number(kRadius);
    for (const char* key : {"log_odds", "whole_log_odds"}) add_log_odds(tube, key, line);
    for (const JsonPlace& cylinder : tube.at("cylinders").elements()) {
      line.centerline.push_back({cylinder.at("start").vector(kCoordinate), cylinder.at("end").vector(kCoordinate),
                                 cylinder.has("bridged") && cylinder.at("bridged").flag()});
      add_log_odds(cylinder, "log_odds", line);
      length += (line.centerline.back().end - line.centerline.back().start).norm();
    }
    for (const Vec3& center : centers_of_balls(tube)) line.centerline.push_back({center, center});
    model.push_back(std::move(line));
  }
  check_length(length, name);
  return model;
}

std::vector<modeling::TubeModel> parse_labeling_tubes(std::string_view text, const std::string& name) {
  const nlohmann::json json = parse_json(text, name);
  std::vector<modeling::TubeModel> tubes;
  double length = 0.0;
  for (const JsonPlace& place : JsonPlace(json, name).at("tubes").elements()) {
    modeling::TubeModel tube{.paths = {}, .radius = place.at("radius").number(kLabelingRadius)};
    std::uint64_t last_path = 0;
    for (const JsonPlace& cylinder : place.at("cylinders").elements()) {
      const std::uint64_t path = cylinder.at("path").whole(0, kMaxPoints);
      if (tube.paths.empty() || path != last_path)
        tube.paths.push_back({.nodes = {cylinder.at("start").vector(kCoordinate)}, .bridged = {}});
      last_path = path;
      tube.paths.back().nodes.push_back(cylinder.at("end").vector(kCoordinate));
      tube.paths.back().bridged.push_back(cylinder.at("bridged").flag());
    }
    for (const Vec3& center : centers_of_balls(place)) tube.paths.push_back({.nodes = {center}, .bridged = {}});
    length += tube.length();
    tubes.push_back(std::move(tube));
  }
  check_length(length, name);
  return tubes;
}

double parse_modeling_seconds(std::string_view text, const std::string& name) {
  const nlohmann::json json = parse_json(text, name);
  return JsonPlace(json, name).at("total").number(kSeconds);
}

std::map<std::string, std::string> parse_failures(std::string_view text, const std::string& name) {
  std::map<std::string, std::string> reasons;
  for (std::size_t start = 0, line = 1; start < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    if (end > start) {
      const std::string place = fmt::format("{}:{}", name, line);
      const nlohmann::json json = parse_json(text.substr(start, end - start), place);
      const JsonPlace root(json, place);
      reasons[run_folder(root.at("scene").text(), root.at("method").text(), root.at("ratio").number())] =
          root.at("error").text();
    }
    start = end + 1;
  }
  return reasons;
}

std::string run_folder(const std::string& scene, const std::string& method, double ratio) {
  return fmt::format("{}/{}_{}", scene, method, ratio);
}

}  // namespace tubebin::results
