/// The shapes that a bin's tubes have in common where they are parts of one kind or of a few, bent alike.
#pragma once

#include <span>
#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// The shapes that many of the scene's tubes may have, by samples every half radius, the longest first, at most five: the
/// centrelines among `tubes`, as far as two of the `pieces` lie on them, that as much of the pieces lies on as makes a tube and a
/// half (one of them nearly two), and two fifths of those that are long enough to tell. They bend by at least two diameters, since
/// straight tubes are all alike.
std::vector<std::vector<Vec3>> possible_shapes(std::span<const std::vector<Vec3>> tubes,
                                               std::span<const TubePiece> pieces);

}  // namespace tubebin::modeling
