#include "modeling/fitting/vote_sheets.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "modeling/fitting/vote_voxels.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

VoteVoxels gather_votes(const FilteredCloud& cloud, double radius, double voxel) {
  std::vector<cloud::Point> votes;
  votes.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    votes.push_back(cloud.points[i] - static_cast<float>(radius) * cloud.normals[i]);
  return {votes, voxel, 1};
}

/// Whether each voxel has as few votes as a sheet leaves in it, and those about it lie in two directions. `full`: votes of a
/// fully visible tube, six times a sheet's in voxels of a third of its radius and four times in those of half of it.
std::vector<char> sheet_like(const VoteVoxels& voxels, double full) {
  constexpr double kFew = 1.0 / 3.0, kTwoDirections = 0.6;
  std::vector<char> is_sheet(voxels.size(), false);
  for_ranges_in_parallel(voxels.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v)
      is_sheet[v] = static_cast<double>(voxels.count(v)) < kFew * full &&
                    voxels.spread(static_cast<std::uint32_t>(v)) > kTwoDirections;
  });
  return is_sheet;
}

}  // namespace

FilteredCloud without_sheets(const FilteredCloud& cloud, double radius) {
  // About ten radii wide.
  constexpr std::size_t kLeastVoxels = 400;
  const double voxel = radius / 2.0;
  const VoteVoxels voxels = gather_votes(cloud, radius, voxel);
  const std::vector<char> is_sheet = sheet_like(voxels, points_of_visible_stretch(radius, voxel, cloud.spacing));
  auto links = voxels.links(2.0 * voxel);
  std::erase_if(links, [&](const auto& link) { return !is_sheet[link.first] || !is_sheet[link.second]; });
  const std::vector<std::uint32_t> component = connected_components(voxels.size(), links);
  std::vector<std::size_t> sizes(voxels.size(), 0);
  for (const std::uint32_t c : component) ++sizes[c];

  FilteredCloud kept{.source = {}, .points = {}, .normals = {}, .spacing = cloud.spacing};
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (sizes[component[voxels.voxel_of(i)]] >= kLeastVoxels) continue;
    kept.source.push_back(cloud.source[i]);
    kept.points.push_back(cloud.points[i]);
    kept.normals.push_back(cloud.normals[i]);
    if (!cloud.viewpoints.empty()) kept.viewpoints.push_back(cloud.viewpoints[i]);
  }
  return kept;
}

}  // namespace tubebin::modeling
