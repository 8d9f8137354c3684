/// Choosing paths that together hold every item exactly once, at the least total cost.
#pragma once

#include <boost/container/small_vector.hpp>
#include <cstdint>
#include <span>
#include <vector>

namespace tubebin::modeling {

/// Paths are short, and there are tens of thousands of them: without memory of their own they are copied at once.
using PathNumbers = boost::container::small_vector<std::uint32_t, 8>;

/// One way to chain items.
struct PathCandidate {
  PathNumbers items;  ///< in path order; no item twice
  double cost = 0.0;
  PathNumbers places = {};  ///< that it takes up, numbered from 0
};

struct PathCover {
  std::vector<std::uint32_t> chosen;  ///< indices of its candidates, ascending
  std::vector<double> prices;         ///< of the items, which bound every cover's cost (Lagrange multipliers)
};

/// The cheapest cover found. Every item must have a candidate of its own (a path of one) that takes up no place.
/// `excluded_by`, of each place: those that no other path of the cover may take up then; mutual. Items that no candidate
/// links are solved apart. Exact by branch and bound (the set partitioning problem) where a component needs at most
/// `node_limit` nodes, and fewer where thousands of its candidates are promising; beyond that, the best found by then, which is
/// never worse than taking the paths greedily by saving.
PathCover cheapest_path_cover(std::size_t item_count, std::span<const PathCandidate> candidates,
                              std::span<const std::vector<std::uint32_t>> excluded_by, std::size_t node_limit);

}  // namespace tubebin::modeling
