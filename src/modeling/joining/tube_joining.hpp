/// Joining of `--method centerline` (step 4 of the pipeline): pieces become tubes, all at once.
#pragma once

#include <span>
#include <vector>

#include "modeling/joining/join_candidates.hpp"

namespace tubebin::modeling {

struct Joining {
  std::vector<TubePath> paths;
  std::vector<double> lengths;  ///< metres, that tubes have in common: as given, or as found; none where there is none
  bool tubes_branch = false;    ///< enough pieces start on another's side (show_branches)
  bool are_copies = false;      ///< of shapes, whose lengths these are
  double explained = 0.0;       ///< part of the pieces' length on copies
};

/// Chooses the chains of pieces that explain the scan best: each piece in one tube, joins by their likelihood, tubes of
/// `tube_length` metres (0: one that explains the scan better than any lengths do, if there is one) whose missing part
/// must find room where the scanner could not see. An end on another piece's side (branch_joining.hpp) is no end that a
/// chain could go on from. Where most tubes turn out to be bent alike (common_shape.hpp), in one way or a few, copies of these
/// shapes take up the pieces first, unless `tries_shape` is false, and chains what the copies leave.
Joining join_pieces(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion, double tube_length,
                    bool tries_shape = true);

/// The same where the kinds of part are known: copies of their centrelines take up the pieces that they explain, and chains
/// the rest.
Joining join_pieces_by_shapes(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion,
                              std::span<const std::vector<Vec3>> centerlines);

}  // namespace tubebin::modeling
