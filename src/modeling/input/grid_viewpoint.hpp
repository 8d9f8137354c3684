/// Where the scanner of an organized cloud stood.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

/// Where a pinhole camera stands that sees the points, in rows of `width`, each in its pixel; metres. Nothing where they
/// do not say: too few, all in one plane, or no such camera's. Noise along the rays does not matter.
std::optional<Vec3> viewpoint_of_grid(std::span<const cloud::Point> points, std::uint32_t width);

}  // namespace tubebin::modeling
