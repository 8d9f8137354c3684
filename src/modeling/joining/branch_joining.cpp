#include "modeling/joining/branch_joining.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <queue>
#include <set>
#include <unordered_map>

#include "modeling/fitting/vote_voxels.hpp"
#include "modeling/joining/branch_cutting.hpp"
#include "modeling/joining/branch_links.hpp"
#include "modeling/joining/cover_margins.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// A link is ruled out where the scan is e^9 times likelier without it.
constexpr double kLinkCostLimit = 9.0;
/// A tube shorter than it should be can have other reasons than a missed link: e^-10.
constexpr double kTreeLengthCostLimit = 10.0;
/// Radii: each path's length is off by as much, where it is led up to another and where it bends out of sight. In set C trees
/// that are found whole are seldom too long (5 % of 1400 by over 1.9 radii), and often too short (5 % by over 10.7).
constexpr double kExcessScatter = 1.25, kLackScatter = 2.5;

/// -log of how seldom (1 in 20) the trees of a scene are of any length.
constexpr double kNoLengthCost = 3.0;

/// -log of how seldom (1 in 8) a branch whose start is in view is not fitted up to the other path's side.
constexpr double kUnfittedCost = 2.1;

/// How far a forest is searched for: roughly to tell lengths apart, thoroughly once the length is known.
struct Search {
  std::size_t trees_per_path, cover_nodes;
};
constexpr Search kRough{.trees_per_path = 20, .cover_nodes = 50};
constexpr Search kThorough{.trees_per_path = 1000, .cover_nodes = 2000};

/// A tube under construction: paths that links hold together.
struct Tree {
  PathNumbers paths = {};
  PathNumbers links = {};
  PathNumbers used_ends = {};
  std::uint64_t key = 0;  ///< the paths' keys, xor: the same for the same paths in any order (Zobrist 1970)
  double link_cost = 0.0;
  double cost = 0.0;                      ///< with what its length says
  double length = 0.0;                    ///< of paths and links, metres
  std::optional<double> whole_odds = {};  ///< as TubeModel has them
  std::vector<double> link_odds = {};     ///< of the links, as TubePath::bridge_odds

  bool holds(std::uint32_t path) const { return std::find(paths.begin(), paths.end(), path) != paths.end(); }
  bool uses(std::uint32_t end) const { return std::find(used_ends.begin(), used_ends.end(), end) != used_ends.end(); }
};

/// Trees that together hold each path once, chosen from the possible ones.
struct Forest {
  std::vector<Tree> possible;
  std::vector<PathCandidate> candidates;  ///< the possible trees as sets of paths
  PathCover cover;
};

