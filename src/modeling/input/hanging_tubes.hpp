/// Tubes that hang over the walls of a known bin.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

/// Those of the points `beside` a bin that hang together with points over its `walls`, over gaps of four spacings at most.
/// Indices of finite points, ascending; `spacing` in metres.
std::vector<std::uint32_t> hanging_over(std::span<const cloud::Point> points, std::span<const std::uint32_t> walls,
                                        std::span<const std::uint32_t> beside, double spacing);

}  // namespace tubebin::modeling
