#pragma once

#include <cstdint>

#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {

/// Pixels of the largest image, 32 million; scanning one takes about 40 bytes each.
constexpr std::int64_t kPixelsMax = std::int64_t{1} << 25;

inline bool has_too_many_pixels(const Scanner& scanner) {
  return std::int64_t{scanner.width} * scanner.height > kPixelsMax;
}

}  // namespace tubebin::scene
