/// Where tubes branch: paths that hang together are one tube.
#pragma once

#include <vector>

#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// The tubes, as sets of paths, that explain the scan best: links (branch_links.hpp) by their likelihood, and the length
/// of all paths together as common to the scene's tubes as `tube_length` says (metres; 0: what those in sight agree on,
/// if they do). Each branch is led up to the centreline that it branches off.
std::vector<TubeModel> join_branches(const std::vector<TubePath>& paths, double radius, const OcclusionTest& occlusion,
                                     double tube_length);

/// The same where few tubes branch or none: paths that surely start on another's side (find_sure_links), where that one is
/// in sight, are branches of it, and all others tubes by themselves.
std::vector<TubeModel> join_sure_branches(const std::vector<TubePath>& paths, double radius, double tube_length);

}  // namespace tubebin::modeling
