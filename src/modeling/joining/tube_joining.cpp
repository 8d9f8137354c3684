#include "modeling/joining/tube_joining.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/joining/branch_links.hpp"
#include "modeling/joining/chains.hpp"
#include "modeling/joining/common_shape.hpp"
#include "modeling/joining/cover_margins.hpp"
#include "modeling/joining/sampled_curve.hpp"
#include "modeling/joining/shape_joining.hpp"

namespace tubebin::modeling {
namespace {

/// A join is ruled out where the scan is e^7 times likelier without it.
constexpr double kJoinCostLimit = 7.0;
/// A common length L speaks for a join by log(1.6 L / r) at most (LengthModel::gain): of tubes 250 radii long.
constexpr double kMostLengthGain = 6.0;
/// And clear where it is e^2 times likelier with it.
constexpr double kClearJoinCost = -2.0;
/// The right join is among an end's cheapest few, or it could not be told from chance anyhow.
constexpr std::size_t kJoinsPerEnd = 4;
constexpr std::size_t kNodeLimit = 1000;
/// A second kind of part makes the scan e^40 times likelier or more where it shows; a part of the first kind that is seen in
/// part, and taken for a kind of its own, e^12 times at most (piles of five to fourteen rods).
constexpr double kFurtherShapeGain = 20.0;
/// Of all that is seen of tubes.
constexpr double kLeastExplained = 0.75;

/// What may be joined.
class JoinSearch {
 public:
  JoinSearch(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion)
      : pieces_(pieces),
        occlusion_(occlusion),
        bending_rate_(estimate_bending_rate(pieces, pieces.front().radius)),
        ends_(find_piece_ends(pieces, occlusion, 40.0 * pieces.front().radius)),
        tubes_branch_(show_branches(pieces, ends_)) {
    if (!tubes_branch_)
      for (PieceEnd& end : ends_) end.is_on_side = false;
    pairs_ = find_possible_joins(pieces, ends_, occlusion, bending_rate_, kJoinCostLimit + kMostLengthGain);
  }

  const std::vector<PieceEnd>& ends() const { return ends_; }
  bool tubes_branch() const { return tubes_branch_; }

  /// `chain_lengths`: as JoinLimits has them.
  PieceGraph graph(const LengthModel& lengths, std::vector<double> chain_lengths = {}) const {
    return {pieces_, ends_,
            find_join_candidates(pieces_, ends_, pairs_, occlusion_, bending_rate_,
                                 {.cost = cost_limit(lengths),
                                  .lengths = lengths,
                                  .joins_per_end = kJoinsPerEnd,
                                  .chain_lengths = std::move(chain_lengths)})};
  }

 private:
  /// Without a length to explain, a join is likelier than not by itself, or explains two ends out of sight once it is
  /// known how long tubes become. Where tubes branch, joins that are not clear are left to join_branches, which weighs
  /// them against branches.
  double cost_limit(const LengthModel& lengths) const {
    if (tubes_branch_) return kClearJoinCost;
    if (!lengths.common.empty()) return kJoinCostLimit;
    return std::isfinite(lengths.longest_likely) ? 2.0 * kHiddenEndCost : 0.0;
  }

