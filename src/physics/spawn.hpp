/// Start poses above the bin from which the tubes can fall into it (paper, Section 3).
#pragma once

#include <optional>
#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::physics {

/// Poses for all tubes: above the rim, within the bin's inner walls seen from above, `spawn_clearance` apart.
/// A tube keeps the orientation that it was generated with if it fits between the walls, else it is turned at
/// random until it does. Empty where a tube fits in no orientation.
std::optional<std::vector<scene::PlacedTube>> spawn(const std::vector<tube::Tube>& tubes, const scene::Bin& bin,
                                                    const PhysicsOptions& options, Random& random);

/// A new start pose for one tube: above the rim, and where it does not meet the others.
Pose spawn_again(std::size_t tube, const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin,
                 const PhysicsOptions& options, Random& random);

}  // namespace tubebin::physics
