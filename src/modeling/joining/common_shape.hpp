/// The shape that a bin's tubes have in common where they are parts of one kind, bent alike.
#pragma once

#include <span>
#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// The centrelines, by samples every half radius, that many of the scene's tubes may have, the likeliest first, at most three:
/// those of `whole`, the centrelines of tubes in sight from end to end, that as much of the `pieces` lies on as makes two
/// tubes. They bend by at least two diameters, since straight tubes are all alike.
std::vector<std::vector<Vec3>> possible_shapes(std::span<const std::vector<Vec3>> whole,
                                               std::span<const TubePiece> pieces);

}  // namespace tubebin::modeling
