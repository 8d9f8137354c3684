#include "tubebin/physics/drop_simulator.hpp"

#include <algorithm>
#include <cmath>

#include "physics/rest_check.hpp"
#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"
#include "physics/spawn.hpp"

namespace tubebin {
namespace {

/// Bodies at rest may be this far apart and still count as touching: twice what the contact layer leaves.
constexpr double kTouchingGap = 0.0002;  // metres

/// A stubborn pile is iterated half as much again and again, up to eight times as much as the fall.
constexpr double kSolverBoost = 1.5;
constexpr double kSolverBoostMax = 8.0;
constexpr double kBoostInterval = 0.5;  // seconds

DropResult failed(DropFailure failure, std::string detail, DropFigures figures = {}) {
  DropResult result;
  result.failure = failure;
  result.detail = std::move(detail);
  result.figures = figures;
  return result;
}

/// The number of quickstep's iterations, which grows where a pile does not come to rest: what still moves or creeps
/// under a solver that did not converge may stand under one that does.
class SolverEffort {
 public:
  SolverEffort(RigidWorld& world, const PhysicsOptions& options)
      : world_(world), options_(options), next_boost_(steps_in(options.solver_patience, options)) {}

  /// What creeps once all is slow is mostly the solver's residual.
  void start_proof(int step) {
    boost();
    next_boost_ = step + steps_in(options_.check_time, options_);
  }
  void boost_if_late(int step) {
    if (step < next_boost_) return;
    boost();
    next_boost_ = step + steps_in(kBoostInterval, options_);
  }

 private:
  void boost() {
    boost_ = std::min(kSolverBoost * boost_, kSolverBoostMax);
    world_.set_solver_iterations(static_cast<int>(std::lround(boost_ * options_.solver_iterations)));
    // What rolls on and on may do so on the share of the last step's forces: friction and rolling resistance lag.
    if (boost_ == kSolverBoostMax) world_.stop_warm_starts();
  }

  RigidWorld& world_;
  const PhysicsOptions& options_;
  int next_boost_;
  double boost_ = 1.0;
};

/// Steps until the pile is proven to be at rest; false at the time limit or when a tube is lost.
bool settle(RigidWorld& world, const Bin& bin, const PhysicsOptions& options, DropFigures& figures, RestProof& proof) {
  SolverEffort effort(world, options);
  const int window = steps_in(options.rest_window, options);
  const int limit = steps_in(options.time_limit, options);
  for (int slow_steps = 0; !proof.is_complete(figures.steps);) {
    if (figures.steps >= limit || find_outside(world, bin)) return false;
    effort.boost_if_late(figures.steps);
    world.step();
    ++figures.steps;
    slow_steps = is_slow(world, options) ? slow_steps + 1 : 0;
    if (!proof.has_started() && slow_steps >= window) effort.start_proof(figures.steps);
    proof.observe(nodes_in_world(world.tubes()), figures.steps, slow_steps >= window);
  }
  figures.largest_drift = proof.drift();
  return true;
}

DropResult judge(const RigidWorld& world, const Bin& bin, const PhysicsOptions& options, DropFigures figures) {
  DropResult result;
  result.tubes = world.tubes();
  result.contacts = find_contacts(result.tubes, bin, -kTouchingGap);
  figures.deepest_penetration = deepest_penetration(result.contacts);
  result.figures = figures;
  if (figures.deepest_penetration > options.penetration_max)
    return failed(DropFailure::penetration, fmt::format("{:.2f} mm deep", figures.deepest_penetration * 1e3), figures);
  if (const auto tube = find_floating(result.contacts, result.tubes.size()))
    return failed(DropFailure::floating, fmt::format("tube {} touches nothing that holds it", *tube + 1), figures);
  return result;
}

}  // namespace

DropResult drop_tubes(const std::vector<Tube>& tubes, const Bin& bin, const PhysicsOptions& options,
                      std::uint64_t seed) {
  Random random(seed);
  const auto spawned = spawn(tubes, bin, options, random);
  if (!spawned) return failed(DropFailure::spawn, "a tube fits between the walls in no orientation");

  RigidWorld world(*spawned, bin, options, random.bits());
  DropFigures figures;
  RestProof proof(options);
  const bool settled = settle(world, bin, options, figures, proof);
  figures.simulated_seconds = figures.steps * options.time_step;
  if (const auto tube = find_outside(world, bin))
    return failed(DropFailure::outside, fmt::format("tube {} left the bin", *tube + 1), figures);
  if (!settled)
    return failed(proof.has_started() ? DropFailure::drift : DropFailure::unsettled,
                  fmt::format("still moving after {} s", options.time_limit), figures);
  return judge(world, bin, options, figures);
}

}  // namespace tubebin
