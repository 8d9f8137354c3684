// The union of cylinders and joint spheres is split among the cylinders by the bisecting planes at each joint, so
// no part counts twice. Along a line parallel to a cylinder's axis its share is one interval, integrated exactly;
// over the cross-section a polar product rule is used. Where cylinders of different radii meet, the step between them is
// left out.
#include <algorithm>
#include <array>
#include <cmath>

#include "tubebin/tube/tube.hpp"

namespace tubebin::tube {
namespace {

constexpr int kRings = 12;
constexpr int kSectors = 32;

/// The product rule on a disc of radius 1: rings of equal area, each of whose root-mean-square radius keeps the disc's
/// second moment exact.
struct DiscRule {
  std::array<double, kRings> radii;
  std::array<double, kSectors> cosines, sines;

  DiscRule() {
    for (std::size_t ring = 0; ring < kRings; ++ring)
      radii[ring] = std::sqrt((static_cast<double>(ring) + 0.5) / kRings);
    for (std::size_t sector = 0; sector < kSectors; ++sector) {
      const double angle = 2.0 * std::numbers::pi * (static_cast<double>(sector) + 0.5) / kSectors;
      cosines[sector] = std::cos(angle);
      sines[sector] = std::sin(angle);
    }
  }
};

/// Volume, first and second moments of a solid at unit density.
struct Moments {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  void add(const Moments& other, double sign = 1.0) {
    volume += sign * other.volume;
    first += sign * other.first;
    second += sign * other.second;
  }

  /// The solid's moments once it is rotated, then moved.
  Moments moved(const Eigen::Matrix3d& rotation, const Vec3& offset) const {
    const Vec3 turned = rotation * first;
    const Eigen::Matrix3d mixed = offset * turned.transpose();
    return {
        volume, turned + volume * offset,
        rotation * second * rotation.transpose() + mixed + mixed.transpose() + volume * offset * offset.transpose()};
  }
};

/// Moments of lines along z, each with a cross-section of `area`.
class LineMoments {
 public:
  explicit LineMoments(double area) : area_(area) {}

  /// Adds the points (x, y, z) with z in [from, to].
  void add(double x, double y, double from, double to) {
    const double m0 = area_ * (to - from);
    const double m1 = area_ * (to * to - from * from) / 2.0;
    const double m2 = area_ * (to * to * to - from * from * from) / 3.0;
    volume_ += m0;
    x_ += m0 * x, y_ += m0 * y, z_ += m1;
    xx_ += m0 * x * x, xy_ += m0 * x * y, yy_ += m0 * y * y;
    xz_ += m1 * x, yz_ += m1 * y, zz_ += m2;
  }

  Moments sum() const {
    return {volume_, {x_, y_, z_}, Eigen::Matrix3d{{xx_, xy_, xz_}, {xy_, yy_, yz_}, {xz_, yz_, zz_}}};
  }

 private:
  double area_;
  double volume_ = 0.0;
  double x_ = 0.0, y_ = 0.0, z_ = 0.0;
  double xx_ = 0.0, xy_ = 0.0, yy_ = 0.0, xz_ = 0.0, yz_ = 0.0, zz_ = 0.0;
};

/// Where the cylinder's share of the line at (x, y) begins, in a frame whose z axis points from the joint into the
/// cylinder. Points nearer (by angle) to a neighbour belong to it; outside, the sphere ends the joint.
double line_start(double x, double y, const std::vector<Vec3>& neighbours, double radius) {
  if (neighbours.empty()) return 0.0;
  double start = -std::sqrt(std::max(0.0, radius * radius - x * x - y * y));
  for (const Vec3& direction : neighbours) {
    const double spread = 1.0 - direction.z();
    // A neighbour that folds straight back shares the whole cylinder: leave the overlap to this end's flat cut.
    start = std::max(start, spread < 1e-9 ? 0.0 : (direction.x() * x + direction.y() * y) / spread);
  }
  return start;
}

/// `wall`: metres, taken off the radius; as in all that follows.
Moments cylinder_moments(const Tube& tube, std::size_t index, double wall) {
  const Cylinder& cylinder = tube.cylinders[index];
  const double radius = tube.radius_of(cylinder) - wall;
  const Vec3& a = tube.nodes[static_cast<std::size_t>(cylinder.node_a)];
  const double length = tube.length(cylinder);
  const Vec3 axis = (tube.nodes[static_cast<std::size_t>(cylinder.node_b)] - a) / length;
  const Vec3 u = axis.unitOrthogonal();
  Eigen::Matrix3d frame;
  frame << u, axis.cross(u), axis;
  std::vector<Vec3> at_a = tube.directions_from(cylinder.node_a, index);
  std::vector<Vec3> at_b = tube.directions_from(cylinder.node_b, index);
  for (Vec3& direction : at_a) direction = frame.transpose() * direction;
  for (Vec3& direction : at_b) direction = (frame.transpose() * direction).cwiseProduct(Vec3(1.0, 1.0, -1.0));
  static const DiscRule rule;
  LineMoments lines(std::numbers::pi * radius * radius / (kRings * kSectors));
  for (std::size_t sector = 0; sector < kSectors; ++sector)
    for (const double share : rule.radii) {
      const double rho = radius * share;
      const double x = rho * rule.cosines[sector], y = rho * rule.sines[sector];
      const double from = line_start(x, y, at_a, radius);
      const double to = length - line_start(x, y, at_b, radius);
      if (to > from) lines.add(x, y, from, to);
    }
  return lines.sum().moved(frame, a);
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
  for (std::size_t i = 0; i < tube.cylinders.size(); ++i) moments.add(cylinder_moments(tube, i, wall));
  add_lone_spheres(tube, wall, moments);
  return moments;
}

}  // namespace

MassProperties mass_properties(const Tube& tube) {
  Moments moments = solid_moments(tube, 0.0);
  if (tube.wall_thickness > 0.0) moments.add(solid_moments(tube, tube.wall_thickness), -1.0);
  const double density = tube.mass / moments.volume;
  MassProperties properties;
  properties.mass = tube.mass;
  properties.center = moments.first / moments.volume;
  const Eigen::Matrix3d central =
      density * (moments.second - moments.volume * properties.center * properties.center.transpose());
  properties.inertia = Eigen::Matrix3d::Identity() * central.trace() - central;
  return properties;
}

}  // namespace tubebin::tube
