#include "scan/exact_shapes.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::scan {
namespace {

/// A formula's interval of one ray, as `cut` writes it.
template <typename Cut>
Interval interval_of(const Cut& cut) {
  IntervalOf<double> inside;
  cut(inside);
  return {inside.begin, inside.end};
}

DirectionOf<double> components(const Vec3& direction) { return {direction.x(), direction.y(), direction.z()}; }

}  // namespace

SolidCylinder::SolidCylinder(const Vec3& base, const Vec3& top, double radius)
    : base_(base),
      axis_((top - base).normalized()),
      length_((top - base).norm()),
      radius_(radius),
      base_height_(base.dot(axis_)),
      moment_(axis_.cross(base)),
      foot_(base - base_height_ * axis_) {}

Interval SolidCylinder::intersect(const Vec3& direction, double radius) const {
  return interval_of([&](IntervalOf<double>& inside) { intersect(components(direction), radius, inside); });
}

/// A disc reaches radius * sin(angle between its normal and the coordinate axis) from its centre.
Eigen::AlignedBox3d SolidCylinder::bounds() const {
  const Vec3 reach = radius_ * (1.0 - axis_.array().square()).max(0.0).sqrt().matrix();
  const Vec3 top_center = top();
  return {base_.cwiseMin(top_center) - reach, base_.cwiseMax(top_center) + reach};
}

Interval SolidSphere::intersect(const Vec3& direction, double radius) const {
  return interval_of([&](IntervalOf<double>& inside) { intersect(components(direction), radius, inside); });
}

Eigen::AlignedBox3d SolidSphere::bounds() const {
  const Vec3 reach = Vec3::Constant(radius_);
  return {center_ - reach, center_ + reach};
}

Vec3 inverse_direction(const Vec3& direction) {
  DirectionOf<double> inverse;
  invert(components(direction), inverse);
  return {inverse.x, inverse.y, inverse.z};
}

Interval intersect(const Eigen::AlignedBox3d& box, const Vec3& inverse_direction) {
  return interval_of([&](IntervalOf<double>& inside) { intersect(box, components(inverse_direction), inside); });
}

std::array<Vec3, 8> SolidBox::corners() const {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = box_.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
    if (is_turned_) corners[i] = axes_ * corners[i];
  }
  return corners;
}

Eigen::AlignedBox3d SolidBox::bounds() const {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& corner : corners()) bounds.extend(corner);
  return bounds;
}

Interval SolidBox::intersect(const Vec3& direction) const {
  if (!is_turned_) return scan::intersect(box_, inverse_direction(direction));
  DirectionOf<double> own;
  turn(components(direction), own);
  return scan::intersect(box_, inverse_direction({own.x, own.y, own.z}));
}

}  // namespace tubebin::scan
