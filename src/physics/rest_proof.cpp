#include "physics/rest_proof.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin {
namespace {

/// Between starts that are followed; a proof is late by so much at most.
constexpr double kStartInterval = 0.05;  // seconds

}  // namespace

std::vector<Vec3> nodes_in_world(const std::vector<PlacedTube>& tubes) {
  std::vector<Vec3> nodes;
  for (const PlacedTube& tube : tubes)
    for (const Vec3& node : tube.tube.nodes) nodes.push_back(tube.world_from_tube * node);
  return nodes;
}

double largest_movement(const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
  double squared = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) squared = std::max(squared, (after[i] - before[i]).squaredNorm());
  return std::sqrt(squared);
}

void RestProof::observe(std::vector<Vec3> nodes, int step, bool may_start) {
  for (Start& start : starts_) start.drift = std::max(start.drift, largest_movement(start.nodes, nodes));
  std::erase_if(starts_, [&](const Start& start) { return start.drift > options_.drift_max; });
  if (!may_start || (!starts_.empty() && step - last_start_step_ < steps_in(kStartInterval, options_))) return;
  starts_.push_back({step, std::move(nodes)});
  last_start_step_ = step;
}

bool RestProof::is_complete(int step) const {
  return !starts_.empty() && step - starts_.front().step >= steps_in(options_.check_time, options_);
}

}  // namespace tubebin
