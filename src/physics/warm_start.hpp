/// Contacts that last take their forces from one step to the next.
#pragma once

#include <utility>
#include <vector>

#include "physics/contact_solver.hpp"

namespace tubebin::physics {

/// What the contacts of a step are sorted by: the second body, then the first, where the bin comes before all tubes.
std::pair<std::size_t, std::size_t> contact_bodies(const StepContact& contact);

/// Each of `contacts` starts from `share` of what the same contact bore in the step `before`: one of the same bodies,
/// within half a radius of its place, with nearly its normal. Each of those is taken once. Both are sorted.
void warm_start(const std::vector<StepContact>& before, double share, const std::vector<CollisionTube>& tubes,
                std::vector<StepContact>& contacts);

}  // namespace tubebin::physics