  const std::vector<TubePiece>& pieces_;
  const OcclusionTest& occlusion_;
  double bending_rate_;
  std::vector<PieceEnd> ends_;
  bool tubes_branch_;
  std::vector<PossibleJoin> pairs_;
};

/// Chains that hold each piece once, the best under what is known of lengths.
struct Cover {
  PieceGraph graph;
  LengthModel lengths;
  std::vector<Chain> chains;
  std::vector<PathCandidate> paths;  ///< that it was chosen from
  PathCover choice;                  ///< of the paths, in the chains' order
};

Cover cheapest_cover(PieceGraph graph, const LengthModel& lengths) {
  std::vector<Chain> chains = find_chains(graph, lengths), chosen;
  std::vector<PathCandidate> paths;
  for (const Chain& chain : chains) paths.push_back(chain.path);
  PathCover choice = cheapest_path_cover(graph.pieces.size(), paths, graph.collisions, kNodeLimit);
  for (const std::uint32_t c : choice.chosen) chosen.push_back(std::move(chains[c]));
  return {std::move(graph), lengths, std::move(chosen), std::move(paths), std::move(choice)};
}

/// nats, of so many yes or no, as likely as they are in all: their entropy.
double entropy(double yes, double all) {
  double sum = 0.0;
  for (const double count : {yes, all - yes})
    if (count > 0.0) sum -= count * std::log(count / all);
  return sum;
}

/// What speaks against the cover, nats. How often a tube seems to have none of the common lengths, since the rest of it is
/// lost or is another's, the cover itself tells: in a crowded pile that is every second one. What is longer in one piece is
/// neither. Short chains may be no tubes, and tell nothing.
double cost_of(const Cover& cover) {
  constexpr double kOff = 2.0;  // nats, two standard deviations of length
  double cost = cover.lengths.cost_of_common_lengths(), off = 0.0, on = 0.0;
  for (const Chain& chain : cover.chains) {
    cost += chain.path.cost - cover.lengths.gain(chain.length, chain.bridged, chain.room);
    if (chain.length_cost <= kOff) {
      on += 1.0;
      continue;
    }
    if (chain.bridged == 0.0 && chain.length > std::ranges::max(cover.lengths.common)) continue;
    cost -= chain.length_cost;
    if (chain.length >= kShort * cover.lengths.radius) off += 1.0;
  }
  return cost + entropy(off, on + off);
}

/// The lengths of the tubes with both ends in sight. Bits of surface have no tube's length.
std::vector<double> seen_lengths(const Cover& cover) {
  const auto is_seen = [&](std::uint32_t end) { return cover.graph.ends[end].seen_free > 0.5; };
  std::vector<double> seen;
  for (const Chain& chain : cover.chains)
    if (chain.length >= 2.0 * cover.lengths.radius && is_seen(chain.first_end) && is_seen(chain.last_end))
      seen.push_back(chain.length);
  return seen;
}

/// Of each end.
std::vector<double> chain_lengths(const Cover& cover) {
  std::vector<double> lengths(cover.graph.ends.size(), std::numeric_limits<double>::infinity());
  for (const Chain& chain : cover.chains) lengths[chain.first_end] = lengths[chain.last_end] = chain.length;
  return lengths;
}

/// No tube becomes much longer than those that likely joins make.
Cover with_longest_length(const Cover& likely, const JoinSearch& search) {
  LengthModel lengths = likely.lengths;
  lengths.longest_likely = std::ranges::max(likely.chains, {}, &Chain::length).length;
  return cheapest_cover(search.graph(lengths), lengths);
}

/// Once the tubes' common length is known, or the few that they have, joins that complete a tube are likelier and those that
/// exceed it ruled out. They have one where it explains the scan better than tubes of any length do.
Cover with_common_length(Cover best, const JoinSearch& search) {
  LengthModel lengths = best.lengths;
  const std::vector<double> seen = seen_lengths(best), possible = lengths.possible_common(seen);
  if (possible.empty()) return best;
  lengths.common = possible;
  const PieceGraph graph = search.graph(lengths, chain_lengths(best));  // of the longest, and so of the others too
  std::vector<std::vector<double>> sets;
  for (const double length : possible) sets.push_back({length});
  if (const std::vector<double> recurring = lengths.recurring(seen); !recurring.empty()) sets.push_back(recurring);
  for (const std::vector<double>& set : sets) {
    lengths.common = set;
    Cover cover = cheapest_cover(graph, lengths);
    if (cost_of(cover) < cost_of(best)) best = std::move(cover);
  }
  return best;
}

std::vector<TubePath> paths_of(const Cover& cover) {
  const CoverMargins margins(cover.choice, cover.paths, cover.graph.collisions);
  std::vector<TubePath> paths;
  for (std::size_t k = 0; k < cover.chains.size(); ++k) {
    const Chain& chain = cover.chains[k];
    const bool is_branch = cover.graph.ends[chain.first_end].is_on_side || cover.graph.ends[chain.last_end].is_on_side;
    if (chain.length < (is_branch ? 1.0 : 2.0) * cover.lengths.radius) continue;
    TubePath& path = paths.emplace_back(path_of(chain, cover.graph));
    for (std::size_t n = 0; n + 1 < chain.pieces.size(); ++n)
      path.bridge_odds.push_back(margins.of_pair(chain.pieces[n], chain.pieces[n + 1]));
    path.whole_odds = margins.of_path(cover.choice.chosen[k]);
  }
  return paths;
}

/// The centrelines of the tubes that are seen for the most part, as far as they are seen.
std::vector<std::vector<Vec3>> seen_tubes(const Cover& cover) {
  std::vector<std::vector<Vec3>> tubes;
  for (const Chain& chain : cover.chains)
    if (chain.bridged < chain.length / 8.0) tubes.push_back(path_of(chain, cover.graph).nodes);
  return tubes;
}

/// Some of the shapes by their indices, and the copies of them that explain the scene best.
struct ShapeSet {
  std::vector<std::size_t> shapes;
  ShapeJoining joining;
};

/// The set with that further shape which explains the scene best.
ShapeSet with_further_shape(const ShapeSet& set, const ShapeSearch& search, std::size_t count) {
  ShapeSet best;
  for (std::size_t k = 0; k < count; ++k) {
    if (std::ranges::find(set.shapes, k) != set.shapes.end()) continue;
    std::vector<std::size_t> shapes = set.shapes;
    shapes.push_back(k);
    if (ShapeJoining joining = search.join(shapes); joining.gain > best.joining.gain)
      best = {std::move(shapes), std::move(joining)};
  }
  return best;
}

/// Copies of the shapes that the tubes have in common: of the one that explains the scene best, and of further ones where
/// these gain enough. None unless they explain it better than the cover does, and three quarters of all that is seen of tubes:
/// tubes that are bent at random may be alike where they bend little.
std::optional<ShapeJoining> with_common_shapes(const Cover& cover, const std::vector<TubePiece>& pieces,
                                               const OcclusionTest& occlusion) {
  const std::vector<std::vector<Vec3>> shapes = possible_shapes(seen_tubes(cover), pieces);
  if (shapes.empty()) return std::nullopt;
  const ShapeSearch search(pieces, shapes, occlusion, kLeastExplained);
  ShapeSet best, larger = with_further_shape({}, search, shapes.size());
  while (larger.joining.gain > best.joining.gain + kFurtherShapeGain) {
    best = std::move(larger);
    larger = with_further_shape(best, search, shapes.size());
  }
  const ShapeJoining& joining = best.joining;
  if (joining.gain < -cost_of(cover) || joining.explained < kLeastExplained) return std::nullopt;
  return std::move(best.joining);
}

/// Chains what the copies leave.
Joining with_rest(ShapeJoining joining, const OcclusionTest& occlusion, double tube_length) {
  std::ranges::move(join_pieces(joining.rest, occlusion, tube_length, false).paths, std::back_inserter(joining.paths));
  return {.paths = std::move(joining.paths),
          .lengths = std::move(joining.lengths),
          .are_copies = true,
          .explained = joining.explained};
}

}  // namespace

Joining join_pieces(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion, double tube_length,
                    bool tries_shape) {
  if (pieces.empty()) return {};
  const JoinSearch search(pieces, occlusion);
  LengthModel lengths{.radius = pieces.front().radius};
  if (tube_length > 0.0) lengths.common = {tube_length};
  Cover cover = cheapest_cover(search.graph(lengths), lengths);
  // Where tubes branch, chains are parts of them.
  if (tube_length <= 0.0 && !search.tubes_branch())
    cover = with_common_length(with_longest_length(cover, search), search);
  if (tries_shape) {
    if (auto alike = with_common_shapes(cover, pieces, occlusion))
      return with_rest(std::move(*alike), occlusion, tube_length);
  }
  return {.paths = paths_of(cover), .lengths = cover.lengths.common, .tubes_branch = search.tubes_branch()};
}

Joining join_pieces_by_shapes(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion,
                              std::span<const std::vector<Vec3>> centerlines) {
  if (pieces.empty()) return {};
  const double radius = pieces.front().radius;
  std::vector<std::vector<Vec3>> shapes;
  // As smooth as the pieces are that they are compared with.
  for (const std::vector<Vec3>& nodes : centerlines) shapes.push_back(smooth_samples(nodes, radius / 2.0, radius));
  return with_rest(join_by_shapes(pieces, shapes, occlusion), occlusion, 0.0);
}

}  // namespace tubebin::modeling
