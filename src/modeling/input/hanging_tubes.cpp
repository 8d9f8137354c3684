#include "modeling/input/hanging_tubes.hpp"

#include "modeling/fitting/vote_voxels.hpp"

namespace tubebin::modeling {

std::vector<std::uint32_t> hanging_over(std::span<const cloud::Point> points, std::span<const std::uint32_t> walls,
                                        std::span<const std::uint32_t> beside, double spacing) {
  std::vector<cloud::Point> all;
  for (const auto& indices : {walls, beside})
    for (const std::uint32_t i : indices) all.push_back(points[i]);
  const VoteVoxels voxels(all, 2.0 * spacing, 1);
  const std::vector<std::uint32_t> component = connected_components(voxels.size(), voxels.links(4.0 * spacing));
  const auto component_of = [&](std::size_t k) { return component[voxels.voxel_of(k)]; };
  std::vector<bool> reaches_walls(voxels.size(), false);
  for (std::size_t k = 0; k < walls.size(); ++k) reaches_walls[component_of(k)] = true;
  std::vector<std::uint32_t> hanging;
  for (std::size_t k = 0; k < beside.size(); ++k)
    if (reaches_walls[component_of(walls.size() + k)]) hanging.push_back(beside[k]);
  return hanging;
}

}  // namespace tubebin::modeling
