/// What of the scan stands around the tubes.
#pragma once

#include <cstdint>
#include <vector>

#include "modeling/input/flat_regions.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/modeling_input.hpp"

namespace tubebin::modeling {

struct Background {
  std::vector<FlatRegion> regions;        ///< largest first
  std::vector<std::uint32_t> set_aside;   ///< indices of the points that lie on them
  std::vector<std::uint32_t> foreground;  ///< indices of all other finite points
  bool is_known = false;                  ///< of a known bin: what is left is tubes, as far as anybody knows
  double noise = 0.0;                     ///< metres, across the largest regions; 0 where there is none
  double spacing = 0.0;                   ///< metres between neighbouring points at their median range
  bool is_rough = false;                  ///< some of the ground, as the search for radii finds it
  bool is_noisy = false;                  ///< the scan, or one of its views, as is_noisy() has it
};

/// Flat regions of any pose, and the points on them. What lies on a tube and by chance in a region's plane is set aside
/// too: a narrow strip of the tube.
Background find_background(const ModelingInput& input, const ViewProjection& projection);

/// The same of a part of the points alone: `finite` are the indices of points that are.
Background find_background(const ModelingInput& input, const ViewProjection& projection,
                           const std::vector<std::uint32_t>& finite);

/// As the known bin has it (crop_bin), without looking for regions.
Background background_of_bin(const ModelingInput& input, const ViewProjection& projection,
                             const FilteringOptions& options);

/// Those of the points that are farther than `margin` (metres) from the known bin, seen from above.
std::vector<std::uint32_t> beside_bin(const ModelingInput& input, const std::vector<std::uint32_t>& indices,
                                      double margin);

/// Regions with nothing behind them.
std::vector<FlatRegion> solids_of(const Background& background);

}  // namespace tubebin::modeling
