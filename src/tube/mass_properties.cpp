// The union of cylinders and joint spheres is split among the cylinders by the bisecting planes at each joint, so
// no part counts twice. Along a line parallel to a cylinder's axis its share is one interval, integrated exactly;
// over the cross-section a polar product rule is used. Where cylinders of different radii meet, the step between them is
// left out.
#include <algorithm>
#include <array>
#include <cmath>

#include "tubebin/tube/tube.hpp"

namespace tubebin {
namespace {

constexpr int kRings = 12;
constexpr int kSectors = 32;

/// Volume, first and second moments of a solid at unit density.
struct Moments {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  /// Adds the points base + t * axis for t in [from, to], each with cross-section `area`.
  void add_line(const Vec3& base, const Vec3& axis, double from, double to, double area) {
    const double m0 = area * (to - from);
    const double m1 = area * (to * to - from * from) / 2.0;
    const double m2 = area * (to * to * to - from * from * from) / 3.0;
    volume += m0;
    first += m0 * base + m1 * axis;
    const Eigen::Matrix3d mixed = base * axis.transpose();
    second += m0 * base * base.transpose() + m1 * (mixed + mixed.transpose()) + m2 * axis * axis.transpose();
  }

  void subtract(const Moments& other) {
    volume -= other.volume;
    first -= other.first;
    second -= other.second;
  }
};

/// Where the cylinder's share of a line begins: `offset` is the line's place in the cross-section, `axis` points
/// into the cylinder. Points nearer (by angle) to a neighbour belong to it; outside, the sphere ends the joint.
double line_start(const Vec3& offset, const Vec3& axis, const std::vector<Vec3>& neighbours, double radius) {
  if (neighbours.empty()) return 0.0;
  double start = -std::sqrt(std::max(0.0, radius * radius - offset.squaredNorm()));
  for (const Vec3& direction : neighbours) {
    const double spread = 1.0 - direction.dot(axis);
    // A neighbour that folds straight back shares the whole cylinder: leave the overlap to this end's flat cut.
    start = spread < 1e-9 ? std::max(start, 0.0) : std::max(start, direction.dot(offset) / spread);
  }
  return start;
}

/// `wall`: metres, taken off the radius; as in all that follows.
void add_cylinder(const Tube& tube, std::size_t index, double wall, Moments& moments) {
  const Cylinder& cylinder = tube.cylinders[index];
  const double radius = tube.radius_of(cylinder) - wall;
  const Vec3& a = tube.nodes[static_cast<std::size_t>(cylinder.node_a)];
  const double length = tube.length(cylinder);
  const Vec3 axis = (tube.nodes[static_cast<std::size_t>(cylinder.node_b)] - a) / length;
  const Vec3 u = axis.unitOrthogonal();
  const Vec3 v = axis.cross(u);
  const std::vector<Vec3> at_a = tube.directions_from(cylinder.node_a, index);
  const std::vector<Vec3> at_b = tube.directions_from(cylinder.node_b, index);
  for (int ring = 0; ring < kRings; ++ring) {
    // Rings of equal area; each ring's root-mean-square radius keeps the disc's second moment exact.
    const double inner = radius * std::sqrt(static_cast<double>(ring) / kRings);
    const double outer = radius * std::sqrt(static_cast<double>(ring + 1) / kRings);
    const double rho = std::sqrt((inner * inner + outer * outer) / 2.0);
    const double area = std::numbers::pi * radius * radius / (kRings * kSectors);
    for (int sector = 0; sector < kSectors; ++sector) {
      const double angle = 2.0 * std::numbers::pi * (sector + 0.5) / kSectors;
      const Vec3 offset = rho * (std::cos(angle) * u + std::sin(angle) * v);
      const double from = line_start(offset, axis, at_a, radius);
      const double to = length - line_start(offset, -axis, at_b, radius);
      if (to > from) moments.add_line(a + offset, axis, from, to, area);
    }
  }
}

/// Nodes without a cylinder are spheres of their own.
void add_lone_spheres(const Tube& tube, double wall, Moments& moments) {
  const double radius = tube.radius - wall;
  const std::vector<int> degrees = tube.node_degrees();
  for (std::size_t i = 0; i < tube.nodes.size(); ++i) {
    if (degrees[i] != 0) continue;
    const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    const Vec3& center = tube.nodes[i];
    moments.volume += volume;
    moments.first += volume * center;
    moments.second += volume * (center * center.transpose() + Eigen::Matrix3d::Identity() * (radius * radius / 5.0));
  }
}

Moments solid_moments(const Tube& tube, double wall) {
  Moments moments;
  for (std::size_t i = 0; i < tube.cylinders.size(); ++i) add_cylinder(tube, i, wall, moments);
  add_lone_spheres(tube, wall, moments);
  return moments;
}

}  // namespace

MassProperties mass_properties(const Tube& tube) {
  Moments moments = solid_moments(tube, 0.0);
  if (tube.wall_thickness > 0.0) moments.subtract(solid_moments(tube, tube.wall_thickness));
  const double density = tube.mass / moments.volume;
  MassProperties properties;
  properties.mass = tube.mass;
  properties.center = moments.first / moments.volume;
  const Eigen::Matrix3d central =
      density * (moments.second - moments.volume * properties.center * properties.center.transpose());
  properties.inertia = Eigen::Matrix3d::Identity() * central.trace() - central;
  return properties;
}

}  // namespace tubebin
