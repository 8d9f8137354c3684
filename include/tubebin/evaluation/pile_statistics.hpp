/// What a pile of tubes looks like, in a few numbers: to compare piles of different origin.
#pragma once

#include <vector>

#include "tubebin/evaluation/table.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::evaluation {

/// Surfaces of two tubes that are nearer than this touch, metres: more than any simulation leaves between
/// bodies at rest, and a hundredth of a tube's width.
constexpr double kTouchingGap = 0.00025;

struct PileStatistics {
  double mean_height = 0.0;     ///< of the centrelines above the floor, metres
  double top_height = 0.0;      ///< of the highest surface above the floor, metres
  double mean_tilt_deg = 0.0;   ///< of the cylinders against the horizontal, weighted by length, degrees
  double spread = 0.0;          ///< root mean square horizontal distance of the centrelines from their middle, metres
  double contacts = 0.0;        ///< other tubes that a tube touches, mean over the tubes
  double penetration = 0.0;     ///< deepest, of tubes into each other and into the floor, metres
  double visible_points = 0.0;  ///< points of a tube in the scanner's image, mean over the tubes
  double visible_share = 0.0;   ///< of the centrelines (docs/metrics.md), mean over the tubes
};

/// Where the closest points of two tubes include a free end, whose flat face the distance of axes does not
/// describe, they count neither as a contact nor as a penetration. `tube_pixels` as in SceneRecord.
PileStatistics pile_statistics(const scene::Scene& scene, const std::vector<std::size_t>& tube_pixels);

/// Piles of one set and number of tubes from two sources.
struct PileComparison {
  std::string name;  ///< "A10"
  std::vector<PileStatistics> published;
  std::vector<PileStatistics> here;
};

/// A row a name and statistic: the published piles' mean beside ours with our 5th and 95th percentiles, and
/// how many of the published piles lie between those.
Table pile_table(const std::vector<PileComparison>& comparisons);

}  // namespace tubebin::evaluation
