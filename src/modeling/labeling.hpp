/// Labelling (step 5 of the pipeline): every point takes the nearest tube, if that is close enough.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/core/geometry.hpp"

namespace tubebin::modeling {

/// The surface of a tube along a polyline: flat-ended cylinders, and spheres at the inner nodes; a sphere at a node alone.
struct TubeSurface {
  std::span<const Vec3> nodes;
  double radius = 0.0;
  const std::vector<bool>* bridged = nullptr;  ///< of each cylinder: its course is a guess; null: none's is
};

/// Distances of points to the surface, metres; negative inside.
std::vector<double> distances_to_surface(const TubeSurface& surface, std::span<const Vec3> points);

struct NearestSurface {
  static constexpr std::uint32_t kNone = UINT32_MAX;
  std::uint32_t surface = kNone;  ///< index of the nearest surface, kNone where none is within reach
  float distance = 0.0f;          ///< to it, metres; negative inside
};

/// How far from a surface its points may lie, in its radii.
struct Reach {
  double seen = 0.0;
  double end = 0.0;      ///< before a flat end, whose place is less well known
  double bridged = 0.0;  ///< from a cylinder whose course is a guess
};

/// The nearest surface of every point, none where all are farther than they reach.
std::vector<NearestSurface> nearest_surfaces(std::span<const cloud::Point> points,
                                             const std::vector<TubeSurface>& surfaces, const Reach& reach);

/// Whether each point is inside one of the surfaces, or outside by less than `tolerance` metres.
std::vector<char> within_surfaces(std::span<const cloud::Point> points, const std::vector<TubeSurface>& surfaces,
                                  double tolerance);

}  // namespace tubebin::modeling