class TreeJoiner {
 public:
  TreeJoiner(const std::vector<TubePiece>& paths, std::vector<PieceEnd> ends, std::vector<BranchLink> links,
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

  /// Every link that is likelier than not, cheapest first, unless its paths hang together already: a spanning forest
  /// of least cost (Kruskal 1956).
  std::vector<Tree> likely_trees(double cost_limit) const {
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
  std::vector<double> possible_lengths() const {
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
  double cost_of_length(const Forest& forest, double tube_length) const {
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
  Forest cheapest_forest(double tube_length, const Search& search) {
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

  /// Of the possible lengths, that which explains the scan best, metres; 0 where tubes of any length do.
  double common_length() {
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

  /// The forest's trees, with their odds.
  std::vector<Tree> trees_of(const Forest& forest) const {
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

  TubeModel tube_of(const Tree& tree, const std::vector<TubePath>& paths) const {
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

 private:
  static void lead_up(TubePath& path, const BranchLink& link, double odds) {
    const bool last = link.end % 2 == 1;
    path.nodes.insert(last ? path.nodes.end() : path.nodes.begin(), link.place);
    path.bridged.insert(last ? path.bridged.end() : path.bridged.begin(), true);
    path.bridge_odds.insert(last ? path.bridge_odds.end() : path.bridge_odds.begin(), odds);
  }

  void add_link(Tree& tree, std::uint32_t l) const {
    tree.links.push_back(l);
    tree.used_ends.push_back(links_[l].end);
    if (links_[l].other_end) tree.used_ends.push_back(*links_[l].other_end);
    tree.link_cost += links_[l].cost;
    tree.length += links_[l].length;
  }

  /// Whether every end that leads to no path is in sight.
  bool is_seen(const Tree& tree) const {
    return std::all_of(tree.paths.begin(), tree.paths.end(), [&](std::uint32_t p) {
      return (tree.uses(2 * p) || ends_[2 * p].seen_free > 0.5) &&
             (tree.uses(2 * p + 1) || ends_[2 * p + 1].seen_free > 0.5);
    });
  }

  double length_sigma(double scatter, std::size_t paths) const {
    return scatter * radius_ * std::sqrt(static_cast<double>(paths));
  }

  /// How far a tree's length is from the one that is searched for, standard deviations; negative where it exceeds it.
  double lack_in_sigmas(double missing, std::size_t paths) const {
    return missing / length_sigma(missing < 0.0 ? kExcessScatter : kLackScatter, paths);
  }

  double length_cost(const Tree& tree) const {
    const double missing = tube_length_ - tree.length;
    double room = 0.0;
    for (const std::uint32_t p : tree.paths)
      for (const std::uint32_t end : {2 * p, 2 * p + 1})
        if (!tree.uses(end) && ends_[end].seen_free < 0.5) room += ends_[end].hidden_reach + radius_;
    const double unexplained = missing < 0.0 ? missing : std::max(missing - room, 0.0);
    const double lack = lack_in_sigmas(unexplained, tree.paths.size());
    return std::min(0.5 * lack * lack, kTreeLengthCostLimit);
  }

  /// A tree and a link that leads from it to a further path.
  struct Growth {
    double link_cost;
    std::size_t tree;
    std::uint32_t link, path;
    bool operator>(const Growth& other) const { return link_cost > other.link_cost; }
  };

  /// Keeps the trees that hold the path, those of the likeliest links first. A path longer than the tubes' common length
  /// stands alone: a wrong length deletes nothing.
  void grow(const Tree& single, std::size_t trees_per_path) {
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

  Tree grown_tree(Tree tree, const Growth& growth) const {
    add_link(tree, growth.link);
    tree.paths.push_back(growth.path);
    tree.key ^= keys_[growth.path];
    tree.length += singles_[growth.path].length;
    return tree;
  }

  bool may_grow(const Tree& tree, std::uint32_t l, std::uint32_t next) const {
    const BranchLink& link = links_[l];
    const double length = tree.length + link.length + singles_[next].length;
    return !tree.holds(next) && !tree.uses(link.end) && !(link.other_end && tree.uses(*link.other_end)) &&
           lack_in_sigmas(tube_length_ - length, tree.paths.size() + 1) >= -4.0;
  }

  /// Whether no cheaper tree has the same paths.
  bool keep_if_cheapest(const Tree& tree) {
    const auto [entry, added] = tree_of_key_.try_emplace(tree.key, trees_.size());
    const double cost = tree.link_cost + length_cost(tree);
    if (!added && trees_[entry->second].cost <= cost) return false;
    if (added) trees_.emplace_back();
    trees_[entry->second] = tree;
    trees_[entry->second].cost = cost;
    return true;
  }

  double radius_;
  double tube_length_ = 0.0;  ///< of the forest that is searched for, metres
  std::vector<PieceEnd> ends_;
  std::vector<BranchLink> links_;  ///< cheapest first
  std::vector<std::vector<std::uint32_t>> links_of_path_;
  std::vector<std::uint64_t> keys_;
  std::vector<Tree> singles_;  ///< each path alone
  std::vector<Tree> trees_;
  std::unordered_map<std::uint64_t, std::size_t> tree_of_key_;
};

/// The longest length that three of the paths have to a radius, and no less of all that is seen than what is longer: else
/// arms of forks are alike by chance. Infinite where there is none.
double recurring_length(const std::vector<TubePiece>& paths) {
  std::vector<double> lengths;
  for (const TubePiece& path : paths) lengths.push_back(path.length());
  std::sort(lengths.begin(), lengths.end(), std::greater<>());
  double longer = 0.0;
  for (std::size_t k = 2; k < lengths.size(); ++k) {
    if (lengths[k - 2] - lengths[k] <= paths.front().radius)
      return 3.0 * lengths[k - 1] >= longer ? lengths[k - 1] : std::numeric_limits<double>::infinity();
    longer += lengths[k - 2];
  }
  return std::numeric_limits<double>::infinity();
}

/// Whether one of the paths has the length that makes it a tube by itself, metres.
bool links_whole(const BranchLink& link, const std::vector<TubePiece>& paths, double whole) {
  const auto is_whole = [&](const TubePiece& path) { return std::abs(path.length() - whole) <= path.radius; };
  return is_whole(paths[link.end / 2]) || is_whole(paths[link.other]);
}

/// Whether another path is as long, to a radius.
bool shares_length(const TubePiece& path, const std::vector<TubePiece>& paths) {
  const auto is_as_long = [&](const TubePiece& other) {
    return std::abs(other.length() - path.length()) <= path.radius;
  };
  return std::ranges::count_if(paths, is_as_long) > 1;
}

/// Whether nine tenths of what is seen from end to end are paths that share their lengths: the scene's tubes are of a few.
bool are_of_few_lengths(const std::vector<TubePiece>& paths, const std::vector<PieceEnd>& ends) {
  double seen = 0.0, shared = 0.0;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    if (ends[2 * k].seen_free < 0.5 || ends[2 * k + 1].seen_free < 0.5) continue;
    seen += paths[k].length();
    if (shares_length(paths[k], paths)) shared += paths[k].length();
  }
  return shared > 0.0 && shared >= 0.9 * seen;
}

/// The likeliest link of each path: a branch starts at one of its ends.
void keep_one_of_each_branch(std::vector<BranchLink>& links) {
  std::set<std::uint32_t> branches;
  std::erase_if(links, [&](const BranchLink& link) { return !branches.insert(link.end / 2).second; });
}

std::vector<TubePiece> pieces_of(const std::vector<TubePath>& paths, double radius) {
  std::vector<TubePiece> pieces;
  for (const TubePath& path : paths) pieces.push_back({.nodes = path.nodes, .radius = radius, .points = {}});
  return pieces;
}

}  // namespace

std::vector<TubeModel> join_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion,
                                     double tube_length) {
  if (paths.empty()) return {};
  cut_ends_beyond_others(paths, radius);
  const std::vector<TubePiece> pieces = pieces_of(paths, radius);
  std::vector<PieceEnd> ends = find_piece_ends(pieces, occlusion, 40.0 * radius);
  std::vector<BranchLink> links = find_branch_links(pieces, ends, occlusion, kLinkCostLimit);
  TreeJoiner joiner(pieces, ends, links, radius);
  const double length = tube_length > 0.0 ? tube_length : joiner.common_length();
  std::vector<Tree> trees;
  if (length > 0.0) {
    trees = joiner.trees_of(joiner.cheapest_forest(length, kThorough));
  } else {
    const double whole = recurring_length(pieces);
    std::erase_if(links, [&](const BranchLink& link) { return links_whole(link, pieces, whole); });
    joiner = TreeJoiner(pieces, std::move(ends), std::move(links), radius);
    trees = joiner.likely_trees(0.0);
  }
  std::vector<TubeModel> tubes;
  for (const Tree& tree : trees) tubes.push_back(joiner.tube_of(tree, paths));
  return tubes;
}

std::vector<TubeModel> join_likely_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion,
                                            double tube_length) {
  if (paths.empty()) return {};
  cut_ends_beyond_others(paths, radius);
  const std::vector<TubePiece> pieces = pieces_of(paths, radius);
  const double whole = tube_length > 0.0 ? tube_length : recurring_length(pieces);
  std::vector<PieceEnd> ends = find_piece_ends(pieces, occlusion, 40.0 * radius);
  std::vector<BranchLink> links = find_branch_links(pieces, ends, occlusion, 0.0);
  const auto is_no_branch = [&](const BranchLink& link) {
    const TubePiece &branch = pieces[link.end / 2], &trunk = pieces[link.other];
    return link.other_end || link.cost >= 0.0 || !is_long(branch) || links_whole(link, pieces, whole) ||
           ((tube_length > 0.0 || link.cost > kOnSideCost) && branch.length() + trunk.length() > whole + 2.0 * radius);
  };
  for (BranchLink& link : links) link.cost += kUnfittedCost * link.in_view;
  std::ranges::sort(links, {}, &BranchLink::cost);
  std::erase_if(links, is_no_branch);
  keep_one_of_each_branch(links);
  // Among tubes of a few lengths, a single one that is not sure is as likely chance.
  const auto is_chance = [&](const BranchLink& link) {
    return link.cost > kOnSideCost &&
           (shares_length(pieces[link.end / 2], pieces) || shares_length(pieces[link.other], pieces));
  };
  if (links.size() == 1 && is_chance(links.front()) && are_of_few_lengths(pieces, ends)) links.clear();
  const TreeJoiner joiner(pieces, std::move(ends), std::move(links), radius);
  std::vector<TubeModel> tubes;
  for (Tree& tree : joiner.likely_trees(0.0)) {
    tree.whole_odds = tree.links.empty() ? CoverMargins::kMost : std::ranges::min(tree.link_odds);
    tubes.push_back(joiner.tube_of(tree, paths));
  }
  return tubes;
}

}  // namespace tubebin::modeling
