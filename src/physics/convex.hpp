/// Closest points of the convex solids that tubes and bins are made of. World frame, metres.
#pragma once

#include <utility>

#include "tubebin/core/geometry.hpp"

namespace tubebin::physics {

/// A segment of a tube's axis from a to b.
struct Segment {
  Vec3 a;
  Vec3 b;

  Vec3 at(double t) const { return a + t * (b - a); }  ///< t in [0, 1]
};

/// The closest points of two segments, as parameters in [0, 1].
struct SegmentPair {
  double s = 0.0;
  double t = 0.0;
};
/// After Ericson, "Real-Time Collision Detection" (2005), Section 5.1.9.
SegmentPair closest_on_segments(const Segment& first, const Segment& second);

/// A solid cylinder with flat ends.
struct SolidCylinder {
  Vec3 base;
  Vec3 axis;  ///< unit
  double length = 0.0;
  double radius = 0.0;

  /// The nearest point of the solid; the point itself where it lies inside.
  Vec3 project(const Vec3& point) const;
};

/// The parameter in [0, 1] where the segment comes nearest to a convex set, given the set's projection.
/// The distance to a convex set is convex along a line, so its slope has one change of sign to bisect.
template <typename Project>
double nearest_parameter(const Segment& segment, const Project& project) {
  constexpr int kBisections = 30;  // 2^-30 of a segment is below a nanometre
  const Vec3 direction = segment.b - segment.a;
  const auto slope = [&](double t) {
    const Vec3 point = segment.at(t);
    return (point - project(point)).dot(direction);
  };
  if (slope(0.0) >= 0.0) return 0.0;
  if (slope(1.0) <= 0.0) return 1.0;
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (slope(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The closest points of two convex sets by alternating projection (Cheney and Goldstein 1959), beginning at the
/// first set's point nearest to `start`.
template <typename ProjectFirst, typename ProjectSecond>
std::pair<Vec3, Vec3> closest_of_convex(const ProjectFirst& project_first, const ProjectSecond& project_second,
                                        const Vec3& start) {
  constexpr int kIterations = 60;
  constexpr double kConverged = 1e-9;  // metres
  Vec3 first = project_first(start);
  Vec3 second = project_second(first);
  for (int i = 0; i < kIterations; ++i) {
    const Vec3 next = project_first(second);
    const bool converged = (next - first).squaredNorm() < kConverged * kConverged;
    first = next;
    second = project_second(first);
    if (converged) break;
  }
  return {first, second};
}

}  // namespace tubebin::physics
