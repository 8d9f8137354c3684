#include "modeling/fitting/loose_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tubebin::modeling {

LoosePoints::LoosePoints(const FilteredCloud& cloud, const std::vector<Segment>& segments, double reach)
    : reach_(reach) {
  std::vector<bool> is_held(cloud.points.size(), false);
  for (const Segment& segment : segments)
    for (const std::uint32_t i : segment) is_held[i] = true;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (!is_held[i]) points_.push_back({cloud.points[i].cast<double>(), cloud.normals[i].cast<double>()});
  std::ranges::stable_sort(
      points_, {}, [&](const SurfacePoint& point) { return std::pair(strip_of(point.position), point.position.x()); });
}

double LoosePoints::strip_of(const Vec3& position) const { return std::floor(position.y() / reach_); }

std::span<const SurfacePoint> LoosePoints::part_about(double strip, const Vec3& place) const {
  const auto key = [&](const SurfacePoint& point) { return std::pair(strip_of(point.position), point.position.x()); };
  const auto first = std::ranges::lower_bound(points_, std::pair(strip, place.x() - reach_), {}, key);
  const auto last = std::ranges::upper_bound(first, points_.end(), std::pair(strip, place.x() + reach_), {}, key);
  return {first, last};
}

}  // namespace tubebin::modeling
