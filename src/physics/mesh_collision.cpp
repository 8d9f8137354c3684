#include "physics/mesh_collision.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::physics {
namespace {

/// A triangle and a ball around it, which tells fast that it is out of reach.
struct NearTriangle {
  explicit NearTriangle(const scene::Triangle& near) : triangle(&near) {
    const auto& [a, b, c] = near.corners;
    center = (a + b + c) / 3.0;
    for (const Vec3& corner : near.corners) reach = std::max(reach, (corner - center).norm());
  }

  const scene::Triangle* triangle;
  Vec3 center;
  double reach = 0.0;  // metres
};

using Triangles = std::vector<NearTriangle>;

double distance_to(const Segment& segment, const Vec3& point) {
  const Vec3 along = segment.b - segment.a;
  const double t = (point - segment.a).dot(along) / std::max(along.squaredNorm(), 1e-18);
  return (segment.at(std::clamp(t, 0.0, 1.0)) - point).norm();
}

/// Metres by which a place may be beside a triangle and still be on it.
constexpr double kOnTriangle = 1e-7;
/// So far beyond a triangle's edge a rim that is pressed into its plane is still held: in a corner of the bin, a rim that
/// is a little in both walls is beyond both.
constexpr double kHeldBeyondEdge = 0.001;  // metres

/// Whether no triangle comes nearer in the direction in which a body is: else the edge at `place` is within a surface that
/// goes on there, or in a corner, and the neighbour is what the body touches.
bool is_nearest_around(const Triangles& near, const Vec3& place, const Vec3& normal) {
  constexpr double kSine = 1e-4;
  return std::ranges::none_of(near, [&](const NearTriangle& other) {
    if ((other.center - place).norm() > other.reach + kOnTriangle) return false;
    if ((other.triangle->project(place) - place).squaredNorm() > kOnTriangle * kOnTriangle) return false;
    return std::ranges::any_of(other.triangle->corners, [&](const Vec3& corner) {
      const Vec3 along = corner - place;
      return along.dot(normal) > kSine * along.norm() + kOnTriangle;
    });
  });
}

/// One cylinder or joint of a tube against the triangles near it.
class NearMesh {
 public:
  NearMesh(const scene::TriangleTree& mesh, const scene::Box& bounds, const Segment& axis, double radius,
           double depth_min, std::vector<Touch>& out)
      : depth_min_(depth_min), out_(out) {
    const double margin = -std::min(depth_min, 0.0);
    std::vector<const scene::Triangle*> found;
    mesh.find({bounds.min() - Vec3::Constant(margin), bounds.max() + Vec3::Constant(margin)}, found);
    for (const scene::Triangle* triangle : found) {
      const NearTriangle near(*triangle);
      if (distance_to(axis, near.center) <= radius + margin + near.reach) near_.push_back(near);
    }
  }

  void add_ball(const Vec3& center, double radius) {
    for (const NearTriangle& near : near_) add_ball(*near.triangle, center, radius);
  }

  void add_cylinder(const CollisionCylinder& cylinder) {
    for (const NearTriangle& near : near_) {
      if (cylinder.flat_a) add_rim(*near.triangle, cylinder, true);
      if (cylinder.flat_b) add_rim(*near.triangle, cylinder, false);
      add_side(*near.triangle, cylinder);
    }
  }

 private:
  void add_ball(const scene::Triangle& triangle, const Vec3& center, double radius) {
    const Vec3 nearest = triangle.project(center);
    const Vec3 offset = center - nearest;
    const double distance = offset.norm(), depth = radius - distance;
    if (depth < depth_min_ || distance < 1e-12) return;
    const Vec3 normal = offset / distance;
    if (is_nearest_around(near_, nearest, normal)) out_.push_back({nearest - normal * (0.5 * depth), normal, depth});
  }

  /// The rim of a flat end. Its cylinder says on which side of the triangle it belongs.
  void add_rim(const scene::Triangle& triangle, const CollisionCylinder& cylinder, bool at_a) {
    const Vec3 center = at_a ? cylinder.axis.a : cylinder.axis.b;
    const Vec3 toward = triangle.project(center) - center;
    const double reach = cylinder.radius - depth_min_;
    if (toward.squaredNorm() > reach * reach) return;
    const Vec3 inward = (at_a ? 1.0 : -1.0) * std::min(cylinder.radius, cylinder.length / 2.0) * cylinder.direction;
    const Vec3& corner = triangle.corners[0];
    const Vec3 normal = (triangle.normal().dot(center + inward - corner) < 0.0 ? -1.0 : 1.0) * triangle.normal();
    for (const Vec3& rim : rim_points(cylinder, center, toward)) {
      const double height = normal.dot(rim - corner);
      if (height > 0.0) add_ball(triangle, rim, 0.0);
      else add_pressed_point(triangle, rim, normal, -height);
    }
  }

  void add_pressed_point(const scene::Triangle& triangle, const Vec3& point, const Vec3& normal, double depth) {
    const Vec3 on_plane = point + depth * normal;
    const double beyond = (triangle.project(on_plane) - on_plane).norm();
    if (beyond < kOnTriangle || std::max(beyond, depth) < kHeldBeyondEdge)
      out_.push_back({point + 0.5 * depth * normal, normal, depth});
  }

  /// Between its ends, across an edge of the mesh; over a face the ends are nearest.
  void add_side(const scene::Triangle& triangle, const CollisionCylinder& cylinder) {
    const auto project = [&](const Vec3& point) { return triangle.project(point); };
    const double t = nearest_parameter(cylinder.axis, project);
    if (t > 0.0 && t < 1.0) return add_ball(triangle, cylinder.axis.at(t), cylinder.radius);
    if (!(t <= 0.0 ? cylinder.flat_a : cylinder.flat_b)) return;  // a joint stands for it
    const SolidCylinder core = cylinder.solid(kRimRounding);
    const auto [on_mesh, on_core] = closest_of_convex(
        project, [&](const Vec3& x) { return core.project(x); }, cylinder.axis.at(t));
    if ((on_core - on_mesh).squaredNorm() > 1e-18) add_ball(triangle, on_core, kRimRounding);
  }

  double depth_min_;
  std::vector<Touch>& out_;
  Triangles near_;
};

}  // namespace

void collide(const scene::TriangleTree& mesh, const CollisionTube& tube, double depth_min, std::vector<Touch>& out) {
  if (mesh.empty()) return;
  const std::size_t begin = out.size();
  for (const Ball& joint : tube.joints) {
    const Vec3 reach = Vec3::Constant(joint.radius);
    NearMesh(mesh, {joint.center - reach, joint.center + reach}, {joint.center, joint.center}, joint.radius, depth_min,
             out)
        .add_ball(joint.center, joint.radius);
  }
  for (const CollisionCylinder& cylinder : tube.cylinders)
    NearMesh(mesh, cylinder.bounds, cylinder.axis, cylinder.radius, depth_min, out).add_cylinder(cylinder);
  keep_deepest_of_each_spot(begin, 0.5 * tube.radius, out);
}

}  // namespace tubebin::physics
