/// Segments that branch, taken apart into segments that do not.
#pragma once

#include <vector>

#include "modeling/fitting/vote_graph.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A segment, mostly one that does not branch.
struct Stretch {
  Segment segment;
  VoteGraph graph;
};

/// A segment with branches, by its longest way.
struct Split {
  Stretch longest;
  std::vector<Stretch> others;  ///< each may branch
};

/// The votes of a branching tube hang together (segment_by_votes), and so may those of tubes that meet where normals
/// mix. The longest way through a segment's votes is one stretch of tube; what lies off it and is long enough to be
/// another stretch is a segment of its own. A way that turns back is two stretches too. A segment without branches stays whole.
Split split_off_longest(Stretch whole, double radius);

/// All stretches: what split_off_longest leaves is taken apart in the same way.
std::vector<Stretch> split_branches(const FilteredCloud& cloud, const Segment& segment, double radius);

}  // namespace tubebin::modeling
