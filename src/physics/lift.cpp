#include "tubebin/physics/lift.hpp"

#include <algorithm>
#include <deque>
#include <numeric>

#include "physics/rigid_world.hpp"
#include "physics/settling.hpp"
#include "tubebin/scene/pile_relations.hpp"

namespace tubebin::physics {
namespace {

constexpr double kForceWindow = 0.1;    ///< seconds over which the force is averaged: a jerk is no pull
constexpr double kSpeedUpTime = 0.1;    ///< seconds from rest to full speed
constexpr double kAboveTheRim = 0.005;  ///< metres

/// The pile while one of its tubes is pulled up.
class Pull {
 public:
  Pull(const std::vector<scene::PlacedTube>& pile, std::size_t tube, const scene::Bin& bin,
       const PhysicsOptions& options, const LiftOptions& lift)
      : tube_(tube), rim_(bin.height), options_(options), lift_(lift), world_(pile, bin, options) {
    for (std::size_t i = 0; i < world_.size(); ++i) start_heights_.push_back(world_.center_of_mass(i).z());
    highest_ = start_heights_;
  }

  void pull_out() {
    for (double time = 0.0; !is_out(); time += options_.time_step) {
      world_.pull(tube_, lift_.speed * std::min(1.0, time / kSpeedUpTime));
      world_.step(options_.time_step);
      ++steps_;
      for (std::size_t i = 0; i < world_.size(); ++i) highest_[i] = std::max(highest_[i], world_.center_of_mass(i).z());
      add_force(world_.pulling_force());
    }
  }

  LiftResult result(const scene::Bin& bin, std::uint64_t seed) const {
    std::vector<scene::PlacedTube> left = world_.tubes();
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(tube_));
    Random random(seed);
    LiftResult result{
        .rest = settle(left, bin, options_, random), .force = std::max(most_force_, mean_force()), .dragged = {}};
    result.rest.figures.steps += steps_;
    result.rest.figures.simulated_seconds += steps_ * options_.time_step;
    for (std::size_t i = 0; i < world_.size(); ++i)
      if (i != tube_ && highest_[i] - start_heights_[i] > world_.tubes()[i].tube.radius_max())
        result.dragged.push_back(i < tube_ ? i : i - 1);
    return result;
  }

 private:
  /// Clear of all others and with nothing above it, or above the rim whatever hangs on it.
  bool is_out() const {
    if (steps_ == 0) return false;
    if (CollisionTube(world_.tubes()[tube_]).bounds.min().z() > rim_ + kAboveTheRim) return true;
    return !world_.touches_another(tube_) && is_free_above();
  }

  bool is_free_above() const {
    const auto lower = static_cast<std::uint32_t>(tube_ + 1);
    return std::ranges::none_of(scene::find_above(world_.tubes()),
                                [&](const scene::Above& pair) { return pair.lower == lower; });
  }

  void add_force(double force) {
    forces_.push_back(force);
    if (static_cast<double>(forces_.size()) * options_.time_step <= kForceWindow) return;
    forces_.pop_front();
    most_force_ = std::max(most_force_, mean_force());
  }

  double mean_force() const {
    return std::accumulate(forces_.begin(), forces_.end(), 0.0) / static_cast<double>(forces_.size());
  }

  std::size_t tube_;
  double rim_;
  const PhysicsOptions& options_;
  const LiftOptions& lift_;
  RigidWorld world_;
  int steps_ = 0;
  std::vector<double> start_heights_, highest_;  ///< metres, of the centres of mass
  std::deque<double> forces_;
  double most_force_ = 0.0;
};

}  // namespace

LiftResult lift_tube(const std::vector<scene::PlacedTube>& pile, std::size_t tube, const scene::Bin& bin,
                     const PhysicsOptions& options, const LiftOptions& lift, std::uint64_t seed) {
  Pull pull(pile, tube, bin, options, lift);
  pull.pull_out();
  return pull.result(bin, seed);
}

}  // namespace tubebin::physics
