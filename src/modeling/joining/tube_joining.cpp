#include "modeling/joining/tube_joining.hpp"

#include <algorithm>
#include <cmath>
#include <ext/pb_ds/assoc_container.hpp>
#include <numbers>
#include <tuple>

#include "modeling/joining/boxed_curve.hpp"
#include "modeling/joining/path_cover.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// -log of the part of tube ends that happen to lie hidden in a pile: about a third.
constexpr double kHiddenEndCost = 1.0;
/// A tube shorter than it should be can have other reasons than a missed join (a stretch too narrow to segment, a
/// length that is not common to all), one that is longer other reasons than a wrong join (an end that is drawn out
/// beyond a flat end): e^-10.
constexpr double kLengthCostLimit = 10.0;
/// A fragment that no tube explains is as likely chance as not: e^-3.
constexpr double kFragmentCostLimit = 3.0;
/// A join is ruled out where the scan is e^7 times likelier without it.
constexpr double kJoinCostLimit = 7.0;
/// And clear where it is e^2 times likelier with it.
constexpr double kClearJoinCost = -2.0;
constexpr std::size_t kPossibleLengths = 4;
constexpr std::size_t kNodeLimit = 1000;
/// The right join is among an end's cheapest few, or it could not be told from chance anyhow.
constexpr std::size_t kJoinsPerEnd = 4;
constexpr std::size_t kPathLimit = 200;

/// A chain of pieces under construction: enters its last piece at one end and may leave it by the other.
struct Chain {
  PathCandidate
      path;  ///< its items: the pieces in order, each followed by the fragments absorbed on the way to it; its
             ///< places: the joins
  PathNumbers pieces;
  std::uint32_t first_end = 0;  ///< where the tube starts
  std::uint32_t last_end = 0;   ///< where it ends so far
  std::uint64_t key = 0;        ///< the items' keys, xor: the same for the same items in any order (Zobrist 1970)
  double join_cost = 0.0;
  double length = 0.0;   ///< of pieces and bridges, metres
  double bridged = 0.0;  ///< of bridges alone, metres
};

class Joiner {
 public:
  Joiner(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion, double tube_length)
      : pieces_(pieces), occlusion_(occlusion), tube_length_(tube_length), radius_(pieces.front().radius) {
    for (const TubePiece& piece : pieces) {
      lengths_.push_back(piece.length());
      piece_keys_.push_back(derive_seed({piece_keys_.size()}));
    }
    bending_rate_ = estimate_bending_rate(pieces, radius_);
    ends_ = find_piece_ends(pieces, occlusion, 40.0 * radius_);
    decide_whether_tubes_branch();
    pairs_ = find_possible_joins(pieces, ends_, occlusion, bending_rate_, kJoinCostLimit);
    find_joins();
  }

  /// The joins of the best cover under the current tube length.
  void solve() {
    chains_.clear();
    chain_of_key_.clear();
    for (std::uint32_t end = 0; end < ends_.size(); ++end) {
      budget_ = kPathLimit;
      Chain chain;
      chain.path.items = {end / 2};
      chain.pieces = {end / 2};
      chain.key = piece_keys_[end / 2];
      chain.first_end = end;
      chain.last_end = end ^ 1U;
      chain.length = lengths_[end / 2];
      is_taken_.assign(pieces_.size(), false);
      is_taken_[end / 2] = true;
      extend(chain);
    }
    drop_dominated();
    std::vector<PathCandidate> paths;
    for (const Chain& chain : chains_) paths.push_back(chain.path);
    std::vector<Chain> chosen;
    for (const std::uint32_t c : cheapest_path_cover(pieces_.size(), paths, collides_, kNodeLimit))
      chosen.push_back(std::move(chains_[c]));
    chains_ = std::move(chosen);
  }

  /// The lengths of the tubes with both ends in sight, shortest first. Bits of surface have no tube's length.
  std::vector<double> seen_lengths() const {
    std::vector<double> seen;
    for (const Chain& chain : chains_)
      if (chain.length >= 2.0 * radius_ && ends_[chain.first_end].seen_free > 0.5 &&
          ends_[chain.last_end].seen_free > 0.5)
        seen.push_back(chain.length);
    std::sort(seen.begin(), seen.end());
    return seen;
  }

