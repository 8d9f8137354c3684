// The formulas of exact_shapes.hpp, which includes this. Inlined always, so that TUBEBIN_WIDE callers get them wide.
#pragma once

#include <cmath>
#include <type_traits>

#include "scan/exact_shapes.hpp"

namespace tubebin::scan {

template <typename Real>
[[gnu::always_inline]] inline void square_root(const Real& from, Real& to) {
  if constexpr (std::is_floating_point_v<Real>) to = std::sqrt(from);
  else
    for (std::size_t lane = 0; lane < sizeof(Real) / sizeof(double); ++lane) to[lane] = std::sqrt(from[lane]);
}

// The ray's distance from the axis decides hit or miss without cancellation: with n = direction x axis it is
// |direction . moment| / |n|. Within the plane across the axis the ray's nearest point is at t = (direction .
// foot) / |n|^2, and half the chord is sqrt(radius^2 - distance^2) / |n|. A ray along the axis is inside or
// outside for good, and one within the planes of the caps likewise.
template <typename Real>
[[gnu::always_inline]] inline void SolidCylinder::intersect(const DirectionOf<Real>& d, double radius,
                                                            IntervalOf<Real>& inside) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Real zero = {}, never = zero + kInfinity;
  const Real across_x = d.y * axis_.z() - d.z * axis_.y();
  const Real across_y = d.z * axis_.x() - d.x * axis_.z();
  const Real across_z = d.x * axis_.y() - d.y * axis_.x();
  const Real across_squared = across_x * across_x + (across_y * across_y + across_z * across_z);
  const Real distance_across = d.x * moment_.x() + (d.y * moment_.y() + d.z * moment_.z());
  const Real chord = radius * radius * across_squared - distance_across * distance_across;
  const Real nearest = d.x * foot_.x() + (d.y * foot_.y() + d.z * foot_.z());
  const Real slope = d.x * axis_.x() + (d.y * axis_.y() + d.z * axis_.z());
  Real half;
  square_root(chord > 0.0 ? chord : zero, half);

  const bool is_axis_near = foot_.squaredNorm() <= radius * radius;
  const Real side_always = is_axis_near ? never : -never;
  const Real side_begin = across_squared > 0.0 ? (nearest - half) / across_squared : -side_always;
  const Real side_end = across_squared > 0.0 ? (nearest + half) / across_squared : side_always;
  const Real low = base_height_ / slope, high = (base_height_ + length_) / slope;
  const bool is_between_caps = base_height_ <= 0.0 && 0.0 <= base_height_ + length_;
  const Real caps_always = is_between_caps ? never : -never;
  const Real caps_begin = slope != 0.0 ? (low < high ? low : high) : -caps_always;
  const Real caps_end = slope != 0.0 ? (low < high ? high : low) : caps_always;
  inside.begin = chord < 0.0 ? never : (side_begin < caps_begin ? caps_begin : side_begin);
  inside.end = chord < 0.0 ? -never : (caps_end < side_end ? caps_end : side_end);
}

template <typename Real>
[[gnu::always_inline]] inline void SolidSphere::intersect(const DirectionOf<Real>& d, double radius,
                                                          IntervalOf<Real>& inside) const {
  const Real zero = {}, never = zero + std::numeric_limits<double>::infinity();
  const Real across_x = d.y * center_.z() - d.z * center_.y();
  const Real across_y = d.z * center_.x() - d.x * center_.z();
  const Real across_z = d.x * center_.y() - d.y * center_.x();
  const Real squared_length = d.x * d.x + (d.y * d.y + d.z * d.z);
  const Real chord =
      radius * radius * squared_length - (across_x * across_x + (across_y * across_y + across_z * across_z));
  const Real nearest = d.x * center_.x() + (d.y * center_.y() + d.z * center_.z());
  Real half;
  square_root(chord > 0.0 ? chord : zero, half);
  inside.begin = chord < 0.0 ? never : (nearest - half) / squared_length;
  inside.end = chord < 0.0 ? -never : (nearest + half) / squared_length;
}

template <typename Real>
[[gnu::always_inline]] inline void invert(const DirectionOf<Real>& d, DirectionOf<Real>& inverse) {
  constexpr double kSteepest = 1e300;
  const Real zero = {}, steepest = zero + kSteepest;
  inverse.x = d.x == 0.0 ? steepest : 1.0 / d.x;
  inverse.y = d.y == 0.0 ? steepest : 1.0 / d.y;
  inverse.z = d.z == 0.0 ? steepest : 1.0 / d.z;
}

template <typename Real>
[[gnu::always_inline]] inline void intersect(const Eigen::AlignedBox3d& box, const DirectionOf<Real>& inverse,
                                             IntervalOf<Real>& inside) {
  const Real a_x = box.min().x() * inverse.x, b_x = box.max().x() * inverse.x;
  const Real a_y = box.min().y() * inverse.y, b_y = box.max().y() * inverse.y;
  const Real a_z = box.min().z() * inverse.z, b_z = box.max().z() * inverse.z;
  const Real begin_x = a_x < b_x ? a_x : b_x, end_x = a_x < b_x ? b_x : a_x;
  const Real begin_y = a_y < b_y ? a_y : b_y, end_y = a_y < b_y ? b_y : a_y;
  const Real begin_z = a_z < b_z ? a_z : b_z, end_z = a_z < b_z ? b_z : a_z;
  const Real begin_xy = begin_x < begin_y ? begin_y : begin_x, end_xy = end_x < end_y ? end_x : end_y;
  inside.begin = begin_xy < begin_z ? begin_z : begin_xy;
  inside.end = end_xy < end_z ? end_xy : end_z;
}

template <typename Real>
[[gnu::always_inline]] inline void SolidBox::turn(const DirectionOf<Real>& d, DirectionOf<Real>& own) const {
  own.x = d.x * axes_(0, 0) + (d.y * axes_(1, 0) + d.z * axes_(2, 0));
  own.y = d.x * axes_(0, 1) + (d.y * axes_(1, 1) + d.z * axes_(2, 1));
  own.z = d.x * axes_(0, 2) + (d.y * axes_(1, 2) + d.z * axes_(2, 2));
}

}  // namespace tubebin::scan
