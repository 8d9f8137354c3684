#include "modeling/joining/tree_joiner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "modeling/joining/cover_margins.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// A tube shorter than it should be can have other reasons than a missed link: e^-10.
constexpr double kTreeLengthCostLimit = 10.0;
/// Radii: each path's length is off by as much, where it is led up to another and where it bends out of sight. In set C trees
/// that are found whole are seldom too long (5 % of 1400 by over 1.9 radii), and often too short (5 % by over 10.7).
constexpr double kExcessScatter = 1.25, kLackScatter = 2.5;

/// -log of how seldom (1 in 20) the trees of a scene are of any length.
constexpr double kNoLengthCost = 3.0;

/// Roughly to tell lengths apart, thoroughly once the length is known.
constexpr ForestSearch kRough{.trees_per_path = 20, .cover_nodes = 50};
constexpr ForestSearch kThorough{.trees_per_path = 300, .cover_nodes = 2000};

void lead_up(TubePath& path, const BranchLink& link, double odds) {
  const auto lead_to = [&](const Vec3& place) {
    path.nodes.push_back(place);
    path.bridged.push_back(true);
    path.bridge_odds.push_back(odds);
  };
  const bool is_first_end = link.end % 2 == 0;
  if (is_first_end) turn_about(path);
  lead_to(link.place);
  if (link.on_path != link.place) lead_to(link.on_path);
  if (is_first_end) turn_about(path);
}

}  // namespace

/// A tree and a link that leads from it to a further path.
struct TreeJoiner::Growth {
  double link_cost;
  std::size_t tree;
  std::uint32_t link, path;
  bool operator>(const Growth& other) const { return link_cost > other.link_cost; }
};

TreeJoiner::TreeJoiner(const std::vector<TubePiece>& paths, std::vector<PieceEnd> ends, std::vector<BranchLink> links,
                       double radius)
    : radius_(radius), ends_(std::move(ends)), links_(std::move(links)) {
  links_of_path_.resize(paths.size());
  for (std::uint32_t l = 0; l < links_.size(); ++l)
    for (const std::uint32_t path : {links_[l].end / 2, links_[l].other}) links_of_path_[path].push_back(l);
  for (std::uint32_t p = 0; p < paths.size(); ++p) {
    keys_.push_back(derive_seed({p}));
    singles_.push_back({.paths = {p}, .key = keys_[p], .length = paths[p].length()});
  }
}

std::vector<Tree> TreeJoiner::likely_trees(double cost_limit) const {
  std::vector<Tree> trees = singles_;
  for (std::uint32_t l = 0; l < links_.size() && links_[l].cost < cost_limit; ++l) {
    const auto holds = [](std::uint32_t path) { return [path](const Tree& tree) { return tree.holds(path); }; };
    const auto a = std::find_if(trees.begin(), trees.end(), holds(links_[l].end / 2));
    const auto b = std::find_if(trees.begin(), trees.end(), holds(links_[l].other));
    if (a == b || a->uses(links_[l].end) || (links_[l].other_end && b->uses(*links_[l].other_end))) continue;
    add_link(*a, l);
    a->paths.insert(a->paths.end(), b->paths.begin(), b->paths.end());
    a->links.insert(a->links.end(), b->links.begin(), b->links.end());
    a->used_ends.insert(a->used_ends.end(), b->used_ends.begin(), b->used_ends.end());
    a->length += b->length;
    trees.erase(b);
  }
  for (Tree& tree : trees)
    for (const std::uint32_t l : tree.links) tree.link_odds.push_back(std::min(-links_[l].cost, CoverMargins::kMost));
  return trees;
}

