/// From tubes anywhere to a pile that is proven to be at rest.
#pragma once

#include <vector>

#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::physics {

/// Lets the tubes go at the poses they have, which may overlap no more than a pile at rest does, until all are at rest, and
/// checks the result.
DropResult settle(const std::vector<scene::PlacedTube>& from, const scene::Bin& bin, const PhysicsOptions& options,
                  Random& random);

}  // namespace tubebin::physics
