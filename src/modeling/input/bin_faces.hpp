/// The bare parts of a bin's floor and walls: between the tubes on them too small to be flat regions of their own.
#pragma once

#include <span>
#include <vector>

#include "modeling/input/flat_regions.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

/// Those of `indices` whose points lie in the bin, or at most `margin` (metres) outside it, on the plane of its floor or of one of
/// its walls, as far as noise lets one tell. `regions`: of the scan.
std::vector<std::uint32_t> points_on_faces(const BinFound& bin, const std::vector<FlatRegion>& regions,
                                           std::span<const cloud::Point> points, std::span<const std::uint32_t> indices,
                                           double margin);

}  // namespace tubebin::modeling
