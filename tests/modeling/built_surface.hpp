/// Surfaces of tubes as clouds with exact normals, sampled without a scanner.
#pragma once

#include <numbers>
#include <numeric>
#include <vector>

#include "modeling/built_scene.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/input/radius_estimation.hpp"

namespace tubebin::modeling {

/// A scanner a metre above the origin that looks down.
inline ViewProjection view_from_above() { return {make_pose(Quat(0, 1, 0, 0), {0, 0, 1}), cloud::Point::Zero()}; }

/// Curved places by normals that are estimated from the cloud, whose tubes have such a radius (0: not known).
inline CurvedPlaces curved_places_of(const FilteredCloud& cloud, double radius = 0.0) {
  const SurfaceNormals surface(cloud, view_from_above(), normal_radius(cloud.spacing, radius));
  return find_curved_places(cloud, surface, kSomePlaces);
}

/// The upper half of a tube's surface, sampled every 1.5 mm, without the joints' spheres.
inline FilteredCloud upper_half_of(const std::vector<Vec3>& nodes, double radius = kRadius) {
  constexpr double kSpacing = 0.0015;
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = kSpacing};
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 axis = (nodes[k + 1] - nodes[k]).normalized();
    const Vec3 side = axis.cross(Vec3::UnitZ()).normalized(), up = side.cross(axis);
    for (double along = 0.0; along < (nodes[k + 1] - nodes[k]).norm(); along += kSpacing)
      for (double angle = 0.0; angle < std::numbers::pi; angle += kSpacing / radius) {
        const Vec3 normal = std::cos(angle) * side + std::sin(angle) * up;
        cloud.points.push_back((nodes[k] + along * axis + radius * normal).cast<float>());
        cloud.normals.push_back(normal.cast<float>());
      }
  }
  cloud.source.resize(cloud.points.size());
  std::iota(cloud.source.begin(), cloud.source.end(), 0U);
  return cloud;
}

/// Farthest that a place of either polyline lies from the other, metres.
inline double distance_between(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double farthest = 0.0;
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (std::size_t k = 0; k + 1 < from->size(); ++k)
      for (double t = 0.0; t <= 1.0; t += 1.0 / 64.0)
        farthest = std::max(farthest, distance_to_polyline((*from)[k] + t * ((*from)[k + 1] - (*from)[k]), *to));
  return farthest;
}

}  // namespace tubebin::modeling
