/// Drops tubes into the bin until they are at rest (paper, Section 3), by ODE.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::physics {

/// Tubes that fall out of the bin.
enum class Spill {
  reject,  ///< the drop fails, as in the paper
  guard,   ///< guards on the walls hold them while they fall; what falls out once these are gone is dropped again alone
  redrop   ///< they are dropped again alone
};

/// Physics settings; the defaults were measured (docs/physics.md).
struct PhysicsOptions {
  double gravity = 9.81;                ///< m/s^2
  double time_step = 0.005;             ///< seconds
  double rest_time_step = 0.010;        ///< seconds; once all tubes have been slow for rest_window
  int solver_iterations = 20;           ///< most sweeps over a step's contacts
  double solver_tolerance = 0.001;      ///< m/s; a sweep that changes no contact's velocity by as much is the last
  double solver_over_relaxation = 1.0;  ///< SOR factor of Gauss-Seidel
  double warm_start = 1.0;              ///< share of a lasting contact's force that the next step starts from
  double contact_erp = 0.2;             ///< share of an interpenetration that one step corrects
  double contact_cfm = 1e-5;            ///< softness of a contact, s/kg
  double contact_layer = 0.0001;        ///< metres of interpenetration left alone, so that contacts persist
  double correcting_speed_max = 0.5;    ///< m/s
  double friction_tube = 1.16;          ///< Coulomb coefficient, tube on tube
  double friction_bin = 1.16;           ///< Coulomb coefficient, tube on bin
  double rolling_resistance = 0.0015;   ///< metres: the torque of a contact that resists rolling, by its force
  double damping_linear = 0.002;        ///< share of the linear velocity lost in a step
  double damping_angular = 0.01;        ///< share of the angular velocity lost in a step
  double speed_max = 2.5;               ///< m/s
  Spill spill = Spill::redrop;          ///< what happens to tubes that fall out of the bin
  double spawn_clearance = 0.005;       ///< metres between spawned tubes, and between them and the rim's height
  int spawn_tries = 16;                 ///< free places looked at for each tube, of which the lowest is taken
  double rest_speed = 0.01;             ///< m/s
  double rest_turn_rate = 0.1;          ///< rad/s
  double rest_window = 0.1;             ///< seconds
  double check_time = 1.0;              ///< seconds
  double drift_max = 0.0005;            ///< metres, over check_time
  double penetration_max = 0.0005;      ///< metres, in a finished scene
  double time_limit = 10.0;             ///< seconds of simulated time

  friend bool operator==(const PhysicsOptions&, const PhysicsOptions&) = default;
};

void describe(Fields& fields, PhysicsOptions& options);
void check(const PhysicsOptions& options, const KeyPlaces& places, const std::string& prefix);

/// Why a drop is not usable.
enum class DropFailure {
  none,
  spawn,        ///< no free place above the bin was found for a tube
  outside,      ///< a tube left the bin
  unsettled,    ///< still moving at the time limit
  penetration,  ///< bodies interpenetrate more than allowed
  drift,        ///< at rest by its velocities, yet it moved when the simulation ran on
  floating      ///< a tube at rest that touches nothing which leads to the bin
};
/// "outside", "unsettled", ...
const char* to_string(DropFailure failure);

/// What the simulation measured.
struct DropFigures {
  int steps = 0;  ///< simulation steps, the check at the end included
  double simulated_seconds = 0.0;
  int redropped = 0;                 ///< tubes that left the bin and were dropped again
  double deepest_penetration = 0.0;  ///< metres, in the finished scene
  double largest_drift = 0.0;        ///< metres, over the check at the end
};

/// What the contacts of a pile bear, in the simulator's own form.
struct PileForces;

struct DropResult {
  DropFailure failure = DropFailure::none;
  std::string detail;  ///< "tube 3 left the bin", empty without a failure
  std::vector<scene::PlacedTube> tubes;
  std::vector<tube::MassProperties> masses;  ///< of these
  std::vector<scene::Contact> contacts;      ///< of the finished scene
  DropFigures figures;
  std::shared_ptr<const PileForces> forces;  ///< that hold the finished scene; a lift goes on from them
};

/// Spawns the tubes above the bin, lets them fall together until all are at rest, and checks the result.
/// The same tubes, options and seed give the same result, whatever ran before or runs on other threads of this process.
DropResult drop_tubes(const std::vector<tube::Tube>& tubes, const scene::Bin& bin, const PhysicsOptions& options,
                      std::uint64_t seed);

}  // namespace tubebin::physics
