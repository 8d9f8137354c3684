#include "modeling/joining/shape_joining.hpp"

#include <algorithm>
#include <numeric>

#include "modeling/joining/cover_margins.hpp"
#include "modeling/joining/sampled_curve.hpp"
#include "modeling/joining/shape_copies.hpp"

namespace tubebin::modeling {
namespace {

/// nats, against each tube that the scene is taken to have more.
constexpr double kTubeCost = 3.0;

/// nats, against a tube most of which is out of sight, but for so many metres.
double cost_alone(double length, double radius) {
  constexpr double kHiddenCost = 4.0;
  return kTubeCost + kHiddenCost * std::min(length / (4.0 * radius), 1.0);
}

/// Samples, half a radius apart, where a piece turns by more than 37 degrees within two radii, and most about there.
std::vector<std::size_t> sharp_bends(const std::vector<Vec3>& samples) {
  constexpr std::size_t kReach = 4;
  std::vector<double> cosines(samples.size(), 1.0);
  for (std::size_t k = kReach; k + kReach < samples.size(); ++k)
    cosines[k] = (samples[k] - samples[k - kReach]).normalized().dot((samples[k + kReach] - samples[k]).normalized());
  std::vector<std::size_t> bends;
  for (std::size_t k = kReach; k + kReach < samples.size(); ++k)
    if (cosines[k] < 0.8 && cosines[k] == *std::min_element(&cosines[k - kReach], &cosines[k + kReach] + 1))
      bends.push_back(k);
  return bends;
}

std::vector<Section> sections_of(const std::vector<TubePiece>& pieces) {
  std::vector<Section> sections;
  for (const TubePiece& piece : pieces) {
    const std::vector<Vec3> samples = smooth_samples(piece.nodes, piece.radius / 2.0, piece.radius);
    std::vector<std::size_t> ends = sharp_bends(samples);
    ends.push_back(samples.size() - 1);
    std::size_t first = 0;
    for (const std::size_t last : ends) {
      Section section{.samples = {&samples[first], &samples[last] + 1}};
      section.length = polyline_length(section.samples);
      section.evidence = piece.evidence * section.length / piece.length();
      sections.push_back(std::move(section));
      first = last;
    }
  }
  return sections;
}

/// A copy of the best cover, and how sure it is (cover_margins.hpp).
struct ChosenCopy {
  ShapeCopy copy;
  double whole_odds = 0.0;
  std::vector<double> bridge_odds;  ///< from each section to the next
};

/// Copies that together with single sections make up the scene.
struct CopyCover {
  std::vector<ChosenCopy> chosen;
  double cost = 0.0;
};

CopyCover cheapest_copies(const std::vector<Section>& sections, const std::vector<ShapeCopy>& copies, double radius) {
  std::vector<PathCandidate> candidates;
  for (const ShapeCopy& copy : copies) {
    PathCandidate& candidate = candidates.emplace_back();
    for (const PlacedSection& each : copy.placed) candidate.items.push_back(each.section);
    candidate.cost = kTubeCost + copy.cost;
  }
  for (std::uint32_t k = 0; k < sections.size(); ++k) {
    PathCandidate& alone = candidates.emplace_back();
    alone.items.push_back(k);
    alone.cost = cost_alone(sections[k].length, radius);
  }
  constexpr std::size_t kMostNodes = 5000;
  const PathCover cheapest = cheapest_path_cover(sections.size(), candidates, {}, kMostNodes);
  const CoverMargins margins(cheapest, candidates, {});
  CopyCover cover;
  for (const std::uint32_t c : cheapest.chosen) {
    cover.cost += candidates[c].cost;
    if (c >= copies.size()) continue;
    ChosenCopy& chosen = cover.chosen.emplace_back();
    chosen.copy = copies[c];
    chosen.whole_odds = margins.of_path(c);
    for (std::size_t k = 0; k + 1 < copies[c].placed.size(); ++k)
      chosen.bridge_odds.push_back(margins.of_pair(copies[c].placed[k].section, copies[c].placed[k + 1].section));
  }
  return cover;
}

/// The copy's sections in a row, and its own course where none shows it.
TubePath path_of(const ChosenCopy& chosen, const std::vector<Section>& sections) {
  constexpr std::size_t kRadius = 2, kDiameter = 4;  // samples
  const ShapeCopy& copy = chosen.copy;
  const std::vector<Vec3>& shape = *copy.shape;
  TubePath path;
  path.whole_odds = chosen.whole_odds;
  const auto add = [&](const Vec3& node) {
    if (!path.nodes.empty()) path.bridged.push_back(false);
    path.nodes.push_back(node);
  };
  const auto bridge_to = [&](const Vec3& node, double odds) {
    add(node);
    if (path.bridged.empty()) return;
    path.bridged.back() = true;
    path.bridge_odds.push_back(odds);
  };
  std::size_t next = 0;
  for (std::size_t n = 0; n < copy.placed.size(); ++n) {
    const PlacedSection& placed = copy.placed[n];
    const double odds = n == 0 ? chosen.whole_odds : chosen.bridge_odds[n - 1];
    for (; next + kRadius < placed.first; next += kRadius) bridge_to(copy.pose * shape[next], odds);
    std::vector<Vec3> nodes = sections[placed.section].samples;
    if (placed.is_reversed) std::ranges::reverse(nodes);
    if (path.nodes.empty() || nodes.front() != path.nodes.back()) bridge_to(nodes.front(), odds);
    for (std::size_t k = 1; k < nodes.size(); ++k) add(nodes[k]);
    path.evidence += sections[placed.section].evidence;
    next = placed.last + kRadius;
  }
  if (next + kDiameter - kRadius < shape.size())
    for (; next < shape.size(); next += kRadius) bridge_to(copy.pose * shape[next], chosen.whole_odds);
  return path;
}

}  // namespace

ShapeSearch::ShapeSearch(const std::vector<TubePiece>& pieces, std::span<const std::vector<Vec3>> shapes,
                         const OcclusionTest& occlusion, double least_explained)
    : shapes_(shapes),
      radius_(pieces.front().radius),
      cost_alone_(std::accumulate(
          pieces.begin(), pieces.end(), 0.0,
          [](double sum, const TubePiece& piece) { return sum + cost_alone(piece.length(), piece.radius); })),
      sections_(sections_of(pieces)),
      copies_(find_shape_copies(sections_, shapes, radius_, occlusion, least_explained)) {}

ShapeJoining ShapeSearch::join(std::span<const std::size_t> chosen) const {
  ShapeJoining result;
  std::vector<ShapeCopy> copies;
  for (const std::size_t k : chosen) {
    copies.insert(copies.end(), copies_[k].begin(), copies_[k].end());
    result.lengths.push_back(polyline_length(shapes_[k]));
  }
  const CopyCover cover = cheapest_copies(sections_, copies, radius_);
  result.gain = cost_alone_ - cover.cost;
  std::vector<bool> is_placed(sections_.size(), false);
  for (const ChosenCopy& each : cover.chosen) {
    for (const PlacedSection& placed : each.copy.placed) is_placed[placed.section] = true;
    result.paths.push_back(path_of(each, sections_));
  }
  double all = 0.0;
  for (std::size_t k = 0; k < sections_.size(); ++k) {
    const Section& section = sections_[k];
    all += section.length;
    const auto explains = [&](const ChosenCopy& each) { return lies_on_copy(section, each.copy, radius_); };
    if (is_placed[k] || std::ranges::any_of(cover.chosen, explains)) {
      result.explained += section.length;
    } else {
      result.rest.push_back({.nodes = section.samples, .radius = radius_, .points = {}, .evidence = section.evidence});
    }
  }
  result.explained /= all;
  return result;
}

ShapeJoining join_by_shapes(const std::vector<TubePiece>& pieces, std::span<const std::vector<Vec3>> shapes,
                            const OcclusionTest& occlusion) {
  if (pieces.empty()) return {};
  std::vector<std::size_t> all(shapes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return ShapeSearch(pieces, shapes, occlusion, 0.0).join(all);
}

}  // namespace tubebin::modeling
