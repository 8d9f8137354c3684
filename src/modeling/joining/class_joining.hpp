/// Step 4 of `--method centerline`: the tubes of each radius, with their branches.
#pragma once

#include <vector>

#include "modeling/fitting/tube_classes.hpp"
#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

/// Joins each class by itself. `result` gets the lengths that tubes have in common, and a doubt where shapes that are told
/// explain little.
std::vector<TubeModel> join_classes(const std::vector<TubeClass>& classes, const OcclusionTest& scan,
                                    const ModelingOptions& options, ModelingResult& result);

}  // namespace tubebin::modeling
