/// Cylinder fitting of `--method centerline` (step 3 of the pipeline).
#pragma once

#include <optional>
#include <span>

#include "modeling/fitting/branch_splitting.hpp"
#include "modeling/fitting/surface_fitting.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Fits consecutive cylinders of the known radius to a stretch: its votes make a curve, the curve is cut where it
/// bends, the nodes minimize the points' distances to the surface, and the ends grow as far as points show them, also
/// those `loose` ones (in order of x) that no segment holds. Nothing results from votes that are no tube's.
std::optional<TubePiece> fit_centerline(const FilteredCloud& cloud, const Stretch& stretch,
                                        std::span<const SurfacePoint> loose, double radius, const Vec3& viewpoint);

}  // namespace tubebin::modeling
