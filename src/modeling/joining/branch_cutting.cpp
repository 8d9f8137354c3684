#include "modeling/joining/branch_cutting.hpp"

#include <algorithm>

namespace tubebin::modeling {
namespace {

/// Cuts the path's last end back to where it runs through another one, clear of that one's ends, within its last two radii:
/// no tube does, so it is a branch that was followed beyond its start.
void cut_end_beyond(const std::vector<Vec3>& other, double radius, TubePath& path) {
  double left = 2.0 * radius;
  if (distance_to_polyline(path.nodes.back(), other) > left + radius / 2.0) return;
  for (std::size_t k = path.nodes.size() - 1; k > 0 && left > 0.0 && !path.bridged[k - 1]; --k) {
    const Vec3 back = path.nodes[k - 1] - path.nodes[k];
    const double length = std::min(back.norm(), left);
    for (double at = 0.0; at < length; at += radius / 8.0) {
      const Vec3 here = path.nodes[k] + at * back.normalized(), place = nearest_on_polyline(here, other);
      if ((place - here).norm() > radius / 2.0 || (place - other.front()).norm() <= radius ||
          (place - other.back()).norm() <= radius)
        continue;
      path.nodes.resize(k + 1);
      path.bridged.resize(k);
      path.nodes.back() = here;
      return;
    }
    left -= length;
  }
}

}  // namespace

void cut_ends_beyond_others(std::vector<TubePath>& paths, double radius) {
  for (std::size_t k = 0; k < paths.size(); ++k)
    for (int end = 0; end < 2; ++end) {
      for (std::size_t other = 0; other < paths.size(); ++other)
        if (other != k) cut_end_beyond(paths[other].nodes, radius, paths[k]);
      turn_about(paths[k]);
    }
}

}  // namespace tubebin::modeling
