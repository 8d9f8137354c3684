/// Joining of tubes that are bent alike: the pieces that one copy of their shape explains are one tube's.
#pragma once

#include <span>
#include <vector>

#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct ShapeJoining {
  std::vector<TubePath> paths;  ///< of the copies: what pieces show of them, and their own course between, bridged
  std::vector<TubePiece> rest;  ///< what no copy explains
  double explained = 0.0;       ///< part of the pieces' length that the copies explain
  double whole_bends = 0.0;     ///< part of the pieces' sharp bends both sides of which are in one copy; 1 without any
  double cost = 0.0;            ///< nats: -log of the scene's likelihood, but for what is the same for any shape
  double tube_length = 0.0;     ///< of the shape, metres; 0 where there are several
};

/// Chooses the copies of `shapes`, centrelines by samples every half radius, that explain the pieces best: each piece, or its
/// part between two sharp bends, in one copy.
ShapeJoining join_by_shapes(const std::vector<TubePiece>& pieces, std::span<const std::vector<Vec3>> shapes,
                            const OcclusionTest& occlusion);

}  // namespace tubebin::modeling
