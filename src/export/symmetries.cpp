#include "export/symmetries.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::exports {
namespace {

/// Nodes that lie off a line, a plane or a circle by less than this lie on it (metres).
constexpr double kTolerance = 1e-6;

Vec3 middle(const std::vector<Vec3>& nodes) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& node : nodes) sum += node;
  return sum / static_cast<double>(nodes.size());
}

bool has_one_radius(const tube::Tube& tube) {
  return std::ranges::all_of(tube.cylinders, [&](const tube::Cylinder& cylinder) {
    return tube.radius_of(cylinder) == tube.radius_of(tube.cylinders.front());
  });
}

/// Half a turn about an axis through `origin`.
Pose half_turn(const Vec3& direction, const Vec3& origin) {
  const Pose turn(Eigen::AngleAxisd(std::numbers::pi, direction));
  return Pose(Eigen::Translation3d(origin)) * turn * Pose(Eigen::Translation3d(-origin));
}

/// Round about an axis, and the same upside down.
Symmetries of_solid_of_revolution(const Vec3& axis, const Vec3& center, const Vec3& across) {
  return {.continuous = {{axis, center}}, .discrete = {half_turn(across, center)}};
}

bool is_straight(const tube::Tube& tube, const Vec3& axis) {
  return std::ranges::all_of(
      tube.nodes, [&](const Vec3& node) { return (node - tube.nodes.front()).cross(axis).norm() < kTolerance; });
}

Symmetries of_straight(const tube::Tube& tube, const Vec3& axis) {
  const auto [low, high] =
      std::ranges::minmax_element(tube.nodes, {}, [&](const Vec3& node) { return axis.dot(node); });
  return of_solid_of_revolution(axis, 0.5 * (*low + *high), axis.unitOrthogonal());
}

/// One closed loop whose nodes are the corners of a regular polygon around `center`.
bool is_ring(const tube::Tube& tube, const Vec3& center, const Vec3& axis) {
  const std::vector<int> degrees = tube.node_degrees();
  const double radius = (tube.nodes.front() - center).norm(), side = tube.length(tube.cylinders.front());
  return tube.nodes.size() >= 3 && std::ranges::all_of(degrees, [](int degree) { return degree == 2; }) &&
         std::ranges::all_of(tube.nodes,
                             [&](const Vec3& node) {
                               return std::abs(axis.dot(node - center)) < kTolerance &&
                                      std::abs((node - center).norm() - radius) < kTolerance;
                             }) &&
         std::ranges::all_of(tube.cylinders, [&](const tube::Cylinder& cylinder) {
           return std::abs(tube.length(cylinder) - side) < kTolerance;
         });
}

}  // namespace

Symmetries find_symmetries(const tube::Tube& tube) {
  const Vec3 center = middle(tube.nodes);
  if (tube.cylinders.empty())
    return {.continuous = {{Vec3::UnitX(), center}, {Vec3::UnitY(), center}, {Vec3::UnitZ(), center}}, .discrete = {}};
  if (!has_one_radius(tube)) return {};
  const Vec3 axis = (tube.nodes[1] - tube.nodes[0]).normalized();
  if (is_straight(tube, axis)) return of_straight(tube, axis);
  const Vec3 spoke = tube.nodes[0] - center, normal = spoke.cross(tube.nodes[1] - center).normalized();
  if (is_ring(tube, center, normal)) return of_solid_of_revolution(normal, center, spoke.normalized());
  return {};
}

}  // namespace tubebin::exports
