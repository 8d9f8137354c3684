#include "modeling/seen_ends.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "modeling/input/point_sample.hpp"
#include "modeling/path_ends.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

/// Radii.
constexpr double kFarthest = 2.5, kGap = 0.25, kWide = 1.1, kAround = 1.5;
/// Of the points that an end seen straight on has; a wire, a rim or strays are fewer.
constexpr double kLeastPart = 0.25;

/// A point beyond an end: how far along the path's axis, and off it.
struct PlaceBeyond {
  double along = 0.0, off = 0.0;  ///< metres
};

/// Those not farther than `farthest` beyond the end and `wide` off its axis, metres, the nearest first.
std::vector<PlaceBeyond> places_beyond(const PathEnd& end, double farthest, double wide,
                                       const std::vector<Vec3>& points) {
  std::vector<PlaceBeyond> places;
  for (const Vec3& point : points) {
    const Vec3 offset = point - end.tip;
    const double along = offset.dot(end.outward);
    if (along <= 0.0 || along >= farthest) continue;
    if (const double off = (offset - along * end.outward).norm(); off < wide) places.push_back({along, off});
  }
  std::ranges::sort(places, {}, &PlaceBeyond::along);
  return places;
}

/// How far beyond the end points go on without a gap, metres; none where they are few or go on too far.
std::optional<double> seen_from_the_front(const PathEnd& end, double radius, double spacing,
                                          const std::vector<Vec3>& points) {
  std::vector<PlaceBeyond> places = places_beyond(end, kFarthest * radius, kWide * radius, points);
  const auto gap = std::ranges::adjacent_find(
      places, [&](const PlaceBeyond& a, const PlaceBeyond& b) { return b.along - a.along > kGap * radius; });
  if (gap != places.end()) places.erase(gap + 1, places.end());
  if (places.empty() || static_cast<double>(places.size()) < kLeastPart * points_of_flat_end(radius, spacing))
    return std::nullopt;
  // Up to a radius before an end, points have its tube's label already.
  const bool begins_there = places.front().along < (1.0 + kGap) * radius;
  const bool ends = places.back().along < (kFarthest - kGap) * radius;
  return begins_there && ends ? std::optional(places.back().along) : std::nullopt;
}

/// How far beyond the end its side shows again, metres, not farther than what the tube misses of its length; none where
/// few points or other things are there.
std::optional<double> seen_again(const PathEnd& end, double radius, double spacing, double missing,
                                 const std::vector<Vec3>& points) {
  constexpr double kOnSide = 0.15;  // radii
  const std::vector<PlaceBeyond> places = places_beyond(end, missing + radius / 2.0, kAround * radius, points);
  if (places.empty()) return std::nullopt;
  double on_side = 0.0, others = 0.0, farthest = 0.0;
  for (const PlaceBeyond& place : places) {
    const bool is_on = std::abs(place.off - radius) < kOnSide * radius;
    if (is_on) farthest = place.along;
    ++(is_on ? on_side : others);
  }
  // The flat end is at the farthest place of the side.
  others -= static_cast<double>(std::ranges::count_if(places, [&](const PlaceBeyond& place) {
    return place.off < (1.0 - kOnSide) * radius && std::abs(place.along - farthest) < kOnSide * radius;
  }));
  const bool is_side = on_side >= kLeastPart * points_of_flat_end(radius, spacing) && others < on_side / 4.0;
  return is_side ? std::optional(farthest) : std::nullopt;
}

/// By how much the tube is shorter than one of the lengths that tubes have in common, metres; 0 where it is not.
double missing_length(const TubeModel& tube, const std::vector<double>& lengths) {
  const auto longer = std::ranges::upper_bound(lengths, tube.length() + tube.radius);
  return tube.paths.size() == 1 && longer != lengths.end() ? *longer - tube.length() : 0.0;
}

/// Points without a label that are no farther from a tube's end than the tube may reach beyond it.
std::vector<Vec3> unlabeled_about_ends(const std::vector<TubeModel>& tubes, std::span<const cloud::Point> points,
                                       std::span<const cloud::Label> labels, const std::vector<double>& lengths) {
  const auto reach = [&](const TubeModel& tube) {
    const double beyond = std::max(kFarthest * tube.radius, missing_length(tube, lengths) + tube.radius / 2.0);
    return beyond + kAround * tube.radius;
  };
  return positions_at(points, about_ends(tubes, points, points_without_label(labels), reach));
}

}  // namespace

bool reach_seen_ends(std::vector<TubeModel>& tubes, std::span<const cloud::Point> points,
                     std::span<const cloud::Label> labels, double spacing, const std::vector<double>& lengths) {
  const std::vector<Vec3> unlabeled = unlabeled_about_ends(tubes, points, labels, lengths);
  bool any = false;
  for (TubeModel& tube : tubes)
    for (TubePath& path : tube.paths)
      for (int end = 0; end < 2 && path.nodes.size() > 1; ++end) {
        turn_about(path);
        const PathEnd last = last_end(path.nodes, tube.radius);
        std::optional<double> beyond = seen_from_the_front(last, tube.radius, spacing, unlabeled);
        if (const double missing = missing_length(tube, lengths); !beyond && missing > 0.0)
          beyond = seen_again(last, tube.radius, spacing, missing, unlabeled);
        if (!beyond) continue;
        path.nodes.back() += *beyond * last.outward;
        any = true;
      }
  return any;
}

}  // namespace tubebin::modeling
