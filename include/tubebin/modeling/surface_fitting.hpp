/// Least-squares fit of a tube's surface to points.
#pragma once

#include <span>
#include <vector>

#include "tubebin/modeling/filtering.hpp"

namespace tubebin {

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

/// Appends nodes, about a radius apart, as far as the points show that the tube goes on from its last node without a
/// gap, and ends the last cylinder where they end. A point shows it if it lies on the next cylinder's side and its
/// normal stands across it; a flat end's do not.
/// `own` are the cloud's points of the piece, `loose` those of none, in order of x.
void grow_end(std::vector<Vec3>& nodes, const FilteredCloud& cloud, std::span<const std::uint32_t> own,
              std::span<const SurfacePoint> loose, double radius, const Vec3& viewpoint);

}  // namespace tubebin
