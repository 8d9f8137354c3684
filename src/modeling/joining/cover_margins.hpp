/// How much worse than the best cover the next best one is: how sure its paths are.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "modeling/joining/path_cover.hpp"

namespace tubebin::modeling {

/// Margins are nats: logs of how much likelier the best cover is than the best one of those that differ in what is
/// asked. Those above `kMost` are `kMost`. 0: another cover is as good. What stands nowhere in the way of the change stays
/// as it is, also where a place becomes free; and a search of the change ends at some size. Both may leave a margin too
/// large.
class CoverMargins {
 public:
  static constexpr double kMost = 10.0;

  /// All arguments but the first as cheapest_path_cover has them; they must outlive this.
  CoverMargins(const PathCover& cover, std::span<const PathCandidate> candidates,
               std::span<const std::vector<std::uint32_t>> excluded_by);

  /// To the covers without this path, which is one of the best cover's.
  double of_path(std::uint32_t candidate) const;

  /// To the covers in which no path has both items, which are in one path of the best cover.
  double of_pair(std::uint32_t item_a, std::uint32_t item_b) const;

 private:
  friend class Exchange;

  double margin(std::uint32_t removed, const std::function<bool(std::uint32_t)>& is_ruled_out) const;

  std::span<const PathCandidate> candidates_;
  std::span<const std::vector<std::uint32_t>> excluded_by_;
  std::vector<double> reduced_;                         ///< the candidates' costs less their items' prices, at least 0
  double slack_ = kMost;                                ///< reduced costs that a cover of interest has together at most
  std::vector<std::vector<std::uint32_t>> ways_;        ///< of each item: candidates of interest, cheapest first
  std::vector<std::uint32_t> path_of_item_;             ///< in the best cover
  std::vector<std::vector<std::uint32_t>> paths_near_;  ///< of each place: paths of the best cover that exclude it
};

}  // namespace tubebin::modeling
