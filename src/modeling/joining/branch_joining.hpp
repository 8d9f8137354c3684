/// Where tubes branch: paths that hang together are one tube.
#pragma once

#include <vector>

#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct BranchedTubes {
  std::vector<TubeModel> tubes;
  double tube_length = 0.0;  ///< metres, that trees have in common: as given, or as found; 0 where there is none
};

/// The tubes, as sets of paths, that explain the scan best: links (branch_links.hpp) by their likelihood, and the length
/// of all paths together as common to the scene's tubes as `tube_length` says (metres; 0: what explains the scan better than
/// tubes of any length, if anything does; else a path of the longest length that recurs is whole). Each branch is led up to
/// the centreline that it branches off.
BranchedTubes join_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion,
                            double tube_length);

/// The same where few tubes branch or none: the paths that start at another's side likelier than not are branches. A path as
/// long as the tubes have in common (`tube_length`, metres; 0: the longest length that recurs) is whole, neither a branch nor
/// a trunk. No tube becomes longer, nor than the `longest` path of the scene (metres), but for what surely branches where no
/// length is told.
BranchedTubes join_likely_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion,
                                   double tube_length, double longest);

}  // namespace tubebin::modeling
