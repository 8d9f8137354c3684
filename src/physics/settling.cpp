#include "physics/settling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/rest_check.hpp"
#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"
#include "physics/spawn.hpp"

namespace tubebin::physics {
namespace {

/// Bodies at rest may be this far apart and still count as touching: twice what the contact layer leaves.
constexpr double kTouchingGap = 0.0002;  // metres

DropResult failed(DropFailure failure, std::string detail, DropFigures figures = {}) {
  DropResult result;
  result.failure = failure;
  result.detail = std::move(detail);
  result.figures = figures;
  return result;
}

/// Tubes that come to rest, while they do.
class Settling {
 public:
  Settling(RigidWorld world, const Pace& pace, const scene::Bin& bin, const PhysicsOptions& options, Random& random)
      : long_step_speed_(pace.long_step_speed),
        bin_(bin),
        options_(options),
        random_(random),
        world_(std::move(world)),
        proof_(options),
        last_fast_(-pace.slow_for) {
    const double top = top_of(world_.tubes());
    if (options.spill == Spill::guard) world_.raise_guards(top);
    wait_for_a_fall_from(top);
  }

  /// Steps until the pile is proven to be at rest. Why it is not, else.
  DropFailure settle() {
    while (!proof_.is_complete(time_)) {
      if (time_ >= deadline_) return proof_.has_started() ? DropFailure::drift : DropFailure::unsettled;
      if (const auto tube = find_outside(world_, bin_); tube && !drop_again(*tube)) return DropFailure::outside;
      step();
    }
    figures_.largest_drift = proof_.drift();
    return DropFailure::none;
  }

  const RigidWorld& world() const { return world_; }
  const DropFigures& figures() const { return figures_; }

 private:
  void step() {
    const bool long_is_enough = have_passed(options_.rest_window, last_fast_, time_) ||
                                all_below(world_, long_step_speed_, std::numeric_limits<double>::infinity());
    const double time_step = long_is_enough ? options_.rest_time_step : options_.time_step;
    world_.step(time_step);
    ++figures_.steps;
    time_ = figures_.simulated_seconds += time_step;
    if (!is_slow(world_, options_)) last_fast_ = time_;
    const bool may_start = have_passed(options_.rest_window, last_fast_, time_);
    if (may_start && world_.has_guards()) {
      world_.remove_guards();
      last_fast_ = time_;
    } else if (may_start || proof_.is_under_way()) {
      proof_.observe(nodes_in_world(world_.tubes()), time_, may_start);
    }
  }

  /// False where the tube is not to be dropped again, or no longer.
  bool drop_again(std::size_t tube) {
    if (options_.spill == Spill::reject || figures_.redropped >= static_cast<int>(world_.size())) return false;
    ++figures_.redropped;
    world_.put(tube, spawn_again(tube, world_.tubes(), bin_, options_, random_));
    wait_for_a_fall_from(top_of({world_.tubes()[tube]}));
    last_fast_ = time_;
    return true;
  }

  static double top_of(const std::vector<scene::PlacedTube>& tubes) {
    double top = 0.0;
    for (const scene::PlacedTube& tube : tubes) top = std::max(top, CollisionTube(tube).bounds.max().z());
    return top;
  }

  void wait_for_a_fall_from(double height) { deadline_ = time_ + options_.time_limit + height / options_.speed_max; }

  double long_step_speed_;
  const scene::Bin& bin_;
  const PhysicsOptions& options_;
  Random& random_;
  RigidWorld world_;
  RestProof proof_;
  DropFigures figures_;
  double time_ = 0.0;  ///< seconds, as the others
  double last_fast_ = 0.0;
  double deadline_ = 0.0;
};

DropResult judge(const RigidWorld& world, const scene::Bin& bin, const PhysicsOptions& options, DropFigures figures) {
  DropResult result;
  result.tubes = world.tubes();
  result.masses = world.masses();
  result.contacts = find_contacts(result.tubes, bin, -kTouchingGap);
  figures.deepest_penetration = deepest_penetration(result.contacts);
  result.figures = figures;
  result.forces = std::make_shared<const PileForces>(world.forces());
  if (figures.deepest_penetration > options.penetration_max)
    return failed(DropFailure::penetration, fmt::format("{:.2f} mm deep", figures.deepest_penetration * 1e3), figures);
  if (const auto tube = find_floating(result.contacts, result.tubes.size()))
    return failed(DropFailure::floating, fmt::format("tube {} touches nothing that holds it", *tube + 1), figures);
  return result;
}

}  // namespace

DropResult settle(RigidWorld world, const Pace& pace, const scene::Bin& bin, const PhysicsOptions& options,
                  Random& random) {
  Settling settling(std::move(world), pace, bin, options, random);
  switch (const DropFailure failure = settling.settle()) {
    case DropFailure::none:
      return judge(settling.world(), bin, options, settling.figures());
    case DropFailure::outside:
      return failed(failure, fmt::format("tube {} left the bin", *find_outside(settling.world(), bin) + 1),
                    settling.figures());
    default:
      return failed(failure, fmt::format("still moving after {:.1f} s", settling.figures().simulated_seconds),
                    settling.figures());
  }
}

}  // namespace tubebin::physics