  /// Lengths that tubes in sight from end to end agree on: those of the most tube, summed up over them, first.
  std::vector<double> possible_lengths() const {
    const std::vector<double> seen = seen_lengths();
    std::vector<std::pair<double, double>> of_support;
    for (std::size_t first = 0; first < seen.size(); ++first) {
      std::size_t last = first;
      double sum = 0.0;
      while (last < seen.size() && seen[last] <= seen[first] + length_tolerance()) sum += seen[last++];
      of_support.emplace_back(sum, seen[first + (last - first) / 2]);
    }
    std::sort(of_support.begin(), of_support.end(), std::greater<>());
    std::vector<double> lengths;
    for (const auto& [support, length] : of_support) {
      if (lengths.size() == kPossibleLengths) break;
      if (std::find(lengths.begin(), lengths.end(), length) == lengths.end()) lengths.push_back(length);
    }
    return lengths;
  }

  /// What speaks against the chains, nats. One that all lengths up to the common one are as likely for has it but once
  /// in length / (sqrt(2 pi) sigma).
  double cost() const {
    double cost = 0.0;
    for (const Chain& chain : chains_) {
      cost += chain.path.cost;
      const double sigma = length_sigma(chain.bridged);
      if (tube_length_ > 0.0 && std::abs(chain.length - tube_length_) <= 2.0 * sigma)
        cost -= std::log(tube_length_ / (std::sqrt(2.0 * std::numbers::pi) * sigma));
    }
    return cost;
  }

  /// No tube becomes much longer than those that likely joins make.
  void solve_with_longest_length() {
    if (tubes_branch_) return;  // chains are parts of them
    longest_likely_ = std::ranges::max(chains_, {}, &Chain::length).length;
    find_joins();
    solve();
  }

  /// Once the tubes' common length is known, joins that complete a tube are likelier and those that exceed it ruled
  /// out. They have one where it explains the scan better than tubes of any length do.
  void solve_with_common_length() {
    if (tubes_branch_) return;  // chains are parts of them
    const std::vector<double> lengths = possible_lengths();
    if (lengths.empty()) return;
    auto best = std::tuple(cost(), 0.0, chains_, joins_);
    tube_length_ = std::ranges::max(lengths);
    find_joins();  // of the longest, and so those of the others too
    for (const double length : lengths) {
      tube_length_ = length;
      solve();
      if (cost() < std::get<0>(best)) best = std::tuple(cost(), length, chains_, joins_);
    }
    std::tie(std::ignore, tube_length_, chains_, joins_) = best;
  }

  Joining result() const {
    Joining joining{.paths = {}, .tube_length = tube_length_, .tubes_branch = tubes_branch_};
    for (const Chain& chain : chains_) {
      const bool is_branch = ends_[chain.first_end].is_on_side || ends_[chain.last_end].is_on_side;
      if (chain.length >= (is_branch ? 1.0 : 2.0) * radius_) joining.paths.push_back(path_of(chain));
    }
    return joining;
  }

 private:
  double longest() const {
    const double length = tube_length_ > 0.0 ? tube_length_ : longest_likely_;
    return length + 5.0 * length_sigma(length / 4.0);
  }

  /// Ends are placed to a fraction of a radius, and a bridge's true course may be a twentieth longer.
  double length_sigma(double bridged) const { return std::sqrt(radius_ * radius_ / 16.0 + bridged * bridged / 400.0); }

  double length_tolerance() const { return 4.0 * length_sigma(0.0); }

  double end_cost(std::uint32_t end) const { return kHiddenEndCost * (1.0 - ends_[end].seen_free); }

  double length_cost(const Chain& chain) const {
    if (tube_length_ <= 0.0) return 0.0;
    const double missing = tube_length_ - chain.length;
    double room = 0.0;
    for (const std::uint32_t end : {chain.first_end, chain.last_end})
      if (ends_[end].seen_free < 0.5) room += ends_[end].hidden_reach + radius_;
    const double sigma = length_sigma(chain.bridged);
    const double unexplained = missing < 0.0 ? missing : std::max(missing - room, 0.0);
    const bool fragment = missing >= 0.0 && chain.pieces.size() == 1 && is_fragment(pieces_[chain.pieces.front()]);
    return std::min(0.5 * unexplained * unexplained / (sigma * sigma),
                    fragment ? kFragmentCostLimit : kLengthCostLimit);
  }

  void extend(Chain& chain) {
    if (budget_ == 0) return;
    --budget_;
    // Each chain is found from both sides: the one that starts at the lower end counts.
    if (chain.first_end < chain.last_end) keep_if_cheapest(chain);
    for (const std::uint32_t j : joins_of_end_[chain.last_end]) {
      const std::uint32_t entered = joins_[j].end_a == chain.last_end ? joins_[j].end_b : joins_[j].end_a;
      const auto taken = [&](std::uint32_t k) { return is_taken_[k]; };
      if (taken(entered / 2) || std::any_of(joins_[j].absorbed.begin(), joins_[j].absorbed.end(), taken)) continue;
      if (chain.length + bridge_lengths_[j] + lengths_[entered / 2] > longest()) continue;
      const std::uint32_t left = chain.last_end;
      append(chain, j, entered);
      extend(chain);
      take_back(chain, j, left);
    }
  }

