/// Branches that were followed beyond their start.
#pragma once

#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Cuts each path's ends back to where it runs through another one within its last two radii, clear of that one's ends: no
/// tube does, so it is a branch that was followed beyond its start. `radius` in metres.
void cut_ends_beyond_others(std::vector<TubePath>& paths, double radius);

}  // namespace tubebin::modeling
