#include "modeling/input/hanging_tubes.hpp"

#include "modeling/fitting/vote_voxels.hpp"

namespace tubebin::modeling {

std::vector<std::uint32_t> hanging_over(std::span<const cloud::Point> points, std::span<const std::uint32_t> inside,
                                        std::span<const std::uint32_t> beside, double spacing) {
  std::vector<cloud::Point> all;
  for (const auto& indices : {inside, beside})
    for (const std::uint32_t i : indices) all.push_back(points[i]);
  const VoteVoxels voxels(all, 2.0 * spacing, 1);
  const std::vector<std::uint32_t> component = connected_components(voxels.size(), voxels.links(4.0 * spacing));
  const auto component_of = [&](std::size_t k) { return component[voxels.voxel_of(k)]; };
  std::vector<bool> reaches_inside(voxels.size(), false);
  for (std::size_t k = 0; k < inside.size(); ++k) reaches_inside[component_of(k)] = true;
  std::vector<std::uint32_t> hanging;
  for (std::size_t k = 0; k < beside.size(); ++k)
    if (reaches_inside[component_of(inside.size() + k)]) hanging.push_back(beside[k]);
  return hanging;
}

}  // namespace tubebin::modeling
