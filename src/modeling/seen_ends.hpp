/// Ends of tubes beyond what cylinders were fitted to.
#pragma once

#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Lengthens paths along their axes to where points without a label show their ends:
/// - Of an end that points at the scanner, little of the side is seen, and cylinders stop short of it. The points go on
///   without a gap, are a quarter of an end or more, and end within two and a half radii: what goes on farther, or is
///   narrower, is another thing.
/// - What hides a tube near its end may leave a bit of it that is too short to be known for a tube. It lies on the tube's
///   side, where that has to go on for one of `lengths` (metres, ascending), and nothing else does.
/// `spacing`: metres between neighbouring points. True if any path changed.
bool reach_seen_ends(std::vector<TubeModel>& tubes, std::span<const cloud::Point> points,
                     std::span<const cloud::Label> labels, double spacing, const std::vector<double>& lengths);

}  // namespace tubebin::modeling
