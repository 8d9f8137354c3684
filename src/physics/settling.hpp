/// From tubes anywhere to a pile that is proven to be at rest.
#pragma once

#include "physics/rigid_world.hpp"

namespace tubebin::physics {

/// Lets the tubes move from where they are, which may overlap no more than a pile at rest does, until all are at rest, and
/// checks the result. They have been slow for `slow_for` seconds.
DropResult settle(RigidWorld world, double slow_for, const scene::Bin& bin, const PhysicsOptions& options,
                  Random& random);

}  // namespace tubebin::physics
