#include "modeling/joining/cover_margins.hpp"

#include <algorithm>

namespace tubebin::modeling {

/// Depth first: paths leave the best cover and others take their items, until each item is held again. What is far from
/// the path that leaves first stays as it is, and costs nothing.
class Exchange {
 public:
  Exchange(const CoverMargins& problem, const std::function<bool(std::uint32_t)>& is_ruled_out)
      : problem_(problem),
        is_ruled_out_(is_ruled_out),
        state_(problem.ways_.size(), State::as_it_was),
        exclusions_(problem.excluded_by_.size(), 0) {}

  /// What the cheapest exchange costs that removes this path.
  double least_cost(std::uint32_t removed) {
    remove(removed);
    extend(0.0);
    return least_;
  }

 private:
  enum class State : std::uint8_t { as_it_was, open, taken };
  static constexpr std::size_t kNodeLimit = 300;

  const PathCandidate& path(std::uint32_t c) const { return problem_.candidates_[c]; }

  void remove(std::uint32_t c) {
    for (const std::uint32_t item : path(c).items) {
      state_[item] = State::open;
      open_.push_back(item);
    }
    cost_ -= path(c).cost;
    removed_.push_back(c);
  }
  void put_back() {
    const std::uint32_t c = removed_.back();
    removed_.pop_back();
    cost_ += path(c).cost;
    for (const std::uint32_t item : path(c).items) state_[item] = State::as_it_was;
    open_.resize(open_.size() - path(c).items.size());
  }

  /// With whatever of the best cover is in its way removed.
  void add(std::uint32_t c) {
    for (const std::uint32_t item : path(c).items)
      if (state_[item] == State::as_it_was) remove(problem_.path_of_item_[item]);
    for (const std::uint32_t place : path(c).places)
      for (const std::uint32_t near : problem_.paths_near_[place])
        if (state_[path(near).items.front()] == State::as_it_was) remove(near);
    for (const std::uint32_t item : path(c).items) state_[item] = State::taken;
    count_exclusions(c, 1);
    cost_ += path(c).cost;
  }
  void take_back(std::uint32_t c, std::size_t removed_before) {
    cost_ -= path(c).cost;
    count_exclusions(c, -1);
    for (const std::uint32_t item : path(c).items) state_[item] = State::open;
    while (removed_.size() > removed_before) put_back();
  }
  void count_exclusions(std::uint32_t c, int times) {
    for (const std::uint32_t place : path(c).places)
      for (const std::uint32_t excluded : problem_.excluded_by_[place]) exclusions_[excluded] += times;
  }

  bool fits(std::uint32_t c) const {
    if (is_ruled_out_(c)) return false;
    for (const std::uint32_t item : path(c).items)
      if (state_[item] == State::taken) return false;
    for (const std::uint32_t place : path(c).places)
      if (exclusions_[place] > 0) return false;
    return true;
  }

  /// `reduced`: of the paths added, together: what a cover costs more than the bound at least.
  void extend(double reduced) {
    if (nodes_left_ == 0) return;
    --nodes_left_;
    // The open item with the fewest ways on leaves the smallest tree.
    bool is_covered = true;
    std::vector<std::uint32_t> ways, others;
    for (const std::uint32_t item : open_) {
      if (state_[item] != State::open) continue;
      others.clear();
      for (const std::uint32_t c : problem_.ways_[item]) {
        if (reduced + problem_.reduced_[c] >= limit() || (!is_covered && others.size() == ways.size())) break;
        if (fits(c)) others.push_back(c);
      }
      if (is_covered || others.size() < ways.size()) ways.swap(others);
      is_covered = false;
      if (ways.size() <= 1) break;
    }
    if (is_covered) least_ = std::min(least_, cost_);
    for (const std::uint32_t c : ways) {
      if (reduced + problem_.reduced_[c] >= limit()) break;
      const std::size_t removed_before = removed_.size();
      add(c);
      extend(reduced + problem_.reduced_[c]);
      take_back(c, removed_before);
    }
  }

  double limit() const { return problem_.slack_ - CoverMargins::kMost + least_; }

  const CoverMargins& problem_;
  const std::function<bool(std::uint32_t)>& is_ruled_out_;
  std::vector<State> state_;         ///< of each item
  std::vector<int> exclusions_;      ///< of each place: how many of the paths added exclude it
  std::vector<std::uint32_t> open_;  ///< items that the paths removed held, taken again or not
  std::vector<std::uint32_t> removed_;
  double cost_ = 0.0;  ///< of the paths added, less that of the paths removed
  double least_ = CoverMargins::kMost;
  std::size_t nodes_left_ = kNodeLimit;
};

CoverMargins::CoverMargins(const PathCover& cover, std::span<const PathCandidate> candidates,
                           std::span<const std::vector<std::uint32_t>> excluded_by)
    : candidates_(candidates),
      excluded_by_(excluded_by),
      ways_(cover.prices.size()),
      path_of_item_(cover.prices.size()),
      paths_near_(excluded_by.size()) {
  for (const PathCandidate& candidate : candidates) {
    double reduced = candidate.cost;
    for (const std::uint32_t item : candidate.items) reduced -= cover.prices[item];
    slack_ -= std::min(reduced, 0.0);
    reduced_.push_back(std::max(reduced, 0.0));
  }
  for (const double price : cover.prices) slack_ -= price;
  for (const std::uint32_t c : cover.chosen) {
    slack_ += candidates[c].cost;
    for (const std::uint32_t item : candidates[c].items) path_of_item_[item] = c;
    for (const std::uint32_t place : candidates[c].places)
      for (const std::uint32_t excluded : excluded_by[place]) paths_near_[excluded].push_back(c);
  }
  for (std::uint32_t c = 0; c < candidates.size(); ++c)
    if (reduced_[c] < slack_)
      for (const std::uint32_t item : candidates[c].items) ways_[item].push_back(c);
  for (auto& ways : ways_)
    std::stable_sort(ways.begin(), ways.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return reduced_[a] < reduced_[b]; });
}

double CoverMargins::of_path(std::uint32_t candidate) const {
  return margin(candidate, [&](std::uint32_t c) { return c == candidate; });
}

double CoverMargins::of_pair(std::uint32_t item_a, std::uint32_t item_b) const {
  return margin(path_of_item_[item_a], [&](std::uint32_t c) {
    const PathNumbers& items = candidates_[c].items;
    const auto holds = [&](std::uint32_t item) { return std::find(items.begin(), items.end(), item) != items.end(); };
    return holds(item_a) && holds(item_b);
  });
}

double CoverMargins::margin(std::uint32_t removed, const std::function<bool(std::uint32_t)>& is_ruled_out) const {
  return std::max(Exchange(*this, is_ruled_out).least_cost(removed), 0.0);
}

}  // namespace tubebin::modeling
