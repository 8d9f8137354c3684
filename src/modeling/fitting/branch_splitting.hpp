/// Segments that branch, taken apart into segments that do not.
#pragma once

#include <vector>

#include "modeling/fitting/vote_graph.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A segment that does not branch.
struct Stretch {
  Segment segment;
  VoteGraph graph;
};

/// The votes of a branching tube hang together (segment_by_votes), and so may those of tubes that meet where normals
/// mix. The longest way through a segment's votes is one stretch of tube; what lies off it and is long enough to be
/// another stretch is a segment of its own, taken apart in the same way. A way that turns back is two stretches too. A
/// segment without branches stays whole.
std::vector<Stretch> split_branches(const FilteredCloud& cloud, const Segment& segment, double radius);

}  // namespace tubebin::modeling
