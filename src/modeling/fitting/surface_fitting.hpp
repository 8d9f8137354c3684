/// Least-squares fit of a tube's surface to points.
#pragma once

#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

struct SurfacePoint {
  Vec3 position;  ///< metres
  Vec3 normal;    ///< unit, outward
};

struct SurfaceFit {
  double sigma = 0.0;    ///< robust standard deviation of the points' distances to the surface, metres
  double inliers = 0.0;  ///< part of the points within three standard deviations
};

/// Moves the nodes of a polyline so that the points lie at `radius` metres from it: Gauss-Newton on the robust
/// (Tukey) sum of squared distances, damped where the points do not determine a node, as along a straight stretch.
/// Points beyond the first and last node do not count. `points` in order along the polyline converge fastest.
SurfaceFit fit_surface(std::vector<Vec3>& nodes, std::span<const SurfacePoint> points, double radius);

}  // namespace tubebin::modeling
