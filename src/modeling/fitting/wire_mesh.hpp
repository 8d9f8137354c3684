/// Wire mesh: the walls and the floor of a basket are made of what looks like thin tubes.
#pragma once

#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Whether pieces of one radius are the wires of a mesh: many, half of them or more straight and along one of three directions
/// at right angles, and those side by side far apart. Tubes that lie parallel lie next to each other.
bool is_wire_mesh(const std::vector<TubePiece>& pieces);

}  // namespace tubebin::modeling
