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

/// Negative inside; exact outside the union and on its surface.
inline double tube_distance(const Vec3& p, const PlacedTube& placed) {
  const Tube& tube = placed.tube;
  double nearest = std::numeric_limits<double>::infinity();
  std::vector<int> meetings(tube.nodes.size(), 0);
  for (const Cylinder& cylinder : tube.cylinders) {
    ++meetings[static_cast<std::size_t>(cylinder.node_a)];
    ++meetings[static_cast<std::size_t>(cylinder.node_b)];
    nearest = std::min(nearest, cylinder_distance(p, placed.node_in_world(cylinder.node_a),
                                                  placed.node_in_world(cylinder.node_b), tube.radius));
  }
  for (std::size_t i = 0; i < meetings.size(); ++i)
    if (meetings[i] != 1)
      nearest = std::min(nearest, (p - placed.node_in_world(static_cast<int>(i))).norm() - tube.radius);
  return nearest;
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
