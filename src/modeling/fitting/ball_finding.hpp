/// Balls that lie among the tubes: as curved along as across.
#pragma once

#include <vector>

#include "modeling/fitting/tube_classes.hpp"

namespace tubebin::modeling {

/// The balls that several of the `round` places agree on and points fit, as pieces of one node. A tube's end may be round,
/// too: balls of the radius of one of the classes are none. What the classes have on a ball's surface goes from them. `noise`:
/// metres, of the points across a surface; 0 where it is not known.
std::vector<TubePiece> find_balls(std::vector<RoundPlace> round, const FilteredCloud& cloud,
                                  const ViewProjection& projection, double noise, std::vector<TubeClass>& classes);

}  // namespace tubebin::modeling
