#include "tubebin/modeling/greedy_joining.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tubebin::modeling {
namespace {

/// End 2 k is the first node of piece k, end 2 k + 1 its last.
struct End {
  Vec3 position, outward;
};

struct EndPair {
  double cost = 0.0;
  double gap = 0.0;  ///< metres; negative where the pieces overlap
  std::size_t a = 0, b = 0;
};

constexpr std::size_t kFree = SIZE_MAX;

std::vector<End> find_ends(const std::vector<TubePiece>& pieces) {
  std::vector<End> ends;
  for (const TubePiece& piece : pieces) {
    const auto& n = piece.nodes;
    ends.push_back({n.front(), (n.front() - n[1]).normalized()});
    ends.push_back({n.back(), (n.back() - n[n.size() - 2]).normalized()});
  }
  return ends;
}

std::vector<EndPair> pairs_by_cost(const std::vector<TubePiece>& pieces, const GreedyJoiningOptions& options) {
  const std::vector<End> ends = find_ends(pieces);
  std::vector<EndPair> pairs;
  for (std::size_t a = 0; a < ends.size(); ++a)
    for (std::size_t b = a + 1; b < ends.size(); ++b) {
      if (a / 2 == b / 2) continue;
      const Vec3 line = ends[b].position - ends[a].position;
      // Cylinders that meet at a bend touch or overlap there: between such ends there is no line, and the axes' own
      // angle counts, with the distance across them.
      const bool overlap = line.dot(ends[a].outward) < 0.0 && line.dot(ends[b].outward) > 0.0;
      const double gap = overlap ? (line - line.dot(ends[a].outward) * ends[a].outward).norm() : line.norm();
      const bool touch = overlap || gap < 2.0 * pieces[a / 2].radius;
      if (gap > (overlap ? pieces[a / 2].radius : options.gap_max) || line.norm() > options.gap_max) continue;
      const double angle_a = degrees(angle_between(ends[a].outward, touch ? Vec3(-ends[b].outward) : line));
      const double angle_b = touch ? 0.0 : degrees(angle_between(ends[b].outward, -line));
      if (angle_a > options.angle_max_deg || angle_b > options.angle_max_deg) continue;
      pairs.push_back({gap + options.angle_cost * (angle_a + angle_b), overlap ? -line.norm() : gap, a, b});
    }
  std::stable_sort(pairs.begin(), pairs.end(), [](const EndPair& x, const EndPair& y) { return x.cost < y.cost; });
  return pairs;
}

/// Follows the joins from a free end to the other.
TubeModel follow(const std::vector<TubePiece>& pieces, const std::vector<std::size_t>& partner, std::size_t end) {
  const double radius = pieces[end / 2].radius;
  TubePath path;
  while (true) {
    auto nodes = pieces[end / 2].nodes;
    if (end % 2 == 1) std::reverse(nodes.begin(), nodes.end());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (!path.nodes.empty()) path.bridged.push_back(n == 0);
      path.nodes.push_back(nodes[n]);
    }
    const std::size_t next = partner[end ^ 1U];
    if (next == kFree) return {.paths = {std::move(path)}, .radius = radius};
    end = next;
  }
}

}  // namespace

void describe(Fields& fields, GreedyJoiningOptions& options) {
  fields.number("gap_max", options.gap_max, {0.0, 100.0}, "m", "largest distance between two endpoints to join");
  fields.number("angle_max_deg", options.angle_max_deg, {0.0, 180.0}, "degrees",
                "largest angle between an axis and the line between the endpoints");
  fields.number("angle_cost", options.angle_cost, {0.0, 1.0}, "m/degree", "what a degree costs in the joins' order");
  fields.number("length_max", options.length_max, {0.0, 100.0}, "m", "longest tube that joining may make");
}

std::vector<TubeModel> join_greedily(const std::vector<TubePiece>& pieces, const GreedyJoiningOptions& options) {
  std::vector<std::size_t> partner(2 * pieces.size(), kFree), tube(pieces.size());
  std::iota(tube.begin(), tube.end(), std::size_t{0});
  std::vector<double> length;
  for (const TubePiece& piece : pieces) length.push_back(piece.length());
  for (const EndPair& pair : pairs_by_cost(pieces, options)) {
    const std::size_t tube_a = tube[pair.a / 2], tube_b = tube[pair.b / 2];
    const double joined = length[tube_a] + length[tube_b] + pair.gap;
    if (partner[pair.a] != kFree || partner[pair.b] != kFree || tube_a == tube_b || joined > options.length_max)
      continue;
    partner[pair.a] = pair.b;
    partner[pair.b] = pair.a;
    length[tube_a] = joined;
    std::replace(tube.begin(), tube.end(), tube_b, tube_a);
  }
  std::vector<TubeModel> tubes;
  std::vector<bool> is_done(pieces.size(), false);
  for (std::size_t end = 0; end < partner.size(); ++end) {
    if (partner[end] != kFree || is_done[tube[end / 2]]) continue;
    is_done[tube[end / 2]] = true;
    TubeModel found = follow(pieces, partner, end);
    // Shorter than it is wide it is no tube, mostly a flat end: its points are left to the tube that they lie on.
    if (found.length() >= 2.0 * found.radius) tubes.push_back(std::move(found));
  }
  return tubes;
}

}  // namespace tubebin::modeling
