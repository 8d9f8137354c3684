#include "modeling/joining/path_cover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "modeling/fitting/vote_voxels.hpp"

namespace tubebin::modeling {
namespace {

/// At items of promising candidates, of all nodes of a component; a node may look at all of them.
constexpr std::size_t kMostLooks = 20'000'000;

/// One connected component of the problem: items that candidates link, and those candidates.
class ComponentSolver {
 public:
  ComponentSolver(std::span<const PathCandidate> candidates, std::vector<std::uint32_t> items,
                  std::vector<std::uint32_t> open, std::size_t item_count,
                  std::span<const std::vector<std::uint32_t>> excluded_by, std::size_t node_limit)
      : candidates_(candidates),
        excluded_by_(excluded_by),
        items_(std::move(items)),
        open_(std::move(open)),
        nodes_left_(node_limit),
        price_(item_count, 0.0),
        covered_(item_count, false),
        exclusions_(excluded_by.size(), 0),
        candidates_of_item_(item_count) {
    for (const std::uint32_t i : items_) price_[i] = std::numeric_limits<double>::infinity();
    for (const std::uint32_t c : open_)
      for (const std::uint32_t i : candidates_[c].items)
        price_[i] = std::min(price_[i], candidates_[c].cost / double(candidates_[c].items.size()));
  }

  std::vector<std::uint32_t> solve() {
    take_greedily();
    raise_prices();
    drop_hopeless(price_);
    sort_by_item();
    nodes_left_ = std::min(nodes_left_, kMostLooks / std::max<std::size_t>(looks_of_a_node(), 1));
    branch(0.0, bound_);
    return best_;
  }

  double price(std::uint32_t item) const { return price_[item]; }

 private:
  double reduced_cost(std::uint32_t c) const { return reduced_cost(c, price_); }
  double reduced_cost(std::uint32_t c, const std::vector<double>& prices) const {
    double cost = candidates_[c].cost;
    for (const std::uint32_t i : candidates_[c].items) cost -= prices[i];
    return cost;
  }

  bool fits(std::uint32_t c) const {
    for (const std::uint32_t item : candidates_[c].items)
      if (covered_[item]) return false;
    for (const std::uint32_t place : candidates_[c].places)
      if (exclusions_[place] > 0) return false;
    return true;
  }

  void choose(std::uint32_t c) {
    for (const std::uint32_t item : candidates_[c].items) covered_[item] = true;
    count_exclusions(c, 1);
    chosen_.push_back(c);
  }
  void take_back() {
    for (const std::uint32_t item : candidates_[chosen_.back()].items) covered_[item] = false;
    count_exclusions(chosen_.back(), -1);
    chosen_.pop_back();
  }
  void count_exclusions(std::uint32_t c, int times) {
    for (const std::uint32_t place : candidates_[c].places)
      for (const std::uint32_t excluded : excluded_by_[place]) exclusions_[excluded] += times;
  }

  void keep_if_best(double cost) {
    if (cost >= best_cost_ - 1e-9) return;
    best_ = chosen_;
    best_cost_ = cost;
  }

  /// A cover: the candidates that cost least against their items' prices first.
  void take_greedily() {
    std::vector<std::pair<double, std::uint32_t>> queue;
    for (const std::uint32_t c : open_) queue.emplace_back(reduced_cost(c), c);
    std::make_heap(queue.begin(), queue.end(), std::greater<>());
    double cost = 0.0;
    std::size_t held = 0;
    while (held < items_.size() && !queue.empty()) {
      std::pop_heap(queue.begin(), queue.end(), std::greater<>());
      const std::uint32_t c = queue.back().second;
      queue.pop_back();
      if (!fits(c)) continue;
      choose(c);
      cost += candidates_[c].cost;
      held += candidates_[c].items.size();
    }
    if (held == items_.size()) keep_if_best(cost);  // not so where hopeless paths are gone
    while (!chosen_.empty()) take_back();
  }

  /// Lagrangian relaxation (Fisher 1981): each item has a price; what the items are worth together, less what
  /// candidates undercut their items' prices by, bounds every cover from below. Prices of items that are covered too
  /// often fall and those of uncovered ones rise (subgradient steps of Polyak's length), which raises the bound.
  void raise_prices() {
    constexpr int kSteps = 300;
    double agility = 1.0;
    int stale = 0;
    std::vector<double> best_prices = price_;
    bound_ = -std::numeric_limits<double>::infinity();
    for (int step = 0; step < kSteps; ++step) {
      std::vector<int> surplus(price_.size(), 0);
      double bound = 0.0;
      for (const std::uint32_t i : items_) bound += price_[i];
      for (const std::uint32_t c : open_) {
        const double reduced = reduced_cost(c);
        if (reduced >= 0.0) continue;
        bound += reduced;
        for (const std::uint32_t i : candidates_[c].items) ++surplus[i];
      }
      if (bound > bound_ + 1e-6) bound_ = bound, best_prices = price_, stale = 0;
      else if (++stale == 10) agility /= 2.0, stale = 0;
      double squares = 0.0;
      for (const std::uint32_t i : items_) squares += (1 - surplus[i]) * (1 - surplus[i]);
      if (squares == 0.0 || best_cost_ - bound_ < 1e-6) break;
      const double length = agility * std::max(best_cost_ - bound, 0.1) / squares;
      for (const std::uint32_t i : items_) price_[i] += length * (1 - surplus[i]);
      if (step % 10 == 9) {
        take_greedily();
        drop_hopeless(best_prices);
      }
    }
    price_ = best_prices;
    take_greedily();
  }

