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

SurfaceNormals::SurfaceNormals(const scene::Scene& scene) : bin_(scene.bin) {
  for (const scene::PlacedTube& placed : scene.tubes) {
    TubeParts parts{.wall_thickness = placed.tube.wall_thickness, .axes = {}, .free_ends = {}, .joints = {}};
    const std::vector<double> radii = placed.tube.node_radii();
    const std::vector<int> degrees = placed.tube.node_degrees();
    const auto is_free = [&](int node) { return degrees[static_cast<std::size_t>(node)] == 1; };
    for (const tube::Cylinder& cylinder : placed.tube.cylinders) {
      const Vec3 a = placed.node_in_world(cylinder.node_a), b = placed.node_in_world(cylinder.node_b);
      const Vec3 axis = (b - a).normalized();
      const double radius = placed.tube.radius_of(cylinder);
      parts.axes.push_back({a, b, radius});
      if (is_free(cylinder.node_a)) parts.free_ends.push_back({a, -axis, radius});
      if (is_free(cylinder.node_b)) parts.free_ends.push_back({b, axis, radius});
    }
    for (int node = 0; node < static_cast<int>(degrees.size()); ++node)
      if (!is_free(node)) parts.joints.push_back({placed.node_in_world(node), radii[static_cast<std::size_t>(node)]});
    tubes_.push_back(std::move(parts));
  }
}

Vec3 SurfaceNormals::at(cloud::Label label, const Vec3& point) const {
  return label == 0 ? at_bin(point) : at_tube(tubes_.at(label - 1), point);
}

Vec3 SurfaceNormals::at_tube(const TubeParts& tube, const Vec3& point) const {
  Nearest nearest;
  const auto offer_wall = [&](const Vec3& from_middle, double radius) {
    const double distance = from_middle.norm();
    nearest.offer(distance - radius, from_middle / distance);
    if (tube.wall_thickness > 0.0) nearest.offer(radius - tube.wall_thickness - distance, -from_middle / distance);
  };
  for (const auto& [a, b, radius] : tube.axes) {
    const double along = (point - a).dot(b - a) / (b - a).squaredNorm();
    if (along < 0.0 || along > 1.0) continue;
    offer_wall(point - (a + along * (b - a)), radius);
  }
  for (const auto& [center, radius] : tube.joints) offer_wall(point - center, radius);
  for (const auto& [center, normal, radius] : tube.free_ends)
    if ((point - center).norm() <= radius) nearest.offer((point - center).dot(normal), normal);
  return nearest.normal;
}

Vec3 SurfaceNormals::at_bin(const Vec3& point) const {
  const double half_length = bin_.length / 2.0, half_width = bin_.width / 2.0;
  const double outside = std::max(std::abs(point.x()) - half_length, std::abs(point.y()) - half_width);
  Nearest nearest;
  if (outside <= 0.0) nearest.offer(point.z(), Vec3::UnitZ());
  else nearest.offer(point.z() - bin_.height, Vec3::UnitZ());
  for (const double side : {-1.0, 1.0}) {
    nearest.offer(point.x() - side * half_length, Vec3(-side, 0, 0));
    nearest.offer(point.y() - side * half_width, Vec3(0, -side, 0));
    nearest.offer(point.x() - side * (half_length + bin_.wall_thickness), Vec3(side, 0, 0));
    nearest.offer(point.y() - side * (half_width + bin_.wall_thickness), Vec3(0, side, 0));
  }
  return nearest.normal;
}

}  // namespace tubebin::exports
