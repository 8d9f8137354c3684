/// The tubes' radius where nobody states it.
#pragma once

#include <vector>

#include "tubebin/modeling/scan_view.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// The median radius of curvature of the surface, metres: on a cylinder, normals turn by 1 / r a metre across the axis
/// and not at all along it. 0 where the surface does not curve that way.
double estimate_radius(const std::vector<cloud::Point>& points, const std::vector<cloud::Point>& normals,
                       const ViewProjection& projection, double spacing);

/// The median radius of the circles that fit the points about the pieces' cylinders, seen along their axes (Kasa
/// 1976), metres; `radius` where no cylinder is long enough to tell.
double refine_radius(const std::vector<TubePiece>& pieces, const std::vector<cloud::Point>& points, double radius);

}  // namespace tubebin::modeling
