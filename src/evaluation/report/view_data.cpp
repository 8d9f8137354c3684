#include "evaluation/report/view_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "evaluation/report/viewed_points.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::evaluation {
namespace {

constexpr std::size_t kMostColors = 1024;
constexpr std::size_t kMostKinds = 65536;
constexpr int kHeightBands = 64;
// Of the page's style: what needs no attention, a segment that is no tube's, points without a label.
constexpr const char* kStyleOfBackground = "--quiet";
constexpr const char* kStyleOfNoTube = "--soft";
constexpr const char* kStyleOfNoLabel = "--ink";
constexpr const char* kStyleOfWrong = "#d55e00";  // Okabe & Ito's vermilion, as in the pictures

using Kind = std::pair<SegmentId, SegmentId>;  // true and found tube
using Colors = std::map<SegmentId, std::string>;

/// Which tubes there are and which found one is which true one.
struct Match {
  bool has_truth = false;
  bool has_found = false;
  Colors true_colors;
  Colors found_colors;                            ///< that of the true tube that it matches
  std::map<SegmentId, SegmentId> truth_of_found;  ///< 0: the bin
  std::map<SegmentId, TubeScore> scores;          ///< by true tube

  bool is_correct(const Kind& kind) const {
    if (kind.second == kNullId) return kind.first == 0;
    const auto match = truth_of_found.find(kind.second);
    return match != truth_of_found.end() && match->second == kind.first;
  }
};

Colors own_colors(const std::vector<SegmentId>& labels, std::size_t tubes) {
  std::set<SegmentId> ids(labels.begin(), labels.end());
  for (std::size_t k = 1; k <= tubes; ++k) ids.insert(static_cast<SegmentId>(k));
  ids.erase(0);
  Colors colors;
  if (ids.empty()) return colors;
  const std::size_t count = std::min<std::size_t>(*ids.rbegin(), kMostColors);
  const std::vector<cloud::Color> palette = cloud::label_colors(count);
  for (const SegmentId id : ids) colors[id] = fmt::format("#{:06x}", palette[1 + (id - 1) % count]);
  return colors;
}

Match match_tubes(const LabelledPoints& points) {
  Match match;
  match.has_truth = !points.truth.empty();
  match.has_found = !points.predicted.empty();
  match.true_colors = own_colors(points.truth, points.true_tubes.size());
  match.found_colors = own_colors(points.predicted, points.found_tubes.size());
  if (!match.has_truth || !match.has_found) return match;
  for (auto& [id, color] : match.found_colors) color = kStyleOfNoTube;
  const Contingency contingency = count_pairs(points.truth, points.predicted, 0);
  const Matching matching = match_segments(contingency);
  for (std::size_t row = 0; row < matching.column_of_row.size(); ++row) {
    if (matching.column_of_row[row] == kUnmatched) continue;
    const SegmentId truth = contingency.truth_ids[row];
    const SegmentId found = contingency.predicted_ids[static_cast<std::size_t>(matching.column_of_row[row])];
    match.truth_of_found[found] = truth;
    match.found_colors[found] = truth == 0 ? kStyleOfBackground : match.true_colors[truth];
  }
  for (const TubeScore& score : score_tubes(contingency, matching).tubes) match.scores[score.truth_id] = score;
  return match;
}

// ---- tubes ----

OrderedJson place(const Vec3& p) {
  const auto tenth_mm = [](double metres) { return std::round(metres * 1e4) / 1e4; };
  return {tenth_mm(p.x()), tenth_mm(p.y()), tenth_mm(p.z())};
}

std::string confidence(double log_odds) {
  const double probability = 1.0 / (1.0 + std::exp(-log_odds));
  return probability > 0.9999 ? "above 0.9999" : fmt::format("{:.4f}", probability);
}

void add_line(const TubeLine& line, OrderedJson& tube) {
  double length = 0.0, bridged = 0.0;
  for (const CenterlineSegment& segment : line.centerline) {
    length += (segment.end - segment.start).norm();
    bridged += segment.bridged ? (segment.end - segment.start).norm() : 0.0;
    tube["line"].push_back({place(segment.start), place(segment.end), segment.bridged});
  }
  tube["radius"] = line.radius;
  if (line.radius > 0.0) tube["facts"].push_back({"radius", fmt::format("{:.2f} mm", line.radius * 1e3)});
  tube["facts"].push_back({"length", fmt::format("{:.3f} m", length)});
  if (bridged > 0.0) tube["facts"].push_back({"bridged", fmt::format("{:.3f} m of it", bridged)});
  if (line.log_odds) tube["facts"].push_back({"confidence", confidence(*line.log_odds)});
}

OrderedJson tubes_of(int layer, const Colors& colors, const std::vector<TubeLine>& lines,
                     const std::vector<SegmentId>& labels) {
  std::map<SegmentId, std::size_t> counts;
  for (const SegmentId label : labels) ++counts[label];
  OrderedJson tubes = OrderedJson::array();
  for (const auto& [id, color] : colors) {
    OrderedJson tube = {{"name", fmt::format("tube {}", id)},
                        {"layer", layer},
                        {"color", color},
                        {"radius", 0.0},
                        {"facts", OrderedJson::array()},
                        {"line", OrderedJson::array()}};
    if (id <= lines.size()) add_line(lines[id - 1], tube);
    tube["facts"].push_back({"points", fmt::format("{}", counts[id])});
    tubes.push_back(std::move(tube));
  }
  return tubes;
}

std::string tube_name(SegmentId id) { return id == 0 ? "the bin" : fmt::format("tube {}", id); }

void add_scores(const Match& match, OrderedJson& true_tubes, OrderedJson& found_tubes) {
  std::size_t at = 0;
  for (const auto& [id, color] : match.true_colors) {
    OrderedJson& facts = true_tubes[at++]["facts"];
    const auto score = match.scores.find(id);
    if (score == match.scores.end()) continue;
    const auto& found = score->second.predicted_id;
    facts.push_back({"found as", found ? tube_name(*found) : "nothing"});
    facts.push_back({"recall", fmt::format("{:.4f}", score->second.recall())});
  }
  at = 0;
  for (const auto& [id, color] : match.found_colors) {
    OrderedJson& facts = found_tubes[at++]["facts"];
    const auto truth = match.truth_of_found.find(id);
    facts.push_back({"is", truth == match.truth_of_found.end() ? "none of the tubes" : tube_name(truth->second)});
    if (truth == match.truth_of_found.end() || truth->second == 0) continue;
    const TubeScore& score = match.scores.at(truth->second);
    facts.push_back({"recall", fmt::format("{:.4f}", score.recall())});
    facts.push_back({"precision", fmt::format("{:.4f}", score.precision())});
  }
}

// ---- layers ----

int place_of(const Colors& tubes, SegmentId id) {
  const auto at = tubes.find(id);
  return at == tubes.end() ? -1 : static_cast<int>(std::distance(tubes.begin(), at));
}

template <typename ColorOf, typename TubeOf>
OrderedJson layer(const char* name, const std::vector<Kind>& kinds, const ColorOf& color_of, const TubeOf& tube_of) {
  OrderedJson colors = OrderedJson::array(), tubes = OrderedJson::array();
  for (const Kind& kind : kinds) colors.push_back(color_of(kind)), tubes.push_back(tube_of(kind));
  return {{"name", name}, {"colors", colors}, {"tubes", tubes}};
}

OrderedJson layers_of(const Match& match, const std::vector<Kind>& kinds) {
  const auto true_tube = [&](const Kind& kind) { return place_of(match.true_colors, kind.first); };
  const auto found_tube = [&](const Kind& kind) {
    const int at = place_of(match.found_colors, kind.second);
    return at < 0 ? -1 : static_cast<int>(match.true_colors.size()) + at;
  };
  OrderedJson layers = OrderedJson::array();
  if (match.has_truth)
    layers.push_back(layer(
        "truth", kinds,
        [&](const Kind& kind) { return kind.first == 0 ? kStyleOfBackground : match.true_colors.at(kind.first); },
        true_tube));
  if (match.has_found)
    layers.push_back(layer(
        "found", kinds,
        [&](const Kind& kind) {
          return kind.second != kNullId ? match.found_colors.at(kind.second)
                 : kind.first == 0      ? kStyleOfBackground
                                        : kStyleOfNoLabel;
        },
        found_tube));
  if (match.has_truth && match.has_found)
    layers.push_back(layer(
        "errors", kinds,
        [&](const Kind& kind) {
          return match.is_correct(kind) ? kStyleOfBackground : kind.second == kNullId ? kStyleOfNoLabel : kStyleOfWrong;
        },
        true_tube));
  if (layers.empty())  // by height: from blue below to yellow above
    layers.push_back(layer(
        "height", kinds,
        [](const Kind& kind) {
          const double part = static_cast<double>(kind.first) / (kHeightBands - 1);
          return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(40 + 200 * part),
                             static_cast<int>(80 + 120 * part), static_cast<int>(170 - 110 * part));
        },
        [](const Kind&) { return -1; }));
  return layers;
}

