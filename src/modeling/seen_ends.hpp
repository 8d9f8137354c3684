/// Ends of tubes that point at the scanner: it sees little of their sides, and fitted cylinders stop short of them.
#pragma once

#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Lengthens paths along their axes as far as points without a label go on without a gap, where they are a quarter of an end
/// or more, and that is less than two and a half radii: what goes on farther, or is narrower, is another thing. `spacing`:
/// metres between neighbouring points. True if any path changed.
bool reach_seen_ends(std::vector<TubeModel>& tubes, std::span<const cloud::Point> points,
                     std::span<const cloud::Label> labels, double spacing);

}  // namespace tubebin::modeling
