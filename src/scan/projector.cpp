#include "scan/projector.hpp"

#include <cmath>

namespace tubebin::scan {
namespace {

/// Metres. A point that is computed to lie on a surface is off by far less.
constexpr double kSurfaceTolerance = 1e-6;

Vec3 projector_in_world(const scene::Scanner& scanner) {
  return scanner.world_from_scanner() * scanner.effects.projector.position;
}

SceneSolids solids_around(scene::Scene scene, const Vec3& origin_in_world) {
  scene.scanner.position = origin_in_world;
  return scene_solids(scene);
}

/// The smallest rotation that turns the scanner's axes so that z points at the focus.
Eigen::Matrix3d scanner_from_projector(const scene::ProjectorOptions& projector) {
  const Vec3 to_focus = Vec3(0.0, 0.0, projector.focus_distance) - projector.position;
  return Quat::FromTwoVectors(Vec3::UnitZ(), to_focus).toRotationMatrix();
}

}  // namespace

Projector::Projector(const scene::Scene& scene)
    : position_in_world_(projector_in_world(scene.scanner)),
      projector_from_world_(
          (scene.scanner.world_from_scanner().linear() * scanner_from_projector(scene.scanner.effects.projector))
              .transpose()),
      tan_half_width_(std::tan(radians(scene.scanner.effects.projector.horizontal_fov_deg) / 2.0)),
      tan_half_height_(std::tan(radians(scene.scanner.effects.projector.vertical_fov_deg) / 2.0)),
      caster_(solids_around(scene, position_in_world_), 0.0, std::numeric_limits<float>::max()) {}

bool Projector::reaches(const Vec3& p_in_world) const {
  const Vec3 ray = p_in_world - position_in_world_;
  const Vec3 p_in_projector = projector_from_world_ * ray;
  const double depth = p_in_projector.z();
  if (!(depth > 0.0) || std::abs(p_in_projector.x()) > tan_half_width_ * depth ||
      std::abs(p_in_projector.y()) > tan_half_height_ * depth)
    return false;
  const double distance = ray.norm();
  return caster_.first_hit(ray / distance).depth >= distance - kSurfaceTolerance;
}

}  // namespace tubebin::scan
