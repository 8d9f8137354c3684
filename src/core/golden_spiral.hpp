/// Directions that are spread evenly.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "tubebin/core/geometry.hpp"

namespace tubebin {

/// `count` unit vectors along a golden spiral on the sphere, from z = 1 down to z = `lowest`.
inline std::vector<Vec3> golden_spiral(std::size_t count, double lowest) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Vec3> directions;
  for (std::size_t k = 0; k < count; ++k) {
    const double z = 1.0 - (1.0 - lowest) * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const double across = std::sqrt(1.0 - z * z), angle = golden_angle * static_cast<double>(k);
    directions.emplace_back(across * std::cos(angle), across * std::sin(angle), z);
  }
  return directions;
}

}  // namespace tubebin
