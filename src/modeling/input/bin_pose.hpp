/// Where a known bin stands.
#pragma once

#include <optional>
#include <vector>

#include "modeling/input/flat_regions.hpp"
#include "tubebin/modeling/modeling_input.hpp"

namespace tubebin::modeling {

/// Whether the cloud shows floor and walls where the input says that its bin has them, within `tolerance` metres, as far
/// as it shows them at all. A look at a sample, which costs next to nothing.
bool bin_is_in_place(const ModelingInput& input, double tolerance);

/// The pose (world_from_bin) that puts the input's bin onto flat regions of the cloud, from the told one, which may be off
/// by 30 mm and 10 degrees, and its other faces onto the layers of points beside them. None where no region is one of its faces.
std::optional<Pose> refined_bin_pose(const ModelingInput& input, const std::vector<FlatRegion>& regions);

}  // namespace tubebin::modeling
