#include "scan/surface_normal.hpp"

#include <cmath>

namespace tubebin::scan {
namespace {

/// Pixels to the rays close by: far above rounding in double precision, and so little that a tube does not bend.
constexpr double kStep = 1e-3;
/// Of depth over that step; what changes by more may be an edge, and the other side is asked, too.
constexpr double kSmooth = 1e-4;

/// From the hit to where a ray close by meets the same surface; the way in depth decides between the two sides.
Vec3 tangent(const RayCaster& caster, const scene::Camera& camera, const Eigen::Vector2d& at,
             const Eigen::Vector2d& step, const Hit& hit) {
  const Vec3 from = hit.depth * camera.direction_in_world(at.x(), at.y());
  Vec3 best = Vec3::Zero();
  double least_change = std::numeric_limits<double>::infinity();
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector2d beside = at + side * step;
    const Vec3 direction = camera.direction_in_world(beside.x(), beside.y());
    const Hit there = caster.first_hit(direction);
    const double change = std::abs(there.depth - hit.depth);
    if (there.label == hit.label && change < least_change) {
      least_change = change;
      best = side * (there.depth * direction - from);
    }
    if (least_change < kSmooth) break;
  }
  return best;
}

}  // namespace

Vec3 surface_normal(const RayCaster& caster, const scene::Camera& camera, double x, double y, const Hit& hit) {
  const Eigen::Vector2d at(x, y);
  const Vec3 to_camera = -camera.direction_in_world(x, y).normalized();
  const Vec3 normal =
      tangent(caster, camera, at, {kStep, 0.0}, hit).cross(tangent(caster, camera, at, {0.0, kStep}, hit));
  const double length = normal.norm();
  // A surface that is thinner than the steps shows its edge: as steep as can be seen.
  if (!(length > 0.0) || !std::isfinite(length)) return to_camera.unitOrthogonal();
  return normal.dot(to_camera) < 0.0 ? Vec3(-normal / length) : Vec3(normal / length);
}

}  // namespace tubebin::scan