  void append(Chain& chain, std::uint32_t join, std::uint32_t entered) {
    const std::uint32_t piece = entered / 2;
    const auto& absorbed = joins_[join].absorbed;
    chain.pieces.push_back(piece);
    chain.path.places.push_back(join);
    chain.path.items.push_back(piece);
    chain.path.items.insert(chain.path.items.end(), absorbed.begin(), absorbed.end());
    mark(piece, absorbed, true);
    chain.key ^= key_of(piece, absorbed);
    chain.last_end = entered ^ 1U;
    chain.join_cost += joins_[join].cost;
    chain.length += bridge_lengths_[join] + lengths_[piece];
    chain.bridged += bridge_lengths_[join];
  }

  void take_back(Chain& chain, std::uint32_t join, std::uint32_t left) {
    const std::uint32_t piece = chain.pieces.back();
    const auto& absorbed = joins_[join].absorbed;
    chain.pieces.pop_back();
    chain.path.places.pop_back();
    chain.path.items.resize(chain.path.items.size() - 1 - absorbed.size());
    mark(piece, absorbed, false);
    chain.key ^= key_of(piece, absorbed);
    chain.last_end = left;
    chain.join_cost -= joins_[join].cost;
    chain.length -= bridge_lengths_[join] + lengths_[piece];
    chain.bridged -= bridge_lengths_[join];
  }

  void mark(std::uint32_t piece, const std::vector<std::uint32_t>& absorbed, bool taken) {
    is_taken_[piece] = taken;
    for (const std::uint32_t fragment : absorbed) is_taken_[fragment] = taken;
  }

  std::uint64_t key_of(std::uint32_t piece, const std::vector<std::uint32_t>& absorbed) const {
    std::uint64_t key = piece_keys_[piece];
    for (const std::uint32_t fragment : absorbed) key ^= piece_keys_[fragment];
    return key;
  }

  /// Of the chains that hold the same pieces, no best cover needs any but the cheapest.
  void keep_if_cheapest(Chain& chain) {
    chain.path.cost = chain.join_cost + length_cost(chain) + end_cost(chain.first_end) + end_cost(chain.last_end);
    const auto [entry, added] = chain_of_key_.insert({chain.key, chains_.size()});
    if (added) {
      chains_.push_back(chain);
    } else if (chain.path.cost < chains_[entry->second].path.cost) {
      chains_[entry->second] = chain;
    }
  }

  /// No best cover needs a chain that costs no less than its two parts do when cut at one of its joins.
  void drop_dominated() {
    const auto cost_of = [&](std::uint64_t key) {
      const auto entry = chain_of_key_.find(key);
      return entry == chain_of_key_.end() ? std::numeric_limits<double>::infinity() : chains_[entry->second].path.cost;
    };
    const auto better_cut = [&](const Chain& chain) {
      std::uint64_t front = 0;
      for (std::size_t cut = 0; cut < chain.path.places.size(); ++cut) {
        front ^= piece_keys_[chain.pieces[cut]];
        double cost = 0.0;
        std::uint64_t between = 0;
        for (const std::uint32_t fragment : joins_[chain.path.places[cut]].absorbed) {
          between ^= piece_keys_[fragment];
          cost += cost_of(piece_keys_[fragment]);
        }
        if (cost + cost_of(front) + cost_of(chain.key ^ front ^ between) <= chain.path.cost) return true;
        front ^= between;
      }
      return false;
    };
    std::vector<bool> is_dominated;
    for (const Chain& chain : chains_) is_dominated.push_back(better_cut(chain));
    std::vector<Chain> kept;
    for (std::size_t c = 0; c < chains_.size(); ++c)
      if (!is_dominated[c]) kept.push_back(std::move(chains_[c]));
    chains_ = std::move(kept);
  }

  /// Where tubes branch, one in thirty pieces shows it, and more than one: what meets another's side is as long as two
  /// diameters, longer than the bits of surface beside bends. Of chance one in three hundred does.
  void decide_whether_tubes_branch() {
    const auto pieces = std::count_if(pieces_.begin(), pieces_.end(), [](const auto& p) { return !is_fragment(p); });
    std::size_t branches = 0;
    for (std::uint32_t end = 0; end < ends_.size(); ++end)
      branches += ends_[end].is_on_side && lengths_[end / 2] >= 4.0 * radius_;
    tubes_branch_ = branches >= 2 && 30 * branches >= static_cast<std::size_t>(pieces);
    if (!tubes_branch_)
      for (PieceEnd& end : ends_) end.is_on_side = false;
  }

