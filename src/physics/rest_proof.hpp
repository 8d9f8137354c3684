/// The proof that a pile is at rest: nothing moves while the simulation runs on.
#pragma once

#include <optional>
#include <vector>

#include "physics/rigid_world.hpp"

namespace tubebin::physics {

/// Whether `seconds` have passed between two moments, up to the rounding of a sum of steps. All of simulated time.
bool have_passed(double seconds, double since, double now);

/// Every tube's nodes, one after another.
std::vector<Vec3> nodes_in_world(const std::vector<scene::PlacedTube>& tubes);

/// Farthest that any node moved between two moments of the same tubes, metres.
double largest_movement(const std::vector<Vec3>& before, const std::vector<Vec3>& after);

/// Looks for check_time in which no node is ever farther than drift_max from where it was at its start. Many starts are
/// followed at once, so that a pile that creeps to its rest is proven as early as it can be.
class RestProof {
 public:
  explicit RestProof(const PhysicsOptions& options) : options_(options) {}

  /// Where all nodes are at a `time` (seconds); `may_start`: all tubes have been slow for the rest window.
  void observe(std::vector<Vec3> nodes, double time, bool may_start);

  bool has_started() const { return last_start_.has_value(); }
  bool is_under_way() const { return !starts_.empty(); }
  bool is_complete(double time) const;
  /// Metres; in the time that proves it, once it is complete.
  double drift() const { return starts_.front().drift; }

 private:
  struct Start {
    double time = 0.0;  ///< seconds
    std::vector<Vec3> nodes;
    double drift = 0.0;  ///< metres, the largest since then
  };

  const PhysicsOptions& options_;
  std::vector<Start> starts_;         ///< in order; none has drifted too far yet
  std::optional<double> last_start_;  ///< seconds
};

}  // namespace tubebin::physics
