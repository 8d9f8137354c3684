#include "export/surface_normal.hpp"

#include <cmath>
#include <limits>

namespace tubebin::exports {
namespace {

/// Keeps the normal of the nearest surface that was offered.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::UnitZ();

  void offer(double signed_distance, const Vec3& candidate) {
    if (std::abs(signed_distance) >= distance) return;
    distance = std::abs(signed_distance);
    normal = candidate;
  }
};

}  // namespace

SurfaceNormals::SurfaceNormals(const scene::Scene& scene)
    : boxes_(scene::bin_parts(scene.bin)),
      cylinders_(scene::surrounding_cylinders(scene)),
      mesh_(scene::mesh_triangles(scene.bin)),
      scanner_(scene.scanner.position) {
  const std::vector<scene::BinPart> around = scene::surrounding_boxes(scene);
  boxes_.insert(boxes_.end(), around.begin(), around.end());
  for (const scene::PlacedTube& tube : scene.tubes) tubes_.push_back(tube.solids_in_world());
}

Vec3 SurfaceNormals::at(cloud::Label label, const Vec3& point) const {
  return label == 0 ? at_background(point) : at_tube(tubes_.at(label - 1), point);
}

Vec3 SurfaceNormals::at_tube(const tube::TubeSolids& tube, const Vec3& point) const {
  Nearest nearest;
  const auto offer_wall = [&](const Vec3& from_middle, const auto& solid) {
    const double distance = from_middle.norm();
    nearest.offer(distance - solid.radius, from_middle / distance);
    if (solid.bore_radius > 0.0) nearest.offer(solid.bore_radius - distance, -from_middle / distance);
  };
  const auto offer_end = [&](const Vec3& center, const Vec3& outward, double radius) {
    if ((point - center).norm() <= radius) nearest.offer((point - center).dot(outward), outward);
  };
  for (const tube::SolidCylinder& cylinder : tube.cylinders) {
    const Vec3 axis = cylinder.b - cylinder.a;
    const double along = (point - cylinder.a).dot(axis) / axis.squaredNorm();
    if (along >= 0.0 && along <= 1.0) offer_wall(point - (cylinder.a + along * axis), cylinder);
  }
  for (const tube::JointSphere& joint : tube.joints) offer_wall(point - joint.center, joint);
  for (const tube::SolidCylinder& cylinder : tube.cylinders) {
    const Vec3 outward = (cylinder.b - cylinder.a).normalized();
    if (cylinder.is_free_a) offer_end(cylinder.a, -outward, cylinder.radius);
    if (cylinder.is_free_b) offer_end(cylinder.b, outward, cylinder.radius);
  }
  return nearest.normal;
}

/// Of the part that is nearest, the face that the point is farthest beyond. Where it is level with several parts, as the
/// floor at a wall's foot, the first.
Vec3 SurfaceNormals::at_background(const Vec3& point) const {
  Nearest nearest;
  for (const auto& [box, world_from_part, is_turned] : boxes_) {
    const Vec3 from_center = world_from_part.inverse() * point - box.center();
    const Vec3 beyond = from_center.cwiseAbs() - box.sizes() / 2.0;
    Eigen::Index axis = 0;
    const double farthest = beyond.maxCoeff(&axis);
    const double outside = beyond.cwiseMax(0.0).norm();
    nearest.offer(outside > 0.0 ? outside : farthest,
                  world_from_part.linear() * Vec3(Vec3::Unit(axis) * (from_center[axis] < 0.0 ? -1.0 : 1.0)));
  }
  for (const scene::StandingCylinder& cylinder : cylinders_) {
    const Vec3 from_foot = point - cylinder.position;
    const double across = from_foot.head<2>().norm();
    if (across <= cylinder.radius) nearest.offer(from_foot.z() - cylinder.height, Vec3::UnitZ());
    if (from_foot.z() >= 0.0 && from_foot.z() <= cylinder.height && across > 0.0)
      nearest.offer(across - cylinder.radius, Vec3(from_foot.x(), from_foot.y(), 0.0) / across);
  }
  std::vector<const scene::Triangle*> near;
  const Vec3 reach = Vec3::Constant(std::min(nearest.distance, mesh_.distance(point)));
  mesh_.find({point - reach, point + reach}, near);
  for (const scene::Triangle* triangle : near) {  // of its two sides the one that the scanner sees
    const Vec3 normal = triangle->normal();
    nearest.offer((point - triangle->project(point)).norm(),
                  normal.dot(scanner_ - triangle->corners[0]) < 0.0 ? Vec3(-normal) : normal);
  }
  return nearest.normal;
}

}  // namespace tubebin::exports