// ---- points ----

/// The axis that comes nearest to pointing up: towards the scanner, where that stands outside of the box.
Vec3 up_axis(const Eigen::AlignedBox3d& box, const Vec3& scanner) {
  if (box.contains(scanner)) return Vec3::UnitZ();
  const Vec3 sight = scanner - box.center();
  int axis = 0;
  sight.cwiseAbs().maxCoeff(&axis);
  return Vec3::Unit(axis) * (sight[axis] < 0.0 ? -1.0 : 1.0);
}

Kind kind_of(const LabelledPoints& points, std::size_t i, const ViewedPoints& viewed, const Vec3& up) {
  if (!points.truth.empty() || !points.predicted.empty())
    return {points.truth.empty() ? 0 : points.truth[i], points.predicted.empty() ? kNullId : points.predicted[i]};
  const double height = (points.points[i].cast<double>() - viewed.box.center()).dot(up);
  const double half = 0.5 * std::abs(viewed.box.sizes().dot(up));
  const double part = half > 0.0 ? (height + half) / (2.0 * half) : 0.5;
  return {static_cast<SegmentId>(std::lround(part * (kHeightBands - 1))), kNullId};
}

}  // namespace

OrderedJson view_data(const LabelledPoints& points) {
  const ViewedPoints viewed = choose_points(points);
  const Vec3 up = up_axis(viewed.box, points.scanner.position);
  std::map<Kind, std::uint16_t> number_of_kind;
  for (const std::size_t i : viewed.chosen) number_of_kind[kind_of(points, i, viewed, up)];
  if (number_of_kind.size() > kMostKinds)
    throw_io_error("there are {} pairs of true and found tubes to show; valid: up to {}", number_of_kind.size(),
                   kMostKinds);
  std::vector<Kind> kinds;
  for (auto& [kind, number] : number_of_kind) {
    number = static_cast<std::uint16_t>(kinds.size());
    kinds.push_back(kind);
  }
  std::vector<std::uint16_t> numbers;
  for (const std::size_t i : viewed.chosen) numbers.push_back(number_of_kind.at(kind_of(points, i, viewed, up)));

  const Match match = match_tubes(points);
  OrderedJson tubes = tubes_of(0, match.true_colors, points.true_tubes, points.truth);
  OrderedJson found_tubes = tubes_of(match.has_truth ? 1 : 0, match.found_colors, points.found_tubes, points.predicted);
  if (match.has_truth && match.has_found) add_scores(match, tubes, found_tubes);
  for (OrderedJson& tube : found_tubes) tubes.push_back(std::move(tube));
  return {{"note", viewed.note},
          {"lo", to_json(Vec3(viewed.box.min()))},
          {"size", to_json(Vec3(viewed.box.sizes()))},
          {"up", to_json(up)},
          {"count", viewed.chosen.size()},
          {"points", encode_points(points, viewed, numbers)},
          {"layers", layers_of(match, kinds)},
          {"start", match.has_truth && match.has_found ? 1 : 0},
          {"tubes", tubes}};
}

}  // namespace tubebin::evaluation
