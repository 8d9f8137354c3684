// An independent view of a scene: exact signed distance functions in the world frame and sphere tracing
// (Hart 1996, "Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces"). No
// formula is shared with the scanner: no quadratic is solved here, and no ray meets a solid in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

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

/// The union of a tube's cylinders and joint spheres, in the world, thinner by `wall`; free ends are longer by `excess`.
class TubeUnion {
 public:
  TubeUnion(const scene::PlacedTube& placed, double wall, double excess) {
    const tube::Tube& tube = placed.tube;
    const std::vector<double> radii = tube.node_radii();
    const std::vector<int> degrees = tube.node_degrees();
    const auto is_free = [&](int node) { return degrees[static_cast<std::size_t>(node)] == 1; };
    for (const tube::Cylinder& cylinder : tube.cylinders) {
      const Vec3 a = placed.node_in_world(cylinder.node_a), b = placed.node_in_world(cylinder.node_b);
      const Vec3 beyond = excess * (b - a).normalized();
      rods_.push_back({is_free(cylinder.node_a) ? Vec3(a - beyond) : a, is_free(cylinder.node_b) ? Vec3(b + beyond) : b,
                       tube.radius_of(cylinder) - wall});
    }
    for (std::size_t i = 0; i < degrees.size(); ++i)
      if (degrees[i] != 1) balls_.push_back({placed.node_in_world(static_cast<int>(i)), radii[i] - wall});
  }

  /// Negative inside; exact outside the union and on its surface.
  double distance(const Vec3& p) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Rod& rod : rods_) nearest = std::min(nearest, cylinder_distance(p, rod.a, rod.b, rod.radius));
    for (const Ball& ball : balls_) nearest = std::min(nearest, (p - ball.center).norm() - ball.radius);
    return nearest;
  }

 private:
  struct Rod {
    Vec3 a, b;
    double radius;
  };
  struct Ball {
    Vec3 center;
    double radius;
  };
  std::vector<Rod> rods_;
  std::vector<Ball> balls_;
};

/// The union with its bore taken out. A bore that ends beyond its tube is the same bore, and has no surface in the
/// opening.
class TubeSolid {
 public:
  explicit TubeSolid(const scene::PlacedTube& placed) : outside_(placed, 0.0, 0.0) {
    constexpr double kBeyondTheEnd = 0.001;
    if (placed.tube.wall_thickness > 0.0) bore_.emplace(placed, placed.tube.wall_thickness, kBeyondTheEnd);
    for (const Vec3& node : placed.tube.nodes) center_ += placed.world_from_tube * node;
    center_ /= static_cast<double>(placed.tube.nodes.size());
    const double widest = std::ranges::max(placed.tube.node_radii());
    for (const Vec3& node : placed.tube.nodes)  // an end's rim is nearer than a ball about the end is
      reach_ = std::max(reach_, (placed.world_from_tube * node - center_).norm() + widest);
  }

  /// Negative inside; a lower bound of the distance to the surface.
  double distance(const Vec3& p) const {
    const double outside = outside_.distance(p);
    return bore_ ? std::max(outside, -bore_->distance(p)) : outside;
  }
  /// What distance() is at least, outside: the way to a ball around the tube.
  double least_distance(const Vec3& p) const { return (p - center_).norm() - reach_; }

 private:
  TubeUnion outside_;
  std::optional<TubeUnion> bore_;
  Vec3 center_ = Vec3::Zero();
  double reach_ = 0.0;
};

/// The bin is what is left of its outer block when the space inside and above the floor is taken out; the
/// distance to it is exact outside and on the surface. One that is no box is the union of its parts.
inline double bin_distance(const Vec3& p, const scene::Bin& bin) {
  if (!bin.is_box()) {
    double nearest = 1e9;
    for (const scene::BinPart& part : scene::bin_parts(bin))
      nearest = std::min(nearest, box_distance(part.world_from_part.inverse() * p, part.box.min(), part.box.max()));
    return nearest;
  }
  const double x = bin.length / 2, y = bin.width / 2, w = bin.wall_thickness, h = bin.height;
  const double walls = std::min(
      {box_distance(p, {-x - w, -y - w, -w}, {-x, y + w, h}), box_distance(p, {x, -y - w, -w}, {x + w, y + w, h}),
       box_distance(p, {-x - w, -y - w, -w}, {x + w, -y, h}), box_distance(p, {-x - w, y, -w}, {x + w, y + w, h})});
  return std::min(walls, box_distance(p, {-x - w, -y - w, -w}, {x + w, y + w, 0.0}));
}

