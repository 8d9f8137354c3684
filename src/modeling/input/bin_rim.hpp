/// The upper sides of a bin's walls: mostly too narrow to be flat regions.
#pragma once

#include <span>
#include <vector>

#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

constexpr double kThickestWall = 0.03;  // metres

/// Those of `indices` whose points lie at the height of the bin's walls, each at its own, as far as `tolerance` (metres) lets
/// one tell, and no farther out than such points surround the bin: tubes that hang over it do not.
std::vector<std::uint32_t> points_on_rim(const BinFound& bin, std::span<const cloud::Point> points,
                                         std::span<const std::uint32_t> indices, double tolerance, double spacing);

}  // namespace tubebin::modeling
