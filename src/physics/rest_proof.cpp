#include "physics/rest_proof.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::physics {
namespace {

/// Between starts that are followed; a proof is late by so much at most.
constexpr double kStartInterval = 0.05;  // seconds

}  // namespace

bool have_passed(double seconds, double since, double now) {
  constexpr double kRounding = 1e-9;  // seconds; times are sums of steps
  return now - since >= seconds - kRounding;
}

std::vector<Vec3> nodes_in_world(const std::vector<scene::PlacedTube>& tubes) {
  std::vector<Vec3> nodes;
  std::size_t count = 0;
  for (const scene::PlacedTube& tube : tubes) count += tube.tube.nodes.size();
  nodes.reserve(count);
  for (const scene::PlacedTube& tube : tubes)
    for (const Vec3& node : tube.tube.nodes) nodes.push_back(tube.world_from_tube * node);
  return nodes;
}

double largest_movement(const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
  double squared = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) squared = std::max(squared, (after[i] - before[i]).squaredNorm());
  return std::sqrt(squared);
}

void RestProof::observe(std::vector<Vec3> nodes, double time, bool may_start) {
  for (Start& start : starts_) start.drift = std::max(start.drift, largest_movement(start.nodes, nodes));
  std::erase_if(starts_, [&](const Start& start) { return start.drift > options_.drift_max; });
  if (!may_start || (!starts_.empty() && !have_passed(kStartInterval, *last_start_, time))) return;
  starts_.push_back({time, std::move(nodes)});
  last_start_ = time;
}

bool RestProof::is_complete(double time) const {
  return !starts_.empty() && have_passed(options_.check_time, starts_.front().time, time);
}

}  // namespace tubebin::physics