  /// Without a length to explain, a join is likelier than not by itself, or explains two ends out of sight once it is
  /// known how long tubes become. Where tubes branch, joins that are not clear are left to join_branches, which weighs
  /// them against branches.
  double cost_limit() const {
    if (tubes_branch_) return kClearJoinCost;
    if (tube_length_ > 0.0) return kJoinCostLimit;
    return std::isfinite(longest_likely_) ? 2.0 * kHiddenEndCost : 0.0;
  }

  void find_joins() {
    joins_ = find_join_candidates(pieces_, ends_, pairs_, occlusion_, bending_rate_,
                                  {.cost = cost_limit(), .length = longest(), .joins_per_end = kJoinsPerEnd});
    bridge_lengths_.clear();
    joins_of_end_.assign(ends_.size(), {});
    for (std::uint32_t j = 0; j < joins_.size(); ++j) {
      bridge_lengths_.push_back(polyline_length(joins_[j].bridge));
      for (const std::uint32_t end : {joins_[j].end_a, joins_[j].end_b}) joins_of_end_[end].push_back(j);
    }
    find_colliding_joins();
  }

  /// Two bridges of different tubes cannot occupy one place. Two of one end are no question: only one can be chosen.
  void find_colliding_joins() {
    collides_.assign(joins_.size(), {});
    std::vector<BoxedCurve> bridges;
    for (const JoinCandidate& join : joins_) bridges.emplace_back(join.bridge);
    for (std::uint32_t i = 0; i < joins_.size(); ++i)
      for (std::uint32_t j = 0; j < i; ++j)
        // Less than a radius apart is no matter of the bridges' uncertain course.
        if (!share_an_end(joins_[i], joins_[j]) && bridges[i].comes_nearer(bridges[j], radius_)) {
          collides_[i].push_back(j);
          collides_[j].push_back(i);
        }
  }

  static bool share_an_end(const JoinCandidate& i, const JoinCandidate& j) {
    return i.end_a == j.end_a || i.end_a == j.end_b || i.end_b == j.end_a || i.end_b == j.end_b;
  }

  TubePath path_of(const Chain& chain) const {
    TubePath path;
    std::uint32_t entered = chain.first_end;
    for (std::size_t k = 0; k < chain.pieces.size(); ++k) {
      auto nodes = pieces_[chain.pieces[k]].nodes;
      if (entered % 2 == 1) std::reverse(nodes.begin(), nodes.end());
      path.evidence += pieces_[chain.pieces[k]].evidence;
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (!path.nodes.empty()) path.bridged.push_back(n == 0);
        path.nodes.push_back(nodes[n]);
      }
      if (k == chain.path.places.size()) break;
      const JoinCandidate& join = joins_[chain.path.places[k]];
      path.bridge_odds.push_back(-join.cost);
      entered = join.end_a / 2 == chain.pieces[k + 1] ? join.end_a : join.end_b;
    }
    return path;
  }

  const std::vector<TubePiece>& pieces_;
  const OcclusionTest& occlusion_;
  double tube_length_;
  double longest_likely_ = std::numeric_limits<double>::infinity();  ///< of the tubes that likely joins alone make
  double radius_;
  double bending_rate_ = 0.0;
  std::vector<double> lengths_;
  std::vector<std::uint64_t> piece_keys_;
  std::vector<PieceEnd> ends_;
  bool tubes_branch_ = false;
  std::vector<PossibleJoin> pairs_;
  std::vector<JoinCandidate> joins_;
  std::vector<double> bridge_lengths_;  ///< of the joins, metres
  std::vector<std::vector<std::uint32_t>> joins_of_end_;
  std::vector<std::vector<std::uint32_t>> collides_;  ///< of each join: those whose bridges take up the same place
  std::vector<Chain> chains_;
  __gnu_pbds::gp_hash_table<std::uint64_t, std::size_t> chain_of_key_;  ///< while chains are found
  std::vector<char> is_taken_;  ///< of each piece: by the chain under construction
  std::size_t budget_ = 0;
};

}  // namespace

Joining join_pieces(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion, double tube_length) {
  if (pieces.empty()) return {.paths = {}, .tube_length = tube_length, .tubes_branch = false};
  Joiner joiner(pieces, occlusion, tube_length);
  joiner.solve();
  if (tube_length <= 0.0) {
    joiner.solve_with_longest_length();
    joiner.solve_with_common_length();
  }
  return joiner.result();
}

}  // namespace tubebin::modeling
