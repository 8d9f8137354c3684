/// Pieces that are cut into parts.
#pragma once

#include <span>
#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Gives each point of the piece to the part that is nearest to it, of several the first. `points`: of the cloud that the piece's
/// are numbered in.
void share_points(const TubePiece& piece, std::span<const cloud::Point> points, std::vector<TubePiece>& parts);

}  // namespace tubebin::modeling
