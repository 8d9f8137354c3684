/// A bin that nobody told of.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "modeling/input/flat_regions.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

/// The bin whose floor and four walls are among the regions; of several, that with the most of the points at `inside`
/// (indices) in it. Walls may lean by 15 degrees. None where floor or a wall is out of sight.
std::optional<BinFound> find_bin(const std::vector<FlatRegion>& regions, std::span<const cloud::Point> points,
                                 std::span<const std::uint32_t> inside);

}  // namespace tubebin::modeling
