/// How much of a cloud can be seen from a place, and from where all of it can.
#pragma once

#include <span>

#include "tubebin/core/geometry.hpp"

namespace tubebin::modeling {

/// The share of the points that lie behind others as seen from `viewpoint`, by more than so many widths of a cell that holds some
/// four points.
double hidden_share(std::span<const Vec3> points, const Vec3& viewpoint, double widths);

/// The place from which the fewest of the points lie behind others, of places around them: near, and so far away that rays are
/// all but parallel. `behind`: a direction from their middle, on whose side no place is taken; zero: any is.
Vec3 most_open_viewpoint(std::span<const Vec3> points, const Vec3& behind);

}  // namespace tubebin::modeling
