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

/// The likeliest link of each path: a branch starts at one of its ends.
void keep_one_of_each_branch(std::vector<BranchLink>& links) {
  std::set<std::uint32_t> branches;
  std::erase_if(links, [&](const BranchLink& link) { return !branches.insert(link.end / 2).second; });
}

/// A tube that runs across another one, and seems to end on both of its sides, is no two branches.
void drop_crossings(std::vector<BranchLink>& links, const std::vector<PieceEnd>& ends, double radius) {
  const auto go_on_as_each_other = [&](const BranchLink& a, const BranchLink& b) {
    return a.other == b.other && faces(ends[a.end], ends[b.end], radius);
  };
  std::vector<BranchLink> kept;
  for (const BranchLink& link : links)
    if (std::ranges::none_of(links, [&](const BranchLink& other) { return go_on_as_each_other(link, other); }))
      kept.push_back(link);
  links = std::move(kept);
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
                                   double tube_length, double longest) {
  if (paths.empty()) return {};
  Branching branching(std::move(paths), radius, occlusion, 0.0);
  const std::vector<TubePiece>& pieces = branching.pieces;
  std::vector<BranchLink>& links = branching.links;
  const double whole = tube_length > 0.0 ? tube_length : recurring_length(pieces);
  for (const Tree& tree : branching.joiner().likely_trees(kOnSideCost / 2.0)) longest = std::max(longest, tree.length);
  const auto is_too_long = [&](const BranchLink& link) {
    const double length = pieces[link.end / 2].length() + pieces[link.other].length();
    return length > std::min(whole, longest) + 2.0 * radius && (tube_length > 0.0 || link.cost > kOnSideCost);
  };
  const auto is_no_branch = [&](const BranchLink& link) {
    return link.other_end || link.cost >= 0.0 || !is_long(pieces[link.end / 2]) || links_whole(link, pieces, whole) ||
           is_too_long(link);
  };
  std::erase_if(links, is_no_branch);
  drop_crossings(links, branching.ends, radius);
  keep_one_of_each_branch(links);
  const TreeJoiner joiner = branching.joiner();
  BranchedTubes joining;
  for (Tree& tree : joiner.likely_trees(0.0)) {
    tree.whole_odds = tree.links.empty() ? CoverMargins::kMost : std::ranges::min(tree.link_odds);
    joining.tubes.push_back(joiner.tube_of(tree, branching.paths));
  }
  return joining;
}

}  // namespace tubebin::modeling
