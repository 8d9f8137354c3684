#include "modeling/seen_ends.hpp"

#include <algorithm>
#include <numbers>
#include <optional>

namespace tubebin::modeling {
namespace {

/// Radii.
constexpr double kFarthest = 2.5, kGap = 0.25, kWide = 1.1;
/// Of the points that an end seen straight on has; a wire, a rim or strays are fewer.
constexpr double kLeastPart = 0.25;

struct PathEnd {
  Vec3 tip, outward;  ///< outward: unit, over the last radius of the path
};

PathEnd last_end(const std::vector<Vec3>& nodes, double radius) {
  const Vec3& tip = nodes.back();
  std::size_t k = nodes.size() - 2;
  while (k > 0 && (nodes[k] - tip).norm() < radius) --k;
  return {tip, (tip - nodes[k]).normalized()};
}

/// How far beyond the end points go on about its axis, metres; none where they are few or go on too far.
std::optional<double> seen_beyond(const PathEnd& end, double radius, const std::vector<Vec3>& unlabeled,
                                  double spacing) {
  std::vector<double> places;
  for (const Vec3& point : unlabeled) {
    const Vec3 offset = point - end.tip;
    const double along = offset.dot(end.outward);
    if (along > 0.0 && along < kFarthest * radius && (offset - along * end.outward).norm() < kWide * radius)
      places.push_back(along);
  }
  std::ranges::sort(places);
  const auto gap = std::ranges::adjacent_find(places, [&](double a, double b) { return b - a > kGap * radius; });
  if (gap != places.end()) places.erase(gap + 1, places.end());
  const double disc = std::numbers::pi * radius * radius / (spacing * spacing);
  if (places.empty() || static_cast<double>(places.size()) < kLeastPart * disc) return std::nullopt;
  // Up to a radius before an end, points have its tube's label already.
  const bool begins_there = places.front() < (1.0 + kGap) * radius, ends = places.back() < (kFarthest - kGap) * radius;
  return begins_there && ends ? std::optional(places.back()) : std::nullopt;
}

}  // namespace

bool reach_seen_ends(std::vector<TubeModel>& tubes, std::span<const cloud::Point> points,
                     std::span<const cloud::Label> labels, double spacing) {
  std::vector<Vec3> unlabeled;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (labels[i] == 0) unlabeled.push_back(points[i].cast<double>());
  bool any = false;
  for (TubeModel& tube : tubes)
    for (TubePath& path : tube.paths)
      for (int end = 0; end < 2; ++end) {
        std::ranges::reverse(path.nodes);
        const PathEnd seen = last_end(path.nodes, tube.radius);
        const std::optional<double> beyond = seen_beyond(seen, tube.radius, unlabeled, spacing);
        if (!beyond) continue;
        path.nodes.back() += *beyond * seen.outward;
        any = true;
      }
  return any;
}

}  // namespace tubebin::modeling
