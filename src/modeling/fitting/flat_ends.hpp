/// The tubes' flat ends.
#pragma once

#include <span>
#include <vector>

#include "modeling/fitting/surface_fitting.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Where points that no piece explains lie on a plane that faces away from a piece's end, they are its flat end: the
/// plane says where the tube ends and which way its last cylinder points, better than the side's last rows of points,
/// whose normals the edge disturbs. `unexplained` has normals of its own.
void fit_flat_ends(std::vector<TubePiece>& pieces, const FilteredCloud& cloud, const FilteredCloud& unexplained);

/// The end of a tube's centreline behind the flat end that most of a short stretch's surface is: as far back as the
/// surface reaches, a radius at least, to the middle of what is seen of the flat end. None where the surface is a side.
std::vector<Vec3> axis_of_flat_end(std::span<const SurfacePoint> surface, double radius);

}  // namespace tubebin::modeling
