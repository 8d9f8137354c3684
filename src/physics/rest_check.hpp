/// When is a drop over, and is what it left a pile that can be?
#pragma once

#include <optional>
#include <vector>

#include "physics/rigid_world.hpp"

namespace tubebin::physics {

/// Every tube, but for one perhaps, below both (m/s, rad/s).
bool all_below(const RigidWorld& world, double speed, double turn_rate, std::optional<std::size_t> except = {});

/// Every tube slower than the options' thresholds.
bool is_slow(const RigidWorld& world, const PhysicsOptions& options);

/// The first tube whose centre of mass is not above the bin's floor between its walls.
std::optional<std::size_t> find_outside(const RigidWorld& world, const scene::Bin& bin);

/// Deepest interpenetration, metres; 0 where nothing touches.
double deepest_penetration(const std::vector<scene::Contact>& contacts);

/// The first tube from which no chain of contacts leads to the bin.
std::optional<std::size_t> find_floating(const std::vector<scene::Contact>& contacts, std::size_t tube_count);

}  // namespace tubebin::physics
