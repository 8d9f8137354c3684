#include "tubebin/modeling/path_cover.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "tubebin/modeling/vote_voxels.hpp"

namespace tubebin {
namespace {

using Compatible = std::function<bool(std::uint32_t, std::uint32_t)>;

/// Branch and bound over the items of one part.
class PartSolver {
 public:
  PartSolver(std::span<const PathCandidate> candidates, const Compatible& compatible,
             const std::vector<std::vector<std::uint32_t>>& candidates_of_item, std::vector<std::uint32_t> items,
             std::size_t node_limit)
      : candidates_(candidates), compatible_(compatible), candidates_of_item_(candidates_of_item),
        items_(std::move(items)), nodes_left_(node_limit) {
    covered_.assign(candidates_of_item.size(), false);
    // The least that an item can cost: a path's cost, shared evenly by its items, over all paths through it. No cover
    // of a set of items is cheaper than the sum of these.
    share_.assign(candidates_of_item.size(), 0.0);
    for (const std::uint32_t item : items_) {
      share_[item] = std::numeric_limits<double>::infinity();
      for (const std::uint32_t c : candidates_of_item_[item])
        share_[item] = std::min(share_[item], candidates_[c].cost / double(candidates_[c].items.size()));
    }
  }

  std::vector<std::uint32_t> solve() {
    take_greedily();
    double bound = 0.0;
    for (const std::uint32_t item : items_) bound += share_[item];
    branch(0.0, bound);
    return best_;
  }

 private:
  bool fits(std::uint32_t candidate) const {
    for (const std::uint32_t item : candidates_[candidate].items)
      if (covered_[item]) return false;
    for (const std::uint32_t other : chosen_)
      if (!compatible_(candidate, other)) return false;
    return true;
  }

  void cover(std::uint32_t candidate, bool covered) {
    for (const std::uint32_t item : candidates_[candidate].items) covered_[item] = covered;
    if (covered) chosen_.push_back(candidate);
    else chosen_.pop_back();
  }

  /// A first cover: paths in order of what they save against their items standing alone.
  void take_greedily() {
    std::vector<std::pair<double, std::uint32_t>> savings;
    std::vector<double> alone(covered_.size(), 0.0);
    for (const std::uint32_t item : items_)
      for (const std::uint32_t c : candidates_of_item_[item])
        if (candidates_[c].items.size() == 1) alone[item] = candidates_[c].cost;
    for (const std::uint32_t item : items_)
      for (const std::uint32_t c : candidates_of_item_[item]) {
        if (candidates_[c].items.front() != item) continue;
        double saving = -candidates_[c].cost;
        for (const std::uint32_t i : candidates_[c].items) saving += alone[i];
        savings.emplace_back(-saving, c);
      }
    std::sort(savings.begin(), savings.end());
    double cost = 0.0;
    for (const auto& [negative_saving, c] : savings) {
      if (!fits(c)) continue;
      cover(c, true);
      cost += candidates_[c].cost;
    }
    best_ = chosen_;
    best_cost_ = cost;
    while (!chosen_.empty()) cover(chosen_.back(), false);
  }

  /// `cost` of what is chosen, `bound`: the least that the uncovered items can still cost.
  void branch(double cost, double bound) {
    if (nodes_left_ == 0 || cost + bound >= best_cost_ - 1e-9) return;
    --nodes_left_;
    // The uncovered item with the fewest ways on leaves the smallest tree.
    std::uint32_t item = VoteVoxels::kNone;
    std::vector<std::uint32_t> ways;
    for (const std::uint32_t i : items_) {
      if (covered_[i]) continue;
      std::vector<std::uint32_t> open;
      for (const std::uint32_t c : candidates_of_item_[i])
        if (fits(c)) open.push_back(c);
      if (item == VoteVoxels::kNone || open.size() < ways.size()) {
        item = i;
        ways = std::move(open);
        if (ways.size() <= 1) break;
      }
    }
    if (item == VoteVoxels::kNone) {
      best_ = chosen_;
      best_cost_ = cost;
      return;
    }
    for (const std::uint32_t c : ways) {  // cheapest for its items first: candidates_of_item_ is in that order
      double left = bound;
      for (const std::uint32_t i : candidates_[c].items) left -= share_[i];
      cover(c, true);
      branch(cost + candidates_[c].cost, left);
      cover(c, false);
    }
  }

  std::span<const PathCandidate> candidates_;
  const Compatible& compatible_;
  const std::vector<std::vector<std::uint32_t>>& candidates_of_item_;
  std::vector<std::uint32_t> items_;
  std::size_t nodes_left_;
  std::vector<double> share_;
  std::vector<bool> covered_;
  std::vector<std::uint32_t> chosen_, best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<std::uint32_t> cheapest_path_cover(std::size_t item_count, std::span<const PathCandidate> candidates,
                                               const Compatible& compatible, std::size_t node_limit) {
  std::vector<std::vector<std::uint32_t>> candidates_of_item(item_count);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (std::uint32_t c = 0; c < candidates.size(); ++c) {
    for (const std::uint32_t item : candidates[c].items) {
      candidates_of_item[item].push_back(c);
      links.emplace_back(candidates[c].items.front(), item);
    }
  }
  const auto share = [&](std::uint32_t c) { return candidates[c].cost / double(candidates[c].items.size()); };
  for (auto& list : candidates_of_item)
    std::stable_sort(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) { return share(a) < share(b); });

  const std::vector<std::uint32_t> part_of_item = connected_components(item_count, links);
  std::vector<std::vector<std::uint32_t>> parts;
  for (std::uint32_t i = 0; i < item_count; ++i) {
    if (part_of_item[i] >= parts.size()) parts.resize(part_of_item[i] + 1);
    parts[part_of_item[i]].push_back(i);
  }
  std::vector<std::uint32_t> cover;
  for (const auto& part : parts) {
    const auto chosen = PartSolver(candidates, compatible, candidates_of_item, part, node_limit).solve();
    cover.insert(cover.end(), chosen.begin(), chosen.end());
  }
  std::sort(cover.begin(), cover.end());
  return cover;
}

}  // namespace tubebin
