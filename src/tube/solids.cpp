#include "tubebin/tube/solids.hpp"

#include <algorithm>

namespace tubebin::tube {

bool TubeSolids::has_open_end() const {
  return std::ranges::any_of(cylinders, [](const SolidCylinder& cylinder) {
    return cylinder.bore_radius > 0.0 && (cylinder.is_free_a || cylinder.is_free_b);
  });
}

TubeSolids tube_solids(const Tube& tube, const std::vector<Vec3>& nodes) {
  const auto bore_of = [&](double radius) { return tube.wall_thickness > 0.0 ? radius - tube.wall_thickness : 0.0; };
  const std::vector<int> degrees = tube.node_degrees();
  const std::vector<double> radii = tube.node_radii();
  TubeSolids solids;
  for (const Cylinder& cylinder : tube.cylinders) {
    const auto a = static_cast<std::size_t>(cylinder.node_a), b = static_cast<std::size_t>(cylinder.node_b);
    const double radius = tube.radius_of(cylinder);
    solids.cylinders.push_back({.node_a = cylinder.node_a,
                                .node_b = cylinder.node_b,
                                .a = nodes[a],
                                .b = nodes[b],
                                .radius = radius,
                                .bore_radius = bore_of(radius),
                                .is_free_a = degrees[a] == 1,
                                .is_free_b = degrees[b] == 1});
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (degrees[i] != 1) solids.joints.push_back({static_cast<int>(i), nodes[i], radii[i], bore_of(radii[i])});
  return solids;
}

}  // namespace tubebin::tube
