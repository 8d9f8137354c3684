/// Segmentation of `--method centerline` (step 2 of the pipeline).
#pragma once

#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A surface point p with outward normal n on a tube of radius r lies at p - r n on its centreline. Centrelines of
/// different tubes are never closer than 2 r (r, where an end meets another tube), so these votes, gathered in voxels
/// and linked over short gaps, separate tubes that touch and cross. Each segment is a stretch of one tube's surface
/// between occlusions. Points without a normal belong to none,
/// nor do votes that few others share.
std::vector<Segment> segment_by_votes(const FilteredCloud& cloud, double radius);

}  // namespace tubebin::modeling
