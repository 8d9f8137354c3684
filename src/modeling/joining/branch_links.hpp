/// Which paths of a branching tube may hang together, and how likely that is.
#pragma once

#include <optional>
#include <vector>

#include "modeling/joining/join_candidates.hpp"

namespace tubebin::modeling {

/// nats: an end on another tube's side is a branch but once in e^5, where a piece is cut short.
constexpr double kOnSideCost = -5.0;

/// An end of one path leads to another path. Ends are numbered as in find_piece_ends.
struct BranchLink {
  std::uint32_t end = 0;
  std::uint32_t other = 0;  ///< path that it leads to
  std::optional<std::uint32_t> other_end =
      {};                       ///< where it goes on as that path; else it branches off that path's side
  Vec3 place = Vec3::Zero();    ///< where it meets the other path, or that path's way straight on out of sight, metres
  Vec3 on_path = Vec3::Zero();  ///< the same place, or the end that the way straight on leads from
  double length = 0.0;          ///< from the end to the place, metres
  double cost = 0.0;            ///< nats: -log of how much likelier the scan is with the link than without
};

/// Where a path that ends at `tip`, leading `outward` (unit), meets the path through `nodes` as a branch does: it ends
/// nearer to that one's centreline than a radius, where no other tube's end can be, and leads to it. Not so near the
/// other path's own ends, where one may go on as the other.
std::optional<Vec3> place_on_side(const Vec3& tip, const Vec3& outward, const std::vector<Vec3>& nodes, double radius);

/// As long as two diameters, longer than the bits of surface beside bends.
bool is_long(const TubePiece& piece);

/// Whether the ends are as near and as opposite as those of a tube on either side of another that it runs across.
bool faces(const PieceEnd& a, const PieceEnd& b, double radius);

/// Whether pieces show that the scene's tubes branch: but for one of them, more than one in a hundred is long and meets another's
/// side, and none goes on across it. Of chance one in some thousand does.
bool show_branches(const std::vector<TubePiece>& pieces, const std::vector<PieceEnd>& ends);

/// The links that the evidence does not rule out (cost below `cost_limit`), cheapest first.
std::vector<BranchLink> find_branch_links(const std::vector<TubePiece>& paths, const std::vector<PieceEnd>& ends,
                                          const OcclusionTest& occlusion, double cost_limit);

}  // namespace tubebin::modeling
