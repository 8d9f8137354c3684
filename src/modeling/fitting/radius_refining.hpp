/// A radius as pieces of tube show it, from one that is a guess.
#pragma once

#include <vector>

#include "modeling/fitting/vote_curve.hpp"
#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {

/// As the longest round pieces of the cloud show it, metres; 0 where none is round. `occlusion`: of the guess.
double refined_radius(const FilteredCloud& cloud, double guess, const ViewProjection& projection,
                      const OcclusionTest& occlusion);

/// As the pieces along the longest of these curves show it that are round and long, metres; 0 where none is.
double radius_along(const std::vector<VoteCurve>& curves, const FilteredCloud& cloud, double guess,
                    const ViewProjection& projection, const OcclusionTest& occlusion);

}  // namespace tubebin::modeling
