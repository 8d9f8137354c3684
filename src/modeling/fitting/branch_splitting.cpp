#include "modeling/fitting/branch_splitting.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "modeling/fitting/vote_voxels.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
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

/// Where the way from the end of the graph turns back: its distance from that end. Two tubes side by side whose ends are
/// flush may hang together by the votes of their flat ends. No tube turns by 120 degrees within so few radii.
std::optional<double> turning_point(const VoteGraph& graph, const std::vector<std::uint32_t>& way, double radius) {
  const double window = 4.0 * radius;
  const auto& distance = graph.distances_from_end();
  const auto place = [&](std::size_t k) { return Vec3(graph.mean(way[k]).cast<double>()); };
  std::optional<double> turn;
  double sharpest = -0.5;
  std::size_t before = 0, after = 0;  // the last voxel a window farther from the end, the first one a window nearer
  for (std::size_t k = 0; k < way.size(); ++k) {
    while (before + 1 < k && distance[way[before + 1]] >= distance[way[k]] + window) ++before;
    while (after < way.size() && distance[way[after]] > distance[way[k]] - window) ++after;
    if (after == way.size()) break;
    if (distance[way[before]] < distance[way[k]] + window) continue;
    const double cosine = (place(k) - place(before)).normalized().dot((place(after) - place(k)).normalized());
    if (cosine < sharpest) sharpest = cosine, turn = distance[way[k]];
  }
  return turn;
}

/// Where the way is to be cut, as a distance from the graph's end: where it turns back, or in the middle if it is so long that
/// to compare each of its points with each of its cylinders would take seconds. Joining makes such a tube whole again.
std::optional<double> cut_of(const VoteGraph& graph, const std::vector<std::uint32_t>& way, double radius) {
  constexpr double kLongest = 300.0;  // radii
  if (const auto turn = turning_point(graph, way, radius)) return turn;
  const double length = graph.distances_from_end()[way.front()];
  return length > kLongest * radius ? std::optional(length / 2.0) : std::nullopt;
}

std::vector<Stretch> divided(const Stretch& whole, const std::vector<std::uint32_t>& part_of_voxel, std::size_t parts) {
  std::vector<Stretch> stretches;
  for (VoteGraph& graph : whole.graph.divided(part_of_voxel, parts))
    stretches.push_back({.segment = {}, .graph = std::move(graph)});
  for (std::size_t k = 0; k < whole.segment.size(); ++k)
    stretches[part_of_voxel[whole.graph.voxel_of(k)]].segment.push_back(whole.segment[k]);
  return stretches;
}

/// The part nearer to the graph's end than `cut` metres, and the other.
std::vector<Stretch> cut_across(const Stretch& whole, double cut) {
  std::vector<std::uint32_t> part;
  for (const double distance : whole.graph.distances_from_end()) part.push_back(distance < cut ? 0 : 1);
  return divided(whole, part, 2);
}

/// The part along the way, and those off it that are long enough to be tubes.
std::vector<Stretch> split_off(const Stretch& whole, const std::vector<std::uint32_t>& way, double radius) {
  // A flat end's votes lie up to a radius beside the line, and scatter by half as much. A part that reaches two radii
  // farther is longer than it is wide.
  const double reach = 1.5 * radius, least = 3.5 * radius;
  const std::vector<double> distance = whole.graph.distances_from(way);
  std::vector<std::uint32_t> part_of_voxel(whole.graph.size(), 0);
  std::uint32_t parts = 1;
  for (const auto& part : parts_off(whole.graph, distance, reach)) {
    double farthest = 0.0;
    for (const std::uint32_t i : part) farthest = std::max(farthest, distance[i]);
    if (farthest < least) continue;
    for (const std::uint32_t i : part) part_of_voxel[i] = parts;
    ++parts;
  }
  return parts == 1 ? std::vector<Stretch>{} : divided(whole, part_of_voxel, parts);
}

std::vector<Stretch> all_stretches(Stretch whole, double radius) {
  Split split = split_off_longest(std::move(whole), radius);
  std::vector<Stretch> stretches;
  stretches.push_back(std::move(split.longest));
  std::ranges::move(
      gather_in_parallel(split.others.size(),
                         [&](std::size_t k) { return all_stretches(std::move(split.others[k]), radius); }),
      std::back_inserter(stretches));
  return stretches;
}

}  // namespace

Split split_off_longest(Stretch whole, double radius) {
  const std::vector<std::uint32_t> way = whole.graph.longest_way();
  if (const auto cut = cut_of(whole.graph, way, radius)) {
    std::vector<Stretch> parts = cut_across(whole, *cut);
    Split split = split_off_longest(std::move(parts[0]), radius);
    split.others.push_back(std::move(parts[1]));
    return split;
  }
  std::vector<Stretch> parts = split_off(whole, way, radius);
  if (parts.empty()) return {.longest = std::move(whole), .others = {}};
  Split split{.longest = std::move(parts.front()), .others = {}};
  std::move(parts.begin() + 1, parts.end(), std::back_inserter(split.others));
  return split;
}

std::vector<Stretch> split_branches(const FilteredCloud& cloud, const Segment& segment, double radius) {
  return all_stretches({segment, VoteGraph(cloud, segment, radius)}, radius);
}

}  // namespace tubebin::modeling
