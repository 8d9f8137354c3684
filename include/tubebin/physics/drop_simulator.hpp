/// Drops tubes into the bin until they are at rest (paper, Section 3), by ODE.
#pragma once

#include <string>
#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin {

/// Physics settings; the defaults were measured (docs/physics.md).
struct PhysicsOptions {
  double time_step = 0.003;          ///< seconds
  double time_limit = 30.0;          ///< seconds of simulated time
  double penetration_max = 0.0005;   ///< metres, in a finished scene
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
  floating      ///< a tube at rest that nothing holds up
};
/// "outside", "unsettled", ...
const char* to_string(DropFailure failure);

/// What the simulation measured.
struct DropFigures {
  int steps = 0;                      ///< simulation steps, the check at the end included
  double simulated_seconds = 0.0;
  double deepest_penetration = 0.0;   ///< metres, in the finished scene
  double largest_drift = 0.0;         ///< metres, over the check at the end
};

struct DropResult {
  DropFailure failure = DropFailure::none;
  std::string detail;                 ///< "tube 3 left the bin", empty without a failure
  std::vector<PlacedTube> tubes;
  std::vector<Contact> contacts;      ///< of the finished scene
  DropFigures figures;
};

/// Spawns the tubes above the bin, lets them fall together until all are at rest, and checks the result.
/// The same tubes, options and seed give the same result, whatever ran before in this process.
DropResult drop_tubes(const std::vector<Tube>& tubes, const Bin& bin, const PhysicsOptions& options,
                      std::uint64_t seed);

}  // namespace tubebin