/// Lengths that the tubes may have in common: those of trees that fairly sure links make, longest first. The surest
/// may leave trees apart, and those that are just likelier than not join too many.
std::vector<double> TreeJoiner::possible_lengths() const {
  std::vector<double> lengths;
  for (const double cost_limit : {kOnSideCost / 2.0, kOnSideCost / 4.0})
    for (const Tree& tree : likely_trees(cost_limit))
      if (tree.paths.size() > 1) lengths.push_back(tree.length);
  std::sort(lengths.begin(), lengths.end(), std::greater<>());
  std::vector<double> distinct;
  for (const double length : lengths)
    if (distinct.empty() || distinct.back() - length > kExcessScatter * radius_) distinct.push_back(length);
  return distinct;
}

/// What speaks against a common length with these trees, nats; infinite unless at least half of all tube is in trees
/// of that length. One that all lengths up to it are as likely for has it but once in length / (sqrt(2 pi) sigma).
double TreeJoiner::cost_of_length(const Forest& forest, double tube_length) const {
  double cost = 0.0, all = 0.0, as_long = 0.0;
  for (const std::uint32_t c : forest.cover.chosen) {
    const Tree& tree = forest.possible[c];
    all += tree.length;
    cost += tree.cost;
    if (std::abs(lack_in_sigmas(tube_length - tree.length, tree.paths.size())) > 2.0) continue;
    as_long += tree.length;
    const double sigma = length_sigma((kExcessScatter + kLackScatter) / 2.0, tree.paths.size());
    cost -= std::log(tube_length / (std::sqrt(2.0 * std::numbers::pi) * sigma));
  }
  return as_long >= all / 2.0 ? cost : std::numeric_limits<double>::infinity();
}

/// The cheapest forest where the tubes have this length, metres.
Forest TreeJoiner::cheapest_forest(double tube_length, const ForestSearch& search) {
  tube_length_ = tube_length;
  trees_.clear();
  tree_of_key_.clear();
  for (const Tree& tree : singles_) grow(tree, search.trees_per_path);
  std::vector<PathCandidate> candidates(trees_.size());
  for (std::size_t t = 0; t < trees_.size(); ++t) {
    candidates[t].items = trees_[t].paths;
    candidates[t].cost = trees_[t].cost;
  }
  PathCover cover = cheapest_path_cover(singles_.size(), candidates, {}, search.cover_nodes);
  return {.possible = std::move(trees_), .candidates = std::move(candidates), .cover = std::move(cover)};
}

double TreeJoiner::common_length() {
  double best = 0.0, least = kNoLengthCost;
  for (const Tree& tree : likely_trees(0.0)) least += tree.link_cost;
  for (const double length : possible_lengths()) {
    const double cost = cost_of_length(cheapest_forest(length, kRough), length);
    if (cost >= least) continue;
    least = cost;
    best = length;
  }
  return best;
}

std::vector<Tree> TreeJoiner::trees_of_length(double tube_length) {
  const Forest forest = cheapest_forest(tube_length, kThorough);
  const CoverMargins margins(forest.cover, forest.candidates, {});
  std::vector<Tree> trees;
  for (const std::uint32_t c : forest.cover.chosen) {
    Tree& tree = trees.emplace_back(forest.possible[c]);
    tree.whole_odds = margins.of_path(c);
    for (const std::uint32_t l : tree.links)
      tree.link_odds.push_back(margins.of_pair(links_[l].end / 2, links_[l].other));
  }
  return trees;
}

TubeModel TreeJoiner::tube_of(const Tree& tree, const std::vector<TubePath>& paths) const {
  TubeModel tube{.paths = {}, .radius = radius_, .whole_odds = tree.whole_odds};
  for (const std::uint32_t p : tree.paths) {
    tube.paths.push_back(paths[p]);
    if (tube.whole_odds)
      tube.whole_odds = std::min(*tube.whole_odds, paths[p].whole_odds.value_or(CoverMargins::kMost));
    for (std::size_t k = 0; k < tree.links.size(); ++k)
      if (const BranchLink& link = links_[tree.links[k]]; link.end / 2 == p)
        lead_up(tube.paths.back(), link, tree.link_odds[k]);
  }
  std::sort(tube.paths.begin(), tube.paths.end(),
            [](const TubePath& a, const TubePath& b) { return polyline_length(a.nodes) > polyline_length(b.nodes); });
  return tube;
}

