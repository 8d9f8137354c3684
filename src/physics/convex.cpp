#include "physics/convex.hpp"

#include <algorithm>

namespace tubebin::physics {

SegmentPair closest_on_segments(const Segment& first, const Segment& second) {
  const Vec3 d1 = first.b - first.a;
  const Vec3 d2 = second.b - second.a;
  const Vec3 r = first.a - second.a;
  const double a = d1.squaredNorm();
  const double e = d2.squaredNorm();
  const double f = d2.dot(r);
  const double c = d1.dot(r);
  const double b = d1.dot(d2);
  const double denominator = a * e - b * b;
  // A point, as a ball's axis, is near at any of its parameters.
  const auto parameter = [](double along, double squared_length) {
    return squared_length > 0.0 ? std::clamp(along / squared_length, 0.0, 1.0) : 0.0;
  };
  SegmentPair pair;
  // Parallel segments: any s will do; the caller adds the ends of the overlap.
  pair.s = denominator > 1e-12 * a * e ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.5;
  pair.t = parameter(b * pair.s + f, e);
  if (pair.t == 0.0 || pair.t == 1.0) pair.s = parameter(b * pair.t - c, a);
  return pair;
}

Vec3 SolidCylinder::project(const Vec3& point) const {
  const Vec3 offset = point - base;
  const double along = offset.dot(axis);
  const Vec3 radial = offset - along * axis;
  const double distance = radial.norm();
  const Vec3 inside = distance > radius ? Vec3(radial * (radius / distance)) : radial;
  return base + std::clamp(along, 0.0, length) * axis + inside;
}

}  // namespace tubebin::physics
