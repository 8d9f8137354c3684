#include "scan/exact_shapes.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin {
namespace {

constexpr Interval kWholeLine = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

Interval common_part(const Interval& a, const Interval& b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

/// Where low <= t * slope <= high.
Interval between_planes(double low, double high, double slope) {
  if (slope == 0.0) return low <= 0.0 && 0.0 <= high ? kWholeLine : Interval{};
  const double a = low / slope;
  const double b = high / slope;
  return a < b ? Interval{a, b} : Interval{b, a};
}

}  // namespace

SolidCylinder::SolidCylinder(const Vec3& base, const Vec3& top, double radius)
    : base_(base),
      axis_((top - base).normalized()),
      length_((top - base).norm()),
      radius_(radius),
      base_height_(base.dot(axis_)),
      moment_(axis_.cross(base)),
      foot_(base - base_height_ * axis_) {}

// The ray's distance from the axis decides hit or miss without cancellation: with n = direction x axis it is
// |direction . moment| / |n|. Within the plane across the axis the ray's nearest point is at t = (direction .
// foot) / |n|^2, and half the chord is sqrt(radius^2 - distance^2) / |n|.
Interval SolidCylinder::intersect(const Vec3& direction, double radius) const {
  const double across_squared = direction.cross(axis_).squaredNorm();
  const double distance_across = direction.dot(moment_);
  const double chord = radius * radius * across_squared - distance_across * distance_across;
  if (chord < 0.0) return {};
  Interval side = kWholeLine;
  if (across_squared > 0.0) {
    const double nearest = direction.dot(foot_);
    const double half = std::sqrt(chord);
    side = {(nearest - half) / across_squared, (nearest + half) / across_squared};
  } else if (foot_.squaredNorm() > radius * radius) {
    return {};
  }
  return common_part(side, between_planes(base_height_, base_height_ + length_, direction.dot(axis_)));
}

/// A disc reaches radius * sin(angle between its normal and the coordinate axis) from its centre.
Eigen::AlignedBox3d SolidCylinder::bounds() const {
  const Vec3 reach = radius_ * (1.0 - axis_.array().square()).max(0.0).sqrt().matrix();
  const Vec3 top_center = top();
  return {base_.cwiseMin(top_center) - reach, base_.cwiseMax(top_center) + reach};
}

Interval SolidSphere::intersect(const Vec3& direction, double radius) const {
  const double squared_length = direction.squaredNorm();
  const double chord = radius * radius * squared_length - direction.cross(center_).squaredNorm();
  if (chord < 0.0) return {};
  const double nearest = direction.dot(center_);
  const double half = std::sqrt(chord);
  return {(nearest - half) / squared_length, (nearest + half) / squared_length};
}

Eigen::AlignedBox3d SolidSphere::bounds() const {
  const Vec3 reach = Vec3::Constant(radius_);
  return {center_ - reach, center_ + reach};
}

Vec3 inverse_direction(const Vec3& direction) {
  constexpr double kSteepest = 1e300;
  return direction.unaryExpr([](double slope) { return slope == 0.0 ? kSteepest : 1.0 / slope; });
}

}  // namespace tubebin
