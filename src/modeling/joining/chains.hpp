/// Chains of pieces: the tubes that the scene may have.
#pragma once

#include <vector>

#include "modeling/joining/length_model.hpp"
#include "modeling/joining/path_cover.hpp"
#include "modeling/joining/piece_graph.hpp"

namespace tubebin::modeling {

/// -log of the share of tube ends that happen to lie hidden in a pile: about a third.
constexpr double kHiddenEndCost = 1.0;

/// Enters its last piece at one end and may leave it by the other.
struct Chain {
  PathCandidate path;  ///< its items: the pieces in order, each followed by the fragments absorbed on the way
                       ///< to it; its places: the joins
  PathNumbers pieces;
  std::uint32_t first_end = 0;  ///< where the tube starts
  std::uint32_t last_end = 0;   ///< where it ends so far
  std::uint64_t key = 0;        ///< the items' keys, xor: the same for the same items in any order (Zobrist 1970)
  double join_cost = 0.0;
  double length = 0.0;       ///< of pieces and bridges, metres
  double bridged = 0.0;      ///< of bridges alone, metres
  double room = 0.0;         ///< that it may go on unseen at its ends, metres
  double length_cost = 0.0;  ///< what its length adds to the path's cost
};

/// All chains that may be in the best cover of the pieces, with their costs.
std::vector<Chain> find_chains(const PieceGraph& graph, const LengthModel& lengths);

/// The chain's pieces and bridges in a row.
TubePath path_of(const Chain& chain, const PieceGraph& graph);

}  // namespace tubebin::modeling
