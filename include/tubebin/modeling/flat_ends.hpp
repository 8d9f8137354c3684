/// The tubes' flat ends.
#pragma once

#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin {

/// Where points that no piece explains lie on a plane that faces away from a piece's end, they are its flat end: the
/// plane says where the tube ends and which way its last cylinder points, better than the side's last rows of points,
/// whose normals the edge disturbs. `unexplained` has normals of its own.
void fit_flat_ends(std::vector<TubePiece>& pieces, const FilteredCloud& cloud, const FilteredCloud& unexplained);

}  // namespace tubebin
