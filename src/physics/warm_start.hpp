/// Contacts that last take their forces from one step to the next.
#pragma once

#include <vector>

#include "physics/contact_solver.hpp"

namespace tubebin::physics {

/// Each of `contacts` starts from `share` of what the same contact bore in the step `before`: one of the same bodies,
/// within half a radius of its place, with nearly its normal. Each of those is taken once. In both steps contacts come by
/// their second body, those of one by the first.
void warm_start(const std::vector<StepContact>& before, double share, const std::vector<CollisionTube>& tubes,
                std::vector<StepContact>& contacts);

}  // namespace tubebin::physics
