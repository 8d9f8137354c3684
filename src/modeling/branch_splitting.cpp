#include "tubebin/modeling/branch_splitting.hpp"

#include <algorithm>

namespace tubebin {
namespace {

/// The voxels farther than `reach` metres from the way, by the connected parts that they make up.
/// `distance`: of each voxel from the way.
std::vector<std::vector<std::uint32_t>> parts_off(const VoteGraph& graph, const std::vector<double>& distance,
                                                  double reach) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (std::uint32_t i = 0; i < graph.size(); ++i)
    for (const std::uint32_t j : graph.linked(i))
      if (i < j && distance[i] > reach && distance[j] > reach) links.emplace_back(i, j);
  const std::vector<std::uint32_t> part = connected_components(graph.size(), links);
  std::vector<std::vector<std::uint32_t>> parts(part.empty() ? 0 : 1 + *std::max_element(part.begin(), part.end()));
  for (std::uint32_t i = 0; i < graph.size(); ++i)
    if (distance[i] > reach) parts[part[i]].push_back(i);
  std::erase_if(parts, [](const auto& voxels) { return voxels.empty(); });
  return parts;
}

}  // namespace

std::vector<Stretch> split_branches(const FilteredCloud& cloud, const Segment& segment, double radius) {
  VoteGraph graph(cloud, segment, radius);
  // A flat end's votes lie up to a radius beside the line, and scatter by half as much. A part that reaches two radii
  // farther is longer than it is wide.
  const double reach = 1.5 * radius, least = 3.5 * radius;
  const std::vector<double> distance = graph.distances_from(graph.longest_way());
  std::vector<std::uint32_t> segment_of_voxel(graph.size(), 0);
  std::uint32_t segments = 1;
  for (const auto& part : parts_off(graph, distance, reach)) {
    double farthest = 0.0;
    for (const std::uint32_t i : part) farthest = std::max(farthest, distance[i]);
    if (farthest < least) continue;
    for (const std::uint32_t i : part) segment_of_voxel[i] = segments;
    ++segments;
  }
  std::vector<Stretch> result;
  if (segments == 1) {
    result.push_back({segment, std::move(graph)});
    return result;
  }

  std::vector<Segment> split(segments);
  for (std::size_t k = 0; k < segment.size(); ++k) split[segment_of_voxel[graph.voxel_of(k)]].push_back(segment[k]);
  VoteGraph longest(cloud, split.front(), radius);
  result.push_back({std::move(split.front()), std::move(longest)});
  for (std::size_t s = 1; s < split.size(); ++s)
    for (Stretch& part : split_branches(cloud, split[s], radius)) result.push_back(std::move(part));
  return result;
}

}  // namespace tubebin
