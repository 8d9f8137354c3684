#include "modeling/joining/chains.hpp"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/joining/join_candidates.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

constexpr std::size_t kChainsPerEnd = 200;

/// Follows the joins from every end, depth first.
class ChainSearch {
 public:
  ChainSearch(const PieceGraph& graph, const LengthModel& lengths)
      : graph_(graph), lengths_(lengths), longest_(lengths.longest()), is_taken_(graph.pieces.size(), false) {
    for (std::size_t k = 0; k < graph.pieces.size(); ++k) keys_.push_back(derive_seed({k}));
  }

  std::vector<Chain> find() {
    for (std::uint32_t end = 0; end < graph_.ends.size(); ++end) {
      const std::uint32_t piece = end / 2;
      Chain chain{.path = {.items = {piece}},
                  .pieces = {piece},
                  .first_end = end,
                  .last_end = end ^ 1U,
                  .key = keys_[piece],
                  .length = graph_.piece_lengths[piece]};
      chains_left_ = kChainsPerEnd;
      is_taken_[piece] = true;
      extend(chain);
      is_taken_[piece] = false;
    }
    return without_dominated();
  }

 private:
  void extend(Chain& chain) {
    if (chains_left_ == 0) return;
    --chains_left_;
    // Each chain is found from both sides: the one that starts at the lower end counts.
    if (chain.first_end < chain.last_end) keep_if_cheapest(chain);
    for (const std::uint32_t j : graph_.joins_of_end[chain.last_end]) {
      const JoinCandidate& join = graph_.joins[j];
      const std::uint32_t entered = join.end_a == chain.last_end ? join.end_b : join.end_a;
      const auto taken = [&](std::uint32_t k) { return is_taken_[k]; };
      if (taken(entered / 2) || std::any_of(join.absorbed.begin(), join.absorbed.end(), taken)) continue;
      if (chain.length + graph_.bridge_lengths[j] + graph_.piece_lengths[entered / 2] > longest_) continue;
      const std::uint32_t left = chain.last_end;
      append(chain, j, entered);
      extend(chain);
      take_back(chain, j, left);
    }
  }

  void append(Chain& chain, std::uint32_t j, std::uint32_t entered) {
    const std::uint32_t piece = entered / 2;
    const JoinCandidate& join = graph_.joins[j];
    chain.pieces.push_back(piece);
    chain.path.places.push_back(j);
    chain.path.items.push_back(piece);
    chain.path.items.insert(chain.path.items.end(), join.absorbed.begin(), join.absorbed.end());
    toggle(chain, piece, join);
    chain.last_end = entered ^ 1U;
    chain.join_cost += join.cost;
    chain.length += graph_.bridge_lengths[j] + graph_.piece_lengths[piece];
    chain.bridged += graph_.bridge_lengths[j];
  }

  void take_back(Chain& chain, std::uint32_t j, std::uint32_t left) {
    const std::uint32_t piece = chain.pieces.back();
    const JoinCandidate& join = graph_.joins[j];
    chain.pieces.pop_back();
    chain.path.places.pop_back();
    chain.path.items.resize(chain.path.items.size() - 1 - join.absorbed.size());
    toggle(chain, piece, join);
    chain.last_end = left;
    chain.join_cost -= join.cost;
    chain.length -= graph_.bridge_lengths[j] + graph_.piece_lengths[piece];
    chain.bridged -= graph_.bridge_lengths[j];
  }

  /// Takes, or gives back, the piece and the fragments on the way to it.
  void toggle(Chain& chain, std::uint32_t piece, const JoinCandidate& join) {
    const auto toggle_one = [&](std::uint32_t k) {
      is_taken_[k] ^= 1;
      chain.key ^= keys_[k];
    };
    toggle_one(piece);
    for (const std::uint32_t fragment : join.absorbed) toggle_one(fragment);
  }

