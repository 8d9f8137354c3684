/// Time per test case by number of tubes, in the form of the paper's Table 1 and beside its figures.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tubebin/dataset/manifest.hpp"
#include "tubebin/dataset/scene_id.hpp"

namespace tubebin::dataset {

/// Seconds a test case, by number of tubes.
using SecondsByTubes = std::map<int, double>;

/// Means over those of the scenes that the manifest records, beside the paper's for that set; empty where it records none.
/// Previews, which the paper does not make, have a column of their own where there are any.
std::string format_timing_table(const Manifest& manifest, const std::vector<SceneId>& scenes,
                                const SecondsByTubes& paper_seconds);

}  // namespace tubebin::dataset