void TreeJoiner::add_link(Tree& tree, std::uint32_t l) const {
  tree.links.push_back(l);
  tree.used_ends.push_back(links_[l].end);
  if (links_[l].other_end) tree.used_ends.push_back(*links_[l].other_end);
  tree.link_cost += links_[l].cost;
  tree.length += links_[l].length;
}

double TreeJoiner::length_sigma(double scatter, std::size_t paths) const {
  return scatter * radius_ * std::sqrt(static_cast<double>(paths));
}

/// How far a tree's length is from the one that is searched for, standard deviations; negative where it exceeds it.
double TreeJoiner::lack_in_sigmas(double missing, std::size_t paths) const {
  return missing / length_sigma(missing < 0.0 ? kExcessScatter : kLackScatter, paths);
}

double TreeJoiner::length_cost(const Tree& tree) const {
  const double missing = tube_length_ - tree.length;
  double room = 0.0;
  for (const std::uint32_t p : tree.paths)
    for (const std::uint32_t end : {2 * p, 2 * p + 1})
      if (!tree.uses(end) && ends_[end].seen_free < 0.5) room += ends_[end].hidden_reach + radius_;
  const double unexplained = missing < 0.0 ? missing : std::max(missing - room, 0.0);
  const double lack = lack_in_sigmas(unexplained, tree.paths.size());
  return std::min(0.5 * lack * lack, kTreeLengthCostLimit);
}

/// Keeps the trees that hold the path, those of the likeliest links first. A path longer than the tubes' common length
/// stands alone: a wrong length deletes nothing.
void TreeJoiner::grow(const Tree& single, std::size_t trees_per_path) {
  std::priority_queue<Growth, std::vector<Growth>, std::greater<>> growths;
  std::vector<Tree> grown = {single};
  while (true) {
    if (keep_if_cheapest(grown.back()))
      for (const std::uint32_t path : grown.back().paths)
        for (const std::uint32_t l : links_of_path_[path])
          if (const std::uint32_t next = links_[l].end / 2 == path ? links_[l].other : links_[l].end / 2;
              may_grow(grown.back(), l, next))
            growths.push({grown.back().link_cost + links_[l].cost, grown.size() - 1, l, next});
    if (growths.empty() || grown.size() == trees_per_path) return;
    grown.push_back(grown_tree(grown[growths.top().tree], growths.top()));
    growths.pop();
  }
}

Tree TreeJoiner::grown_tree(Tree tree, const Growth& growth) const {
  add_link(tree, growth.link);
  tree.paths.push_back(growth.path);
  tree.key ^= keys_[growth.path];
  tree.length += singles_[growth.path].length;
  return tree;
}

bool TreeJoiner::may_grow(const Tree& tree, std::uint32_t l, std::uint32_t next) const {
  const BranchLink& link = links_[l];
  const double length = tree.length + link.length + singles_[next].length;
  return !tree.holds(next) && !tree.uses(link.end) && !(link.other_end && tree.uses(*link.other_end)) &&
         lack_in_sigmas(tube_length_ - length, tree.paths.size() + 1) >= -4.0;
}

/// Whether no cheaper tree has the same paths.
bool TreeJoiner::keep_if_cheapest(const Tree& tree) {
  const auto [entry, added] = tree_of_key_.try_emplace(tree.key, trees_.size());
  const double cost = tree.link_cost + length_cost(tree);
  if (!added && trees_[entry->second].cost <= cost) return false;
  if (added) trees_.emplace_back();
  trees_[entry->second] = tree;
  trees_[entry->second].cost = cost;
  return true;
}

}  // namespace tubebin::modeling
