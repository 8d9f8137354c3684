/// Floor and walls of an unknown bin.
#pragma once

#include <vector>

#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {

/// A plane, its unit normal toward the inside of the bin: points p on it have normal . p = offset (metres).
struct BinPlane {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0.0;

  double height(const Vec3& p) const { return normal.dot(p) - offset; }
};

/// The floor (the plane of most points that has next to none behind it, seen from the scanner) and the walls (planes
/// across the floor with next to no points behind them), by RANSAC on a sample. None where nothing is flat and large.
std::vector<BinPlane> find_bin_planes(const ModelingInput& input, const ViewProjection& projection, double tolerance,
                                      std::uint64_t seed);

/// Indices of the finite points that lie more than the margin inside all planes that were found.
std::vector<std::uint32_t> crop_planes(const ModelingInput& input, const ViewProjection& projection,
                                       const FilteringOptions& options, std::uint64_t seed);

}  // namespace tubebin::modeling
