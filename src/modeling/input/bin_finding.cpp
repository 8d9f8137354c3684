#include "modeling/input/bin_finding.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tubebin::modeling {
namespace {

constexpr std::size_t kBinSample = 200000;
constexpr double kLean = 0.26;      ///< the sine of 15 degrees
constexpr double kAlong = 0.985;    ///< the cosine of 10 degrees
constexpr double kOverhang = 0.02;  ///< metres that a face may reach beyond where it should end
constexpr double kThickestWall = 0.03;

/// Of a wall, level and outward from the middle of the floor.
Vec3 outward_of(const FlatRegion& wall, const Vec3& up) {
  return -(wall.plane.normal - wall.plane.normal.dot(up) * up).normalized();
}

/// From a place on the floor, level along a direction, to the wall's plane.
double distance_to(const FlatRegion& wall, const Vec3& place, const Vec3& outward) {
  return -wall.plane.height(place) / wall.plane.normal.dot(outward);
}

/// A floor with walls about it; those at +x, -x, +y, -y.
struct Candidate {
  const FlatRegion* floor;
  std::array<const FlatRegion*, 4> walls;
  BinFound bin;

  bool is_above_floor(const Vec3& p) const {
    const Vec3 own = bin.world_from_bin.inverse() * p;
    return std::abs(own.x()) < bin.length / 2.0 && std::abs(own.y()) < bin.width / 2.0 && own.z() > 0.0;
  }
};

/// Regions that stand on the floor's plane and look toward its middle.
std::vector<const FlatRegion*> walls_about(const FlatRegion& floor, const std::vector<FlatRegion>& regions) {
  std::vector<const FlatRegion*> walls;
  for (const FlatRegion& region : regions)
    if (std::abs(region.plane.normal.dot(floor.plane.normal)) < kLean && floor.plane.height(region.center) > 0.0 &&
        region.plane.height(floor.center) > 0.0)
      walls.push_back(&region);
  return walls;
}

/// The nearest of those that look along a direction.
const FlatRegion* nearest_wall(const std::vector<const FlatRegion*>& walls, const FlatRegion& floor,
                               const Vec3& outward) {
  const FlatRegion* nearest = nullptr;
  for (const FlatRegion* wall : walls)
    if (outward_of(*wall, floor.plane.normal).dot(outward) > kAlong &&
        (!nearest || distance_to(*wall, floor.center, outward) < distance_to(*nearest, floor.center, outward)))
      nearest = wall;
  return nearest;
}

/// Every wall stands beside the floor, and the floor ends at the walls.
bool fits(const Candidate& candidate) {
  const BinFound& bin = candidate.bin;
  const Pose bin_from_world = bin.world_from_bin.inverse();
  // A rectangle about what tubes leave of the floor may be askew; a table's is far larger.
  if (candidate.floor->area > 1.5 * bin.length * bin.width) return false;
  return std::ranges::all_of(candidate.walls, [&](const FlatRegion* wall) {
    const Vec3 middle = bin_from_world * wall->center;
    const double lean = kLean * middle.z() + kOverhang;
    return std::abs(middle.x()) < bin.length / 2.0 + lean && std::abs(middle.y()) < bin.width / 2.0 + lean;
  });
}

std::optional<Candidate> bin_on(const FlatRegion& floor, const std::vector<FlatRegion>& regions) {
  const std::vector<const FlatRegion*> walls = walls_about(floor, regions);
  if (walls.size() < 4) return std::nullopt;
  const Vec3 up = floor.plane.normal;
  const Vec3 first = outward_of(*walls.front(), up), second = up.cross(first);
  Candidate candidate{.floor = &floor, .walls = {}, .bin = {}};
  std::array<Vec3, 4> outward = {first, -first, second, -second};
  for (std::size_t k = 0; k < outward.size(); ++k) {
    candidate.walls[k] = nearest_wall(walls, floor, outward[k]);
    if (candidate.walls[k] == nullptr) return std::nullopt;
    outward[k] = outward_of(*candidate.walls[k], up);
  }
  // The four walls' mean direction, of a frame with right angles.
  Vec3 x = (outward[0] - outward[1] + outward[2].cross(up) - outward[3].cross(up)).normalized();
  const auto width_along = [&](const Vec3& axis, std::size_t ahead, std::size_t behind) {
    return distance_to(*candidate.walls[ahead], floor.center, axis) +
           distance_to(*candidate.walls[behind], floor.center, -axis);
  };
  if (width_along(x, 0, 1) < width_along(up.cross(x), 2, 3)) {
    candidate.walls = {candidate.walls[2], candidate.walls[3], candidate.walls[1], candidate.walls[0]};
    x = up.cross(x);
  }
  const Vec3 y = up.cross(x);
  BinFound& bin = candidate.bin;
  bin.length = width_along(x, 0, 1);
  bin.width = width_along(y, 2, 3);
  bin.world_from_bin.linear() << x, y, up;
  bin.world_from_bin.translation() = floor.center - floor.plane.height(floor.center) * up +
                                     (distance_to(*candidate.walls[0], floor.center, x) - bin.length / 2.0) * x +
                                     (distance_to(*candidate.walls[2], floor.center, y) - bin.width / 2.0) * y;
  return fits(candidate) ? std::optional(candidate) : std::nullopt;
}

double quantile(std::vector<double>& values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// As high as what the scan shows on the walls, or on top of them: walls are seen at a flat angle, their upper sides and
/// rims are not.
double height_of(const Candidate& candidate, std::span<const cloud::Point> points) {
  const std::size_t stride = points.size() / kBinSample + 1;
  std::vector<double> on_walls, on_top;
  const auto collect = [&](const auto& add) {
    for (std::size_t i = 0; i < points.size(); i += stride) {
      if (!cloud::is_finite(points[i])) continue;
      const Vec3 p = points[i].cast<double>();
      for (const FlatRegion* wall : candidate.walls)
        if (wall->spans(p, kOverhang)) add(*wall, p, candidate.floor->plane.height(p));
    }
  };
  collect([&](const FlatRegion& wall, const Vec3& p, double height) {
    if (wall.holds(p, 0.0)) on_walls.push_back(height);
  });
  if (on_walls.empty()) return 0.0;
  const double top_of_walls = quantile(on_walls, 0.98);
  collect([&](const FlatRegion& wall, const Vec3& p, double height) {
    const double behind = -wall.plane.height(p);
    if (behind > wall.tolerance && behind < kThickestWall && std::abs(height - top_of_walls) < kOverhang)
      on_top.push_back(height);
  });
  return on_top.size() < 20 ? top_of_walls : quantile(on_top, 0.6);
}

}  // namespace

std::optional<BinFound> find_bin(const std::vector<FlatRegion>& regions, std::span<const cloud::Point> points,
                                 std::span<const std::uint32_t> inside) {
  std::optional<Candidate> best;
  std::ptrdiff_t most = -1;
  for (const FlatRegion& floor : regions) {
    const auto candidate = bin_on(floor, regions);
    if (!candidate) continue;
    const std::ptrdiff_t count = std::ranges::count_if(
        inside, [&](std::uint32_t i) { return candidate->is_above_floor(points[i].cast<double>()); });
    if (count <= most) continue;
    most = count;
    best = candidate;
  }
  if (!best) return std::nullopt;
  best->bin.height = height_of(*best, points);
  return best->bin;
}

}  // namespace tubebin::modeling
