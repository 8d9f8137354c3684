/// Segmentation and cylinder fitting of `--method region_growing`: the paper's steps 2 and 3. Regions and cylinders
/// are those that PCL's RegionGrowing and SACSegmentationFromNormals find, which the tests hold them to.
#pragma once

#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct RegionGrowingOptions {
  int neighbors = 20;             ///< of a point, for growing
  double smoothness_deg = 12.0;   ///< between neighbours' normals in one region, a cylinder's and its points'
  int region_size_min = 20;       ///< points
  int ransac_iterations = 100;    ///< a cylinder
  double inlier_distance = 0.15;  ///< of the radius: how far a cylinder's points may be off its surface
};

void describe(Fields& fields, RegionGrowingOptions& options);

/// Piecewise smooth regions, by growing from point to neighbour while the normals turn little (Rabbani 2006).
std::vector<Segment> grow_regions(const FilteredCloud& cloud, const RegionGrowingOptions& options);

/// Cylinders that RANSAC finds in the segment, one after the other in what is left of it, until too few points are.
/// A piece has one cylinder.
std::vector<TubePiece> fit_cylinders(const FilteredCloud& cloud, const Segment& segment, double radius,
                                     const RegionGrowingOptions& options);

}  // namespace tubebin::modeling
