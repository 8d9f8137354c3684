/// Whether the scanner can have stood where it is told, and where it stood instead.
#pragma once

#include <optional>
#include <string>

#include "tubebin/modeling/modeling_input.hpp"

namespace tubebin::modeling {

/// Where a pinhole camera stands that sees the points, in rows of `width`, each in its pixel; metres. Nothing where they
/// do not say: too few, all in one plane, or no such camera's. Noise along the rays does not matter.
std::optional<Vec3> viewpoint_of_grid(std::span<const cloud::Point> points, std::uint32_t width);

/// Moves the input's viewpoint to where the grid of an organized cloud shows it, if it is told elsewhere. Says so, and also
/// where points lie all around a viewpoint; empty if nothing is wrong.
std::string check_viewpoint(ModelingInput& input);

}  // namespace tubebin::modeling