/// A solid box or cylinder that stands with the middle of its lower face at a place.
inline double standing_distance(const Vec3& p, const scene::StandingBox& box) {
  const double c = std::cos(radians(box.yaw_deg)), s = std::sin(radians(box.yaw_deg));
  const Vec3 from = p - box.position, half(box.size.x() / 2, box.size.y() / 2, 0.0);
  return box_distance({c * from.x() + s * from.y(), c * from.y() - s * from.x(), from.z()}, -half,
                      half + Vec3(0.0, 0.0, box.size.z()));
}
inline double standing_distance(const Vec3& p, const scene::StandingCylinder& cylinder) {
  return cylinder_distance(p, cylinder.position, cylinder.position + Vec3(0.0, 0.0, cylinder.height), cylinder.radius);
}

inline double surroundings_distance(const Vec3& p, const scene::Surroundings& around, const scene::Bin& form) {
  double nearest = standing_distance(p, around.table);
  for (const scene::StandingBox& box : around.boxes) nearest = std::min(nearest, standing_distance(p, box));
  for (const scene::StandingCylinder& cylinder : around.cylinders)
    nearest = std::min(nearest, standing_distance(p, cylinder));
  for (const scene::StandingBin& bin : around.bins) {
    const double c = std::cos(radians(bin.yaw_deg)), s = std::sin(radians(bin.yaw_deg));
    const Vec3 from = p - bin.position;
    nearest =
        std::min(nearest, bin_distance({c * from.x() + s * from.y(), c * from.y() - s * from.x(), from.z()}, form));
  }
  return nearest;
}

struct TracedHit {
  bool found = false;
  cloud::Label label = 0;
  Vec3 point = Vec3::Zero();
};

class SphereTracer {
 public:
  explicit SphereTracer(const scene::Scene& scene)
      : bin_(scene.bin),
        surroundings_(scene.surroundings),
        scanner_(scene.scanner),
        tubes_(scene.tubes.begin(), scene.tubes.end()) {}

  double distance_to(const Vec3& p, cloud::Label label) const {
    if (label > 0) return tubes_[label - 1].distance(p);
    const double to_bin = bin_distance(p, bin_);
    return surroundings_ ? std::min(to_bin, surroundings_distance(p, *surroundings_, bin_)) : to_bin;
  }

  /// Walks from depth range_min to range_max + 1e-9, never farther than to the nearest surface. `direction`, in
  /// world axes, has depth one. A ray that passes a surface within 1e-9 m counts as a hit.
  TracedHit trace(const Vec3& direction) const {
    constexpr double kContact = 1e-9;
    const double speed = direction.norm();
    for (double depth = scanner_.range_min; depth <= scanner_.range_max + 1e-9;) {
      const Vec3 p = scanner_.position + depth * direction;
      const auto [distance, label] = nearest_surface(p);
      if (distance < kContact) return {true, label, p};
      depth += distance / speed;
    }
    return {};
  }

 private:
  struct Nearest {
    double distance;
    cloud::Label label;
  };

  Nearest nearest_surface(const Vec3& p) const {
    Nearest nearest = {std::abs(distance_to(p, 0)), 0};
    for (cloud::Label label = 1; label <= tubes_.size(); ++label) {
      if (tubes_[label - 1].least_distance(p) >= nearest.distance) continue;
      const double distance = std::abs(distance_to(p, label));
      if (distance < nearest.distance) nearest = {distance, label};
    }
    return nearest;
  }

  scene::Bin bin_;
  std::optional<scene::Surroundings> surroundings_;
  scene::Scanner scanner_;
  std::vector<TubeSolid> tubes_;
};

/// The largest distance, in metres, of a finite point from the surface that its label names.
inline double worst_surface_distance(const scene::Scene& scene, const cloud::Cloud& cloud) {
  const SphereTracer tracer(scene);
  double worst = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud::is_finite(cloud.points[i]))
      worst = std::max(worst, std::abs(tracer.distance_to(cloud.points[i].cast<double>(), cloud.labels[i])));
  return worst;
}

}  // namespace tubebin::testing
