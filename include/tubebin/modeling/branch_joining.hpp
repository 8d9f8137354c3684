/// Where tubes branch: paths that start on another path's side are one tube with it.
#pragma once

#include <optional>
#include <vector>

#include "tubebin/modeling/occlusion.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin {

/// Where a path that ends at `tip`, leading `outward` (unit), meets the path through `nodes` as a branch does: it ends
/// nearer to that one's centreline than a radius, where no other tube's end can be, and leads to it. Not so near the
/// other path's own ends, where one may go on as the other.
std::optional<Vec3> place_on_side(const Vec3& tip, const Vec3& outward, const std::vector<Vec3>& nodes, double radius);

/// Tubes of the paths: those that branch off one another together, each branch led up to the centreline that it
/// branches off. Ends that vanish behind something on their straight way to another path's side, within six radii, are
/// branches too.
std::vector<TubeModel> join_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion);

/// One tube for each path.
std::vector<TubeModel> unbranched(std::vector<TubePath> paths, double radius);

}  // namespace tubebin
