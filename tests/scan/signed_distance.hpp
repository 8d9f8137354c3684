// An independent view of a scene: exact signed distance functions in the world frame and sphere tracing
// (Hart 1996, "Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces"). No
// formula is shared with the scanner: no quadratic is solved here, and no ray meets a solid in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::testing {

inline double cylinder_distance(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
  const Vec3 axis = (b - a).normalized();
  const Vec3 from_middle = p - (a + b) / 2.0;
  const double along = from_middle.dot(axis);
  const double beyond_side = (from_middle - along * axis).norm() - radius;
  const double beyond_cap = std::abs(along) - (b - a).norm() / 2.0;
  const double inside = std::min(std::max(beyond_side, beyond_cap), 0.0);
  return inside + std::hypot(std::max(beyond_side, 0.0), std::max(beyond_cap, 0.0));
}

inline double box_distance(const Vec3& p, const Vec3& low, const Vec3& high) {
  const Vec3 beyond = (p - (low + high) / 2.0).cwiseAbs() - (high - low) / 2.0;
  return std::min(beyond.maxCoeff(), 0.0) + beyond.cwiseMax(0.0).norm();
}

/// Of the union of a tube's cylinders and joint spheres, thinner by `wall`; free ends are longer by `excess`.
/// Negative inside; exact outside the union and on its surface.
inline double union_distance(const Vec3& p, const PlacedTube& placed, double wall, double excess) {
  const Tube& tube = placed.tube;
  const std::vector<double> radii = tube.node_radii();
  const std::vector<int> degrees = tube.node_degrees();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Cylinder& cylinder : tube.cylinders) {
    const Vec3 a = placed.node_in_world(cylinder.node_a), b = placed.node_in_world(cylinder.node_b);
    const Vec3 beyond = excess * (b - a).normalized();
    const auto is_free = [&](int node) { return degrees[static_cast<std::size_t>(node)] == 1; };
    nearest = std::min(
        nearest, cylinder_distance(p, is_free(cylinder.node_a) ? Vec3(a - beyond) : a,
                                   is_free(cylinder.node_b) ? Vec3(b + beyond) : b, tube.radius_of(cylinder) - wall));
  }
  for (std::size_t i = 0; i < degrees.size(); ++i)
    if (degrees[i] != 1)
      nearest = std::min(nearest, (p - placed.node_in_world(static_cast<int>(i))).norm() - radii[i] + wall);
  return nearest;
}

/// As union_distance, of the tube with its bore taken out: a lower bound of the distance. A bore that ends beyond its
/// tube is the same bore, and has no surface in the opening.
inline double tube_distance(const Vec3& p, const PlacedTube& placed) {
  constexpr double kBeyondTheEnd = 0.001;
  const Tube& tube = placed.tube;
  const double outside = union_distance(p, placed, 0.0, 0.0);
  if (tube.wall_thickness == 0.0) return outside;
  return std::max(outside, -union_distance(p, placed, tube.wall_thickness, kBeyondTheEnd));
}

/// The bin is what is left of its outer block when the space inside and above the floor is taken out; the
/// distance to it is exact outside and on the surface.
inline double bin_distance(const Vec3& p, const Bin& bin) {
  const double x = bin.length / 2, y = bin.width / 2, w = bin.wall_thickness, h = bin.height;
  const double walls = std::min(
      {box_distance(p, {-x - w, -y - w, -w}, {-x, y + w, h}), box_distance(p, {x, -y - w, -w}, {x + w, y + w, h}),
       box_distance(p, {-x - w, -y - w, -w}, {x + w, -y, h}), box_distance(p, {-x - w, y, -w}, {x + w, y + w, h})});
  return std::min(walls, box_distance(p, {-x - w, -y - w, -w}, {x + w, y + w, 0.0}));
}

inline double distance_to(const Vec3& p, const Scene& scene, Label label) {
  return label == 0 ? bin_distance(p, scene.bin) : tube_distance(p, scene.tubes[label - 1]);
}

struct TracedHit {
  bool found = false;
  Label label = 0;
  Vec3 point = Vec3::Zero();
};

/// The largest distance, in metres, of a finite point from the surface that its label names.
inline double worst_surface_distance(const Scene& scene, const Cloud& cloud) {
  double worst = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (is_finite(cloud.points[i]))
      worst = std::max(worst, std::abs(distance_to(cloud.points[i].cast<double>(), scene, cloud.labels[i])));
  return worst;
}

/// Walks from depth range_min to range_max + 1e-9, never farther than to the nearest surface. `direction`, in
/// world axes, has depth one. A ray that passes a surface within 1e-9 m counts as a hit.
inline TracedHit sphere_trace(const Scene& scene, const Vec3& direction) {
  constexpr double kContact = 1e-9;
  const double speed = direction.norm();
  double depth = scene.scanner.range_min;
  while (depth <= scene.scanner.range_max + 1e-9) {
    const Vec3 p = scene.scanner.position + depth * direction;
    double nearest = std::numeric_limits<double>::infinity();
    Label label = 0;
    for (Label k = 0; k <= scene.tubes.size(); ++k) {
      const double distance = std::abs(distance_to(p, scene, k));
      if (distance < nearest) {
        nearest = distance;
        label = k;
      }
    }
    if (nearest < kContact) return {true, label, p};
    depth += nearest / speed;
  }
  return {};
}

}  // namespace tubebin::testing
