/// Scans whose noise is as wide as their points lie apart, as cameras for depth have it, smoothed.
#pragma once

#include <vector>

#include "modeling/input/flat_blocks.hpp"
#include "tubebin/modeling/modeling_input.hpp"

namespace tubebin::modeling {

/// Whether noise that neighbours do not share hides what is round: more than a few tenths of the points' spacing, as the blocks
/// of the view show it.
bool is_noisy(const SourceView& view, const FlatBlocks& blocks);

struct SmoothedScan {
  std::vector<cloud::Point> points;  ///< metres, world frame; in the scan's order
  double noise = 0.0;                ///< metres, standard deviation in the noisiest of these views; 0: none is noisy
};

/// Moves each point of the views that are noisy along its ray, to the plane of least squares through what lies about it (local
/// regression, Cleveland 1979), in a ball that takes in the noise. What is farther off is another surface. A point that lies
/// alone stays, as do those that are not finite. `first`: the projection of the first scanner.
SmoothedScan smoothed_scan(const ModelingInput& input, const ViewProjection& first);

}  // namespace tubebin::modeling
