/// What of a piece is tube where all of it is not.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A tube that touches a rim or an edge is fitted as one with it: the runs of stretches, four radii each, that `is_tube` holds
/// for, but for those shorter than two stretches. `points`: of the cloud that the piece's are numbered in.
std::vector<TubePiece> tube_stretches(const TubePiece& piece, std::span<const cloud::Point> points,
                                      const std::function<bool(const TubePiece&)>& is_tube);

}  // namespace tubebin::modeling