  /// A candidate whose reduced cost exceeds the gap between the best cover and the bound, which these prices make, is
  /// in no better cover.
  void drop_hopeless(const std::vector<double>& prices) {
    std::erase_if(open_, [&](std::uint32_t c) { return reduced_cost(c, prices) >= best_cost_ - bound_ + 1e-9; });
  }

  void sort_by_item() {
    std::vector<std::pair<double, std::uint32_t>> promising;
    for (const std::uint32_t c : open_) promising.emplace_back(reduced_cost(c), c);
    std::sort(promising.begin(), promising.end());
    for (const auto& [reduced, c] : promising)
      for (const std::uint32_t i : candidates_[c].items) candidates_of_item_[i].push_back(c);
  }

  /// At most.
  std::size_t looks_of_a_node() const {
    std::size_t looks = 0;
    for (const std::uint32_t i : items_) looks += candidates_of_item_[i].size();
    return looks;
  }

  /// `bound`: the least that a cover with what is chosen can cost.
  void branch(double cost, double bound) {
    if (nodes_left_ == 0 || bound >= best_cost_ - 1e-9) return;
    --nodes_left_;
    // The uncovered item with the fewest ways on leaves the smallest tree.
    bool is_covered = true;
    std::vector<std::uint32_t> ways, open;
    for (const std::uint32_t i : items_) {
      if (covered_[i]) continue;
      open.clear();
      const std::size_t fewest = is_covered ? SIZE_MAX : ways.size();
      for (const std::uint32_t c : candidates_of_item_[i]) {
        if (open.size() == fewest) break;
        if (fits(c)) open.push_back(c);
      }
      if (open.size() < fewest) ways.swap(open);
      is_covered = false;
      if (ways.size() <= 1) break;
    }
    if (is_covered) {
      keep_if_best(cost);
      return;
    }
    for (const std::uint32_t c : ways) {
      choose(c);
      branch(cost + candidates_[c].cost, bound + std::max(reduced_cost(c), 0.0));
      take_back();
    }
  }

  std::span<const PathCandidate> candidates_;
  std::span<const std::vector<std::uint32_t>> excluded_by_;
  std::vector<std::uint32_t> items_, open_;
  std::size_t nodes_left_;
  std::vector<double> price_;
  std::vector<bool> covered_;
  std::vector<int> exclusions_;                                 ///< of each place: how many of the chosen exclude it
  std::vector<std::vector<std::uint32_t>> candidates_of_item_;  ///< the promising ones, cheapest first
  std::vector<std::uint32_t> chosen_, best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  double bound_ = 0.0;
};

}  // namespace

PathCover cheapest_path_cover(std::size_t item_count, std::span<const PathCandidate> candidates,
                              std::span<const std::vector<std::uint32_t>> excluded_by, std::size_t node_limit) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (const PathCandidate& candidate : candidates)
    for (const std::uint32_t item : candidate.items) links.emplace_back(candidate.items.front(), item);
  const std::vector<std::uint32_t> component_of_item = connected_components(item_count, links);
  std::vector<std::vector<std::uint32_t>> items, open;
  for (std::uint32_t i = 0; i < item_count; ++i) {
    if (component_of_item[i] >= items.size()) items.resize(component_of_item[i] + 1);
    items[component_of_item[i]].push_back(i);
  }
  open.resize(items.size());
  for (std::uint32_t c = 0; c < candidates.size(); ++c)
    open[component_of_item[candidates[c].items.front()]].push_back(c);

  PathCover cover{.chosen = {}, .prices = std::vector<double>(item_count, 0.0)};
  for (std::size_t k = 0; k < items.size(); ++k) {
    ComponentSolver solver(candidates, items[k], open[k], item_count, excluded_by, node_limit);
    const auto chosen = solver.solve();
    cover.chosen.insert(cover.chosen.end(), chosen.begin(), chosen.end());
    for (const std::uint32_t i : items[k]) cover.prices[i] = solver.price(i);
  }
  std::sort(cover.chosen.begin(), cover.chosen.end());
  return cover;
}

}  // namespace tubebin::modeling
