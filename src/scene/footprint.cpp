#include "scene/footprint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tubebin::scene {
namespace {

using Vec2 = Eigen::Vector2d;

Eigen::Matrix2d axes_of(const Footprint& footprint) { return Eigen::Rotation2Dd(footprint.yaw).toRotationMatrix(); }

double distance_to_rectangle(const Footprint& rectangle, const Vec2& point) {
  const Vec2 p = axes_of(rectangle).transpose() * (point - rectangle.center);
  return (p.cwiseAbs() - rectangle.half_size).cwiseMax(0.0).norm();
}

/// Whether a line along one of a's sides has all of b beyond it.
bool is_split_by_a_side(const Footprint& a, const Footprint& b) {
  const Eigen::Matrix2d axes = axes_of(a), from_b = axes.transpose() * axes_of(b);
  const Vec2 apart = (axes.transpose() * (b.center - a.center)).cwiseAbs();
  return ((apart - a.half_size - from_b.cwiseAbs() * b.half_size).array() > 0.0).any();
}

}  // namespace

std::array<Vec2, 4> Footprint::corners() const {
  const Vec2 along = axes_of(*this).col(0) * half_size.x(), across = axes_of(*this).col(1) * half_size.y();
  return {center - along - across, center + along - across, center - along + across, center + along + across};
}

/// Two convex polygons that don't meet are nearest at a corner of one of them.
double distance(const Footprint& a, const Footprint& b) {
  if (!is_split_by_a_side(a, b) && !is_split_by_a_side(b, a)) return 0.0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec2& corner : b.corners()) nearest = std::min(nearest, distance_to_rectangle(a, corner));
  for (const Vec2& corner : a.corners()) nearest = std::min(nearest, distance_to_rectangle(b, corner));
  return std::max(0.0, nearest - a.radius - b.radius);
}

}  // namespace tubebin::scene
