/// Steps 2 and 3 of `--method centerline`, in two rounds: what the first round's pieces leave unexplained (slivers
/// beside occluders, stretches at crossings) gets normals of its own, unmixed with its neighbours', and makes the
/// second's.
#pragma once

#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// The first round's.
std::vector<TubePiece> fit_segments(const FilteredCloud& cloud, const std::vector<Segment>& segments,
                                    const ViewProjection& projection, double radius);

/// Both rounds'.
std::vector<TubePiece> find_centerline_pieces(const FilteredCloud& cloud, const std::vector<Segment>& segments,
                                              const ViewProjection& projection, double radius);

}  // namespace tubebin::modeling
