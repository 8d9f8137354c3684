#include "tubebin/physics/lift.hpp"

#include <algorithm>
#include <deque>
#include <limits>

#include "physics/rest_check.hpp"
#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"
#include "physics/settling.hpp"
#include "tubebin/scene/pile_relations.hpp"

namespace tubebin::physics {
namespace {

constexpr double kForceWindow = 0.1;    ///< seconds over which the force is averaged: a jerk is no pull
constexpr double kSpeedUpTime = 0.1;    ///< seconds from rest to full speed
constexpr double kLongStepSpeed = 0.2;  ///< m/s; a long step takes this less far than a short one what falls
constexpr double kAboveTheRim = 0.005;  ///< metres

/// The pile while one of its tubes is pulled up.
class Pull {
 public:
  Pull(const DropResult& pile, std::size_t tube, const scene::Bin& bin, const PhysicsOptions& options,
       const LiftOptions& lift)
      : tube_(tube),
        rim_(bin.height),
        options_(options),
        lift_(lift),
        world_(pile.tubes, bin, options, pile.forces ? *pile.forces : PileForces{}, pile.masses) {
    for (std::size_t i = 0; i < world_.size(); ++i) start_heights_.push_back(world_.center_of_mass(i).z());
    highest_ = start_heights_;
    world_.let_sleep_beyond(tube);
  }

  void pull_out() {
    for (double speed = 0.0; !is_out(); speed = lift_.speed * std::min(1.0, time_ / kSpeedUpTime)) {
      const double time_step = next_time_step();
      world_.pull(tube_, speed);
      world_.step(time_step);
      ++steps_;
      time_ += time_step;
      for (std::size_t i = 0; i < world_.size(); ++i) highest_[i] = std::max(highest_[i], world_.center_of_mass(i).z());
      add_force(world_.pulling_force(), time_step);
      if (!all_below(world_, options_.rest_speed, options_.rest_turn_rate, tube_)) last_fast_ = time_;
    }
  }

  /// Once it is out.
  LiftResult let_the_rest_settle(const scene::Bin& bin, std::uint64_t seed) && {
    const double weight = options_.gravity * world_.tubes()[tube_].tube.mass;  // which it goes on to hold
    LiftResult result{.rest = {}, .force = std::max({most_force_, mean_force(), weight}), .dragged = {}};
    for (std::size_t i = 0; i < world_.size(); ++i)
      if (i != tube_ && highest_[i] - start_heights_[i] > world_.tubes()[i].tube.radius_max())
        result.dragged.push_back(i < tube_ ? i : i - 1);
    world_.remove_pulled();
    Random random(seed);
    const Pace pace{.slow_for = time_ - last_fast_, .long_step_speed = kLongStepSpeed};
    result.rest = settle(std::move(world_), pace, bin, options_, random);
    result.rest.figures.steps += steps_;
    result.rest.figures.simulated_seconds += time_;
    return result;
  }

 private:
  /// Clear of all others and with nothing above it, or above the rim whatever hangs on it.
  bool is_out() const {
    if (steps_ == 0) return false;
    if (world_.bounds(tube_).min().z() > rim_ + kAboveTheRim) return true;
    return !world_.touches_another(tube_) && !scene::has_above(world_.tubes(), static_cast<std::uint32_t>(tube_ + 1));
  }

  /// The long one while all is slow.
  double next_time_step() const {
    const bool long_is_enough = lift_.speed <= kLongStepSpeed &&
                                all_below(world_, kLongStepSpeed, std::numeric_limits<double>::infinity(), tube_);
    return long_is_enough ? options_.rest_time_step : options_.time_step;
  }

  void add_force(double force, double seconds) {
    forces_.push_back({force, seconds});
    window_ += seconds;
    if (!have_passed(kForceWindow, 0.0, window_)) return;
    most_force_ = std::max(most_force_, mean_force());
    window_ -= forces_.front().seconds;
    forces_.pop_front();
  }

  double mean_force() const {
    double impulse = 0.0;
    for (const StepForce& step : forces_) impulse += step.force * step.seconds;
    return impulse / window_;
  }

  struct StepForce {
    double force = 0.0;  ///< N
    double seconds = 0.0;
  };

  std::size_t tube_;
  double rim_;
  const PhysicsOptions& options_;
  const LiftOptions& lift_;
  RigidWorld world_;
  int steps_ = 0;
  double time_ = 0.0;                                            ///< seconds
  double last_fast_ = -std::numeric_limits<double>::infinity();  ///< seconds, of the others; they were at rest
  std::vector<double> start_heights_, highest_;                  ///< metres, of the centres of mass
  std::deque<StepForce> forces_;                                 ///< of the last steps
  double window_ = 0.0;                                          ///< seconds, all theirs
  double most_force_ = 0.0;
};

}  // namespace

LiftResult lift_tube(const DropResult& pile, std::size_t tube, const scene::Bin& bin, const PhysicsOptions& options,
                     const LiftOptions& lift, std::uint64_t seed) {
  Pull pull(pile, tube, bin, options, lift);
  pull.pull_out();
  return std::move(pull).let_the_rest_settle(bin, seed);
}

}  // namespace tubebin::physics
