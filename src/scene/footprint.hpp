/// What bodies take up, seen from above. World frame, metres.
#pragma once

#include <array>

#include "tubebin/core/geometry.hpp"

namespace tubebin::scene {

/// All that is within `radius` of a rectangle, which may be a segment or a point: a cylinder's disc, a box, a lying tube.
struct Footprint {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();  ///< of the rectangle
  double yaw = 0.0;                                     ///< radians
  double radius = 0.0;

  std::array<Eigen::Vector2d, 4> corners() const;  ///< of the rectangle
};

/// Between the two; 0 where they overlap.
double distance(const Footprint& a, const Footprint& b);

}  // namespace tubebin::scene