  /// Of the chains that hold the same pieces, no best cover needs any but the cheapest.
  void keep_if_cheapest(Chain& chain) {
    chain.room = room_of(chain);
    chain.length_cost = length_cost(chain);
    chain.path.cost = chain.join_cost + chain.length_cost + end_cost(chain.first_end) + end_cost(chain.last_end);
    const auto [entry, added] = chain_of_key_.try_emplace(chain.key, chains_.size());
    if (added) chains_.push_back(chain);
    else if (chain.path.cost < chains_[entry->second].path.cost) chains_[entry->second] = chain;
  }

  double end_cost(std::uint32_t end) const { return kHiddenEndCost * (1.0 - graph_.ends[end].seen_free); }

  double room_of(const Chain& chain) const {
    double room = 0.0;
    for (const std::uint32_t end : {chain.first_end, chain.last_end})
      if (graph_.ends[end].seen_free < 0.5) room += graph_.ends[end].hidden_reach + lengths_.radius;
    return room;
  }

  double length_cost(const Chain& chain) const {
    const TubePiece& first = graph_.pieces[chain.pieces.front()];
    return lengths_.cost(
        chain.length, chain.bridged, chain.room,
        chain.pieces.size() == 1 && (is_fragment(first) || is_doubtful(first.length(), first.radius, first.evidence)));
  }

  /// No best cover needs a chain that costs no less than its two parts do when cut at one of its joins.
  std::vector<Chain> without_dominated() {
    std::vector<bool> dominated;
    for (const Chain& chain : chains_) dominated.push_back(is_dominated(chain));
    std::vector<Chain> kept;
    for (std::size_t c = 0; c < chains_.size(); ++c)
      if (!dominated[c]) kept.push_back(std::move(chains_[c]));
    return kept;
  }

  bool is_dominated(const Chain& chain) const {
    std::uint64_t front = 0;
    for (std::size_t cut = 0; cut < chain.path.places.size(); ++cut) {
      front ^= keys_[chain.pieces[cut]];
      double cost = 0.0;
      std::uint64_t between = 0;
      for (const std::uint32_t fragment : graph_.joins[chain.path.places[cut]].absorbed) {
        between ^= keys_[fragment];
        cost += cost_of(keys_[fragment]);
      }
      if (cost + cost_of(front) + cost_of(chain.key ^ front ^ between) <= chain.path.cost) return true;
      front ^= between;
    }
    return false;
  }

  double cost_of(std::uint64_t key) const {
    const auto entry = chain_of_key_.find(key);
    return entry == chain_of_key_.end() ? std::numeric_limits<double>::infinity() : chains_[entry->second].path.cost;
  }

  const PieceGraph& graph_;
  const LengthModel& lengths_;
  double longest_;
  std::vector<std::uint64_t> keys_;  ///< of the pieces
  std::vector<char> is_taken_;       ///< of each piece: by the chain under construction
  std::size_t chains_left_ = 0;      ///< of the end that they start at
  std::vector<Chain> chains_;
  std::unordered_map<std::uint64_t, std::size_t> chain_of_key_;
};

}  // namespace

std::vector<Chain> find_chains(const PieceGraph& graph, const LengthModel& lengths) {
  return ChainSearch(graph, lengths).find();
}

TubePath path_of(const Chain& chain, const PieceGraph& graph) {
  TubePath path;
  std::uint32_t entered = chain.first_end;
  for (std::size_t k = 0; k < chain.pieces.size(); ++k) {
    const TubePiece& piece = graph.pieces[chain.pieces[k]];
    auto nodes = piece.nodes;
    if (entered % 2 == 1) std::reverse(nodes.begin(), nodes.end());
    path.evidence += piece.evidence;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (!path.nodes.empty()) path.bridged.push_back(n == 0);
      path.nodes.push_back(nodes[n]);
    }
    if (k == chain.path.places.size()) break;
    const JoinCandidate& join = graph.joins[chain.path.places[k]];
    entered = join.end_a / 2 == chain.pieces[k + 1] ? join.end_a : join.end_b;
  }
  return path;
}

}  // namespace tubebin::modeling
