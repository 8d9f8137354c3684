/// Which ends of which pieces may belong together across an occlusion, and how likely that is.
#pragma once

#include <vector>

#include "modeling/joining/length_model.hpp"
#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A piece shorter than it is wide: its direction is a guess, and it may be a bit of a longer one.
bool is_fragment(const TubePiece& piece);

/// One end of a piece. End 2 k is the first node of piece k, end 2 k + 1 its last.
struct PieceEnd {
  Vec3 position = Vec3::Zero();     ///< metres
  Vec3 outward = Vec3::Zero();      ///< unit, along the last cylinder
  bool is_of_fragment = false;      ///< of a piece that is one
  double direction_variance = 0.0;  ///< of `outward`, rad^2 an axis
  double seen_free = 0.0;           ///< part of the place just beyond it that the scanner saw to be empty
  bool is_on_side = false;          ///< of another piece: a branch starts here
  double hidden_reach = 0.0;        ///< how far the tube could go on unseen, metres
};

/// Two ends that could belong together by their places and directions, and by what the scan shows just beyond them.
struct PossibleJoin {
  std::uint32_t end_a = 0, end_b = 0;  ///< end_a < end_b, of different pieces
  double cost = 0.0;                   ///< nats: -log of how much likelier it is that they do
  double gap = 0.0;                    ///< metres, straight from end to end
  double length = 0.0;                 ///< metres, of the two pieces and the gap
};

/// Two ends joined by a bridge that the scanner could not see.
struct JoinCandidate {
  std::uint32_t end_a = 0, end_b = 0;   ///< as in PossibleJoin
  double cost = 0.0;                    ///< nats: -log of how much likelier the scan is with the join than without
  std::vector<Vec3> bridge;             ///< its centreline, from end_a's position to end_b's
  std::vector<std::uint32_t> absorbed;  ///< fragments that lie on it, which the join explains
};

/// How tubes of the scene bend, as its pieces show: the variance of their direction grows by this much a metre along
/// the tube, rad^2/m an axis.
double estimate_bending_rate(const std::vector<TubePiece>& pieces, double radius);

std::vector<PieceEnd> find_piece_ends(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion,
                                      double reach_limit);

/// The pairs that cost less than `cost_limit`.
std::vector<PossibleJoin> find_possible_joins(const std::vector<TubePiece>& pieces, const std::vector<PieceEnd>& ends,
                                              const OcclusionTest& occlusion, double bending_rate, double cost_limit);

struct JoinLimits {
  double cost = 0.0;      ///< nats, of a join that no common length speaks for
  LengthModel lengths{};  ///< of two pieces and their bridge together
  std::size_t joins_per_end = 0;
  /// Of each end, metres, of the chain that it is an end of; infinite where of none. Empty: no chains are known.
  std::vector<double> chain_lengths{};
};

/// The pairs whose join the scan does not rule out, cheapest first: of each end its `joins_per_end` cheapest,
/// and those that are among the other end's. Where a join makes one tube of two chains, the common length speaks for it.
std::vector<JoinCandidate> find_join_candidates(const std::vector<TubePiece>& pieces, const std::vector<PieceEnd>& ends,
                                                const std::vector<PossibleJoin>& pairs, const OcclusionTest& occlusion,
                                                double bending_rate, const JoinLimits& limits);

}  // namespace tubebin::modeling
