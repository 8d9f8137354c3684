// Where two convex solids overlap in plan view (seen from straight above), which of them is above?
#pragma once

#include <optional>

#include "tubebin/core/geometry.hpp"

namespace tubebin::scene {

/// The points within a radius of a segment, cut flat across it at either end on request. World frame, metres.
class ConvexSolid {
 public:
  /// A segment of two different points.
  ConvexSolid(const Vec3& a, const Vec3& b, double radius, bool flat_a, bool flat_b)
      : ends_{a, b}, axis_((b - a).normalized()), radius_(radius), flat_{flat_a, flat_b} {}
  /// A ball.
  ConvexSolid(const Vec3& center, double radius) : ends_{center, center}, axis_(Vec3::Zero()), radius_(radius) {}

  /// The point that is farthest along a horizontal direction (not zero).
  Vec3 farthest(const Eigen::Vector2d& direction) const;
  Vec3 middle() const { return 0.5 * (ends_[0] + ends_[1]); }
  Eigen::AlignedBox3d bounds() const;

 private:
  Vec3 ends_[2];
  Vec3 axis_;  // unit
  double radius_;
  bool flat_[2] = {false, false};
};

/// Where a vertical line meets both: how much higher than `first` it passes `second`, metres. Nothing where no vertical
/// line does. Of two solids that do not intersect the sign is the same for all lines.
std::optional<double> height_above(const ConvexSolid& first, const ConvexSolid& second);

}  // namespace tubebin::scene
