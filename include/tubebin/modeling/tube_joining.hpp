/// Joining of `--method centerline` (step 4 of the pipeline): pieces become tubes, all at once.
#pragma once

#include <vector>

#include "tubebin/modeling/join_candidates.hpp"

namespace tubebin {

struct Joining {
  std::vector<TubeModel> tubes;
  std::vector<std::uint32_t> tube_of_piece;
  double tube_length = 0.0;  ///< metres: as given, or the common length of the scene's tubes; 0 where there is none
};

/// Chooses the chains of pieces that explain the scan best: each piece in one tube, joins by their likelihood, tubes of
/// `tube_length` metres (0: the length that tubes with both ends in sight agree on, if they do) whose missing part
/// must find room where the scanner could not see.
Joining join_pieces(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion, double tube_length);

}  // namespace tubebin
