#include "tubebin/physics/drop_simulator.hpp"

#include <algorithm>
#include <cmath>

#include "physics/rest_check.hpp"
#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"
#include "physics/spawn.hpp"

namespace tubebin::physics {
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

/// How steps are taken. Iterations grow where a pile does not come to rest: what still moves or creeps under a solver
/// that did not converge may stand under one that does.
class Pace {
 public:
  explicit Pace(const PhysicsOptions& options) : options_(options), next_boost_(options.solver_patience) {}

  /// What creeps once all is slow is mostly the solver's residual.
  void start_proof(double time) {
    boost_ *= kSolverBoost;
    next_boost_ = time + options_.check_time;
  }
  void boost_if_late(double time) {
    if (!have_passed(0.0, next_boost_, time)) return;
    boost_ *= kSolverBoost;
    next_boost_ = time + kBoostInterval;
  }

  StepSettings settings(bool all_slow) const {
    StepSettings settings = step_settings(options_);
    settings.solver_iterations =
        static_cast<int>(std::lround(std::min(boost_, kSolverBoostMax) * options_.solver_iterations));
    if (all_slow) settings.time_step = options_.rest_time_step;
    if (all_slow && options_.warm_start > 0.0) settings.warm_start = options_.rest_warm_start;
    // What rolls on and on may do so on the share of the last step's forces: friction and rolling resistance lag.
    if (boost_ >= kSolverBoostMax) settings.warm_start = 0.0;
    return settings;
  }

 private:
  const PhysicsOptions& options_;
  double next_boost_;  ///< seconds
  double boost_ = 1.0;
};

/// Steps until the pile is proven to be at rest; false at the time limit or when a tube is lost.
bool settle(RigidWorld& world, const scene::Bin& bin, const PhysicsOptions& options, DropFigures& figures,
            RestProof& proof) {
  Pace pace(options);
  double& time = figures.simulated_seconds;
  double last_fast = 0.0;  // seconds
  bool all_slow = false;   // for the rest window
  while (!proof.is_complete(time)) {
    if (have_passed(options.time_limit, 0.0, time) || find_outside(world, bin)) return false;
    pace.boost_if_late(time);
    const StepSettings settings = pace.settings(all_slow);
    world.step(settings);
    ++figures.steps;
    time += settings.time_step;
    if (!is_slow(world, options)) last_fast = time;
    all_slow = have_passed(options.rest_window, last_fast, time);
    if (all_slow && !proof.has_started()) pace.start_proof(time);
    if (all_slow || proof.is_under_way()) proof.observe(nodes_in_world(world.tubes()), time, all_slow);
  }
  figures.largest_drift = proof.drift();
  return true;
}

DropResult judge(const RigidWorld& world, const scene::Bin& bin, const PhysicsOptions& options, DropFigures figures) {
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

DropResult drop_tubes(const std::vector<tube::Tube>& tubes, const scene::Bin& bin, const PhysicsOptions& options,
                      std::uint64_t seed) {
  Random random(seed);
  const auto spawned = spawn(tubes, bin, options, random);
  if (!spawned) return failed(DropFailure::spawn, "a tube fits between the walls in no orientation");

  RigidWorld world(*spawned, bin, options, random.bits());
  DropFigures figures;
  RestProof proof(options);
  const bool settled = settle(world, bin, options, figures, proof);
  if (const auto tube = find_outside(world, bin))
    return failed(DropFailure::outside, fmt::format("tube {} left the bin", *tube + 1), figures);
  if (!settled)
    return failed(proof.has_started() ? DropFailure::drift : DropFailure::unsettled,
                  fmt::format("still moving after {} s", options.time_limit), figures);
  return judge(world, bin, options, figures);
}

}  // namespace tubebin::physics
