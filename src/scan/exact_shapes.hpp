// Convex solids against rays from the origin, in double precision. A ray is t * direction; a convex solid
// takes one interval of t from it, negative t included, so a solid around the origin needs no case of its
// own. The formulas are written once for `Real`, one ray's double or the lanes of several rays.
#pragma once

#include <array>
#include <limits>

#include "tubebin/core/geometry.hpp"

namespace tubebin::scan {

/// The part [begin, end] of a ray; empty unless begin <= end.
struct Interval {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(begin <= end); }
};

template <typename Real>
struct DirectionOf {
  Real x, y, z;
};

/// Empty unless begin <= end.
template <typename Real>
struct IntervalOf {
  Real begin, end;
};

/// A solid cylinder with flat caps.
class SolidCylinder {
 public:
  /// `base` and `top` (metres, different) are the centres of the caps.
  SolidCylinder(const Vec3& base, const Vec3& top, double radius);

  Interval intersect(const Vec3& direction) const { return intersect(direction, radius_); }
  /// As if it had another radius; where both go through a cap, both give that cap's t bit by bit.
  Interval intersect(const Vec3& direction, double radius) const;
  template <typename Real>
  void intersect(const DirectionOf<Real>& direction, double radius, IntervalOf<Real>& inside) const;
  Eigen::AlignedBox3d bounds() const;

  const Vec3& base() const { return base_; }
  Vec3 top() const { return base_ + length_ * axis_; }
  const Vec3& axis() const { return axis_; }  ///< unit, from base to top
  double radius() const { return radius_; }

 private:
  Vec3 base_;
  Vec3 axis_;
  double length_;
  double radius_;
  double base_height_;  ///< of the base above the origin, along the axis
  Vec3 moment_;         ///< axis x base: direction . moment is the ray's distance from the axis, times |direction x
                        ///< axis|
  Vec3 foot_;           ///< the axis' point nearest to the origin
};

class SolidSphere {
 public:
  SolidSphere(const Vec3& center, double radius) : center_(center), radius_(radius) {}

  Interval intersect(const Vec3& direction) const { return intersect(direction, radius_); }
  /// As if it had another radius.
  Interval intersect(const Vec3& direction, double radius) const;
  template <typename Real>
  void intersect(const DirectionOf<Real>& direction, double radius, IntervalOf<Real>& inside) const;
  Eigen::AlignedBox3d bounds() const;

  const Vec3& center() const { return center_; }
  double radius() const { return radius_; }

 private:
  Vec3 center_;
  double radius_;
};

/// 1 / direction, finite: a ray within a face's plane touches the box.
template <typename Real>
void invert(const DirectionOf<Real>& direction, DirectionOf<Real>& inverse);
Vec3 inverse_direction(const Vec3& direction);

/// An axis-aligned solid box (Kay and Kajiya 1986, "Ray tracing complex scenes"). Many boxes share one ray's
/// inverse.
template <typename Real>
void intersect(const Eigen::AlignedBox3d& box, const DirectionOf<Real>& inverse_direction, IntervalOf<Real>& inside);
Interval intersect(const Eigen::AlignedBox3d& box, const Vec3& inverse_direction);

/// A solid box in axes of its own.
class SolidBox {
 public:
  /// In the axes that rays have.
  explicit SolidBox(const Eigen::AlignedBox3d& box) : SolidBox(box, Eigen::Matrix3d::Identity(), false) {}
  /// Its own axes are the columns of `axes`, in those that rays have; where it is not turned they are the same.
  SolidBox(const Eigen::AlignedBox3d& box, const Eigen::Matrix3d& axes, bool is_turned)
      : box_(box), axes_(axes), is_turned_(is_turned) {}

  bool is_turned() const { return is_turned_; }
  /// In its own axes.
  const Eigen::AlignedBox3d& box() const { return box_; }
  /// In those of the rays; numbered as a box's.
  std::array<Vec3, 8> corners() const;
  Eigen::AlignedBox3d bounds() const;
  Interval intersect(const Vec3& direction) const;
  template <typename Real>
  void turn(const DirectionOf<Real>& direction, DirectionOf<Real>& own) const;

 private:
  Eigen::AlignedBox3d box_;
  Eigen::Matrix3d axes_;
  bool is_turned_;
};

}  // namespace tubebin::scan

#include "scan/exact_shapes_formulas.hpp"
