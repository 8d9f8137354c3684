/// Pieces and the joins between their ends: what chains are made of.
#pragma once

#include <span>
#include <vector>

#include "modeling/joining/join_candidates.hpp"

namespace tubebin::modeling {

struct PieceGraph {
  PieceGraph(std::span<const TubePiece> pieces, std::span<const PieceEnd> ends, std::vector<JoinCandidate> joins);

  std::span<const TubePiece> pieces;
  std::span<const PieceEnd> ends;  ///< numbered as PieceEnd says
  std::vector<JoinCandidate> joins;

  std::vector<double> piece_lengths;   ///< metres
  std::vector<double> bridge_lengths;  ///< of the joins, metres
  std::vector<std::vector<std::uint32_t>> joins_of_end;
  std::vector<std::vector<std::uint32_t>> collisions;  ///< of each join: those whose bridges take up the same place
};

}  // namespace tubebin::modeling
