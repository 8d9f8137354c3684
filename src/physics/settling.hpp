/// From tubes anywhere to a pile that is proven to be at rest.
#pragma once

#include "physics/rigid_world.hpp"

namespace tubebin::physics {

/// How the tubes have moved before, and may.
struct Pace {
  double slow_for = 0.0;         ///< seconds for which all have been slow
  double long_step_speed = 0.0;  ///< m/s; while all are slower, steps are as long as in the proof of rest
};

/// Lets the tubes move from where they are, which may overlap no more than a pile at rest does, until all are at rest, and
/// checks the result.
DropResult settle(RigidWorld world, const Pace& pace, const scene::Bin& bin, const PhysicsOptions& options,
                  Random& random);

}  // namespace tubebin::physics
