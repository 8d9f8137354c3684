#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "modeling/fitting/cylinder_ransac.hpp"
#include "modeling/fitting/surface_fitting.hpp"
#include "modeling/input/point_sample.hpp"
#include "tubebin/modeling/region_growing.hpp"

namespace tubebin::modeling {
namespace {

/// A cylinder without ends, and the points that RANSAC found on it.
struct CylinderAxis {
  Vec3 point, direction;
  Segment inliers;

  double low = -std::numeric_limits<double>::infinity(), high = -low;  ///< along the axis, metres

  double distance(const Vec3& p) const { return (p - point).cross(direction).norm(); }
  /// From the surface, and from the stretch that the cylinder covers where the point is beyond its ends.
  double distance_off(const Vec3& p, double radius) const {
    const double along = (p - point).dot(direction);
    return std::abs(distance(p) - radius) + std::max({low - along, along - high, 0.0});
  }
};

/// The cylinder on which RANSAC finds most of a sample of the points.
std::optional<CylinderAxis> search_axis(const FilteredCloud& cloud, const Segment& remaining, double radius,
                                        const RegionGrowingOptions& options) {
  // RANSAC's time goes into counting inliers, and some hundred points tell a good cylinder from a bad one.
  constexpr std::size_t kSample = 400;
  std::vector<cloud::Point> points, normals;
  for (std::size_t k = 0; k < remaining.size(); k += remaining.size() / kSample + 1) {
    points.push_back(cloud.points[remaining[k]]);
    normals.push_back(cloud.normals[remaining[k]]);
  }
  const auto axis = search_cylinder(
      points, normals,
      {.radius = radius, .inlier_distance = options.inlier_distance * radius, .iterations = options.ransac_iterations});
  if (!axis) return std::nullopt;
  return CylinderAxis{.point = axis->point, .direction = axis->direction, .inliers = {}};
}

/// Sorts the points into the axis's inliers and the rest.
Segment take_inliers(const FilteredCloud& cloud, const Segment& points, CylinderAxis& axis, double radius,
                     const RegionGrowingOptions& options) {
  const double band = options.inlier_distance * radius, leaning = std::sin(radians(options.smoothness_deg));
  Segment left, inliers;
  for (const std::uint32_t i : points) {
    // Where the tube bends away, its surface crosses the cylinder's.
    const bool is_inlier = std::abs(axis.distance(cloud.points[i].cast<double>()) - radius) < band &&
                           std::abs(cloud.normals[i].cast<double>().dot(axis.direction)) < leaning;
    (is_inlier ? inliers : left).push_back(i);
  }
  axis.inliers = std::move(inliers);
  return left;
}

/// Least squares with the known radius on the inliers.
void refine(const FilteredCloud& cloud, CylinderAxis& axis, double radius) {
  double low = 0.0, high = 0.0;
  std::vector<SurfacePoint> surface;
  for (const std::uint32_t i : some_of<std::uint32_t>(axis.inliers, 500)) {
    const Vec3 p = cloud.points[i].cast<double>();
    surface.push_back({p, cloud.normals[i].cast<double>()});
    const double along = (p - axis.point).dot(axis.direction);
    low = surface.size() == 1 ? along : std::min(low, along);
    high = surface.size() == 1 ? along : std::max(high, along);
  }
  if (high - low < radius / 2.0) return;
  std::vector<Vec3> nodes = {axis.point + low * axis.direction, axis.point + high * axis.direction};
  fit_surface(nodes, surface, radius);
  axis.point = nodes[0];
  axis.direction = (nodes[1] - nodes[0]).normalized();
}

/// The most populated cylinder that is found among the points, its inliers removed from them.
std::optional<CylinderAxis> take_cylinder(const FilteredCloud& cloud, Segment& remaining, double radius,
                                          const RegionGrowingOptions& options) {
  auto axis = search_axis(cloud, remaining, radius, options);
  if (!axis) return std::nullopt;
  take_inliers(cloud, remaining, *axis, radius, options);
  refine(cloud, *axis, radius);
  remaining = take_inliers(cloud, remaining, *axis, radius, options);
  if (static_cast<int>(axis->inliers.size()) < options.region_size_min) return std::nullopt;
  return axis;
}

/// Gives every point to the cylinder whose surface it is nearest to.
void reassign_inliers(const FilteredCloud& cloud, std::vector<CylinderAxis>& axes, double radius) {
  Segment all;
  for (CylinderAxis& axis : axes) {
    all.insert(all.end(), axis.inliers.begin(), axis.inliers.end());
    axis.inliers.clear();
  }
  for (const std::uint32_t i : all) {
    const Vec3 p = cloud.points[i].cast<double>();
    const auto off = [&](const CylinderAxis& axis) { return axis.distance_off(p, radius); };
    std::min_element(axes.begin(), axes.end(), [&](const CylinderAxis& a, const CylinderAxis& b) {
      return off(a) < off(b);
    })->inliers.push_back(i);
  }
}

void find_extents(const FilteredCloud& cloud, std::vector<CylinderAxis>& axes) {
  for (CylinderAxis& axis : axes) {
    axis.low = std::numeric_limits<double>::infinity();
    axis.high = -axis.low;
    for (const std::uint32_t i : axis.inliers) {
      const double along = (cloud.points[i].cast<double>() - axis.point).dot(axis.direction);
      axis.low = std::min(axis.low, along);
      axis.high = std::max(axis.high, along);
    }
  }
}

/// The first cylinders of a segment cut across its bends, and the later ones make do with the strips that were left:
/// inliers and axes are found in turns, as k-means does, and cylinders that others can do without go.
void refine_jointly(const FilteredCloud& cloud, std::vector<CylinderAxis>& axes, double radius,
                    const RegionGrowingOptions& options) {
  constexpr int kRounds = 4;
  const double band = options.inlier_distance * radius;
  for (int round = 0; round < kRounds && !axes.empty(); ++round) {
    find_extents(cloud, axes);
    reassign_inliers(cloud, axes, radius);
    for (CylinderAxis& axis : axes) refine(cloud, axis, radius);
    find_extents(cloud, axes);
    const auto fewest = std::min_element(axes.begin(), axes.end(), [](const CylinderAxis& a, const CylinderAxis& b) {
      return a.inliers.size() < b.inliers.size();
    });
    const auto is_spared = [&](std::uint32_t i) {
      const Vec3 p = cloud.points[i].cast<double>();
      return std::any_of(axes.begin(), axes.end(), [&](const CylinderAxis& axis) {
        return &axis != &*fewest && axis.distance_off(p, radius) < band;
      });
    };
    const auto spared = std::count_if(fewest->inliers.begin(), fewest->inliers.end(), is_spared);
    if (axes.size() < 2 || 10 * static_cast<std::size_t>(spared) < 7 * fewest->inliers.size()) continue;
    const Segment freed = std::move(fewest->inliers);
    axes.erase(fewest);
    axes.front().inliers.insert(axes.front().inliers.end(), freed.begin(), freed.end());
    round = -1;  // with one cylinder less, all over again
  }
  if (axes.empty()) return;
  find_extents(cloud, axes);
  reassign_inliers(cloud, axes, radius);
}

/// From the first to the last of its points along the axis, a hundredth of them cut off at either end as strays.
TubePiece make_piece(const FilteredCloud& cloud, const CylinderAxis& axis, double radius) {
  std::vector<double> along;
  for (const std::uint32_t i : axis.inliers)
    along.push_back((cloud.points[i].cast<double>() - axis.point).dot(axis.direction));
  std::sort(along.begin(), along.end());
  const double low = along[along.size() / 100], high = along[along.size() - 1 - along.size() / 100];
  return {.nodes = {axis.point + low * axis.direction, axis.point + high * axis.direction},
          .radius = radius,
          .points = axis.inliers};
}

}  // namespace

std::vector<TubePiece> fit_cylinders(const FilteredCloud& cloud, const Segment& segment, double radius,
                                     const RegionGrowingOptions& options) {
  std::vector<CylinderAxis> axes;
  Segment remaining = segment;
  while (static_cast<int>(remaining.size()) >= options.region_size_min) {
    auto axis = take_cylinder(cloud, remaining, radius, options);
    if (!axis) break;
    axes.push_back(std::move(*axis));
  }
  refine_jointly(cloud, axes, radius, options);
  std::vector<TubePiece> pieces;
  for (const CylinderAxis& axis : axes) {
    if (static_cast<int>(axis.inliers.size()) < options.region_size_min) continue;
    TubePiece piece = make_piece(cloud, axis, radius);
    if (piece.length() > radius / 2.0) pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace tubebin::modeling
