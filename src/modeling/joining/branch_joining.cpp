#include "modeling/joining/branch_joining.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "modeling/joining/branch_cutting.hpp"
#include "modeling/joining/branch_links.hpp"
#include "modeling/joining/cover_margins.hpp"
#include "modeling/joining/tree_joiner.hpp"

namespace tubebin::modeling {
namespace {

/// A link is ruled out where the scan is e^9 times likelier without it.
constexpr double kLinkCostLimit = 9.0;
/// -log of how seldom (1 in 8) a branch whose start is in view is not fitted up to the other path's side.
constexpr double kUnfittedCost = 2.1;

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

/// Paths that may branch off each other.
struct Branching {
  std::vector<TubePath> paths;    ///< cut back to the tubes that they run through
  std::vector<TubePiece> pieces;  ///< the same, as what is joined
  std::vector<PieceEnd> ends;
  std::vector<BranchLink> links;  ///< cheaper than the limit, cheapest first

  Branching(std::vector<TubePath> uncut, double radius, const OcclusionTest& occlusion, double cost_limit)
      : paths(std::move(uncut)) {
    cut_ends_beyond_others(paths, radius);
    for (const TubePath& path : paths) pieces.push_back({.nodes = path.nodes, .radius = radius, .points = {}});
    ends = find_piece_ends(pieces, occlusion, 40.0 * radius);
    links = find_branch_links(pieces, ends, occlusion, cost_limit);
  }

  TreeJoiner joiner() const { return {pieces, ends, links, pieces.front().radius}; }
};

}  // namespace

BranchedTubes join_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion,
                            double tube_length) {
  if (paths.empty()) return {};
  Branching branching(std::move(paths), radius, occlusion, kLinkCostLimit);
  TreeJoiner joiner = branching.joiner();
  BranchedTubes joining{.tubes = {}, .tube_length = tube_length > 0.0 ? tube_length : joiner.common_length()};
  std::vector<Tree> trees;
  if (joining.tube_length > 0.0) {
    trees = joiner.trees_of_length(joining.tube_length);
  } else {
    const double whole = recurring_length(branching.pieces);
    std::erase_if(branching.links, [&](const BranchLink& link) { return links_whole(link, branching.pieces, whole); });
    joiner = branching.joiner();
    trees = joiner.likely_trees(0.0);
  }
  for (const Tree& tree : trees) joining.tubes.push_back(joiner.tube_of(tree, branching.paths));
  return joining;
}

BranchedTubes join_likely_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion,
                                   double tube_length) {
  if (paths.empty()) return {};
  Branching branching(std::move(paths), radius, occlusion, 0.0);
  const std::vector<TubePiece>& pieces = branching.pieces;
  std::vector<BranchLink>& links = branching.links;
  const double whole = tube_length > 0.0 ? tube_length : recurring_length(pieces);
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
  if (links.size() == 1 && is_chance(links.front()) && are_of_few_lengths(pieces, branching.ends)) links.clear();
  const TreeJoiner joiner = branching.joiner();
  BranchedTubes joining;
  for (Tree& tree : joiner.likely_trees(0.0)) {
    tree.whole_odds = tree.links.empty() ? CoverMargins::kMost : std::ranges::min(tree.link_odds);
    joining.tubes.push_back(joiner.tube_of(tree, branching.paths));
  }
  return joining;
}

}  // namespace tubebin::modeling
