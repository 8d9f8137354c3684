/// Choosing paths that together hold every item exactly once, at the least total cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tubebin {

/// One way to chain items.
struct PathCandidate {
  std::vector<std::uint32_t> items;  ///< in path order; no item twice
  double cost = 0.0;
  std::vector<std::uint32_t> places = {};    ///< that it takes up, numbered from 0
  std::vector<std::uint32_t> excludes = {};  ///< places that nothing else in the cover may take up then
};

/// Indices of the candidates in the cheapest cover found. Every item must have a candidate of its own (a path of one)
/// that takes up no place; excluding is mutual.
/// Items that no candidate links are solved apart. Exact by branch and bound (the set partitioning problem)
/// where a part needs at most `node_limit` nodes; beyond that, the best found by then, which is never worse than
/// taking the paths greedily by saving.
std::vector<std::uint32_t> cheapest_path_cover(std::size_t item_count, std::span<const PathCandidate> candidates,
                                               std::size_t place_count, std::size_t node_limit);

}  // namespace tubebin
