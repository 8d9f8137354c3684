// Chains of pieces: the best cover by them is the best of all.
#include "modeling/joining/chains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

constexpr std::uint32_t kPieces = 6;
constexpr std::size_t kJoins = 9;
constexpr double kThickness = 0.01;  // metres, radius of the pieces

/// Pieces, and joins at random between their ends, some of which absorb a piece; no two bridges are near each other.
struct RandomPieces {
  explicit RandomPieces(std::uint64_t seed) {
    Random random(seed);
    const auto any_of = [&](std::uint32_t count) {
      return static_cast<std::uint32_t>(random.integer(0, static_cast<int>(count) - 1));
    };
    for (std::uint32_t k = 0; k < kPieces; ++k) {
      pieces.push_back({.nodes = {{0, 0, 0}, {random.uniform(0.1, 0.3), 0, 0}}, .radius = kThickness, .points = {}});
      for (int end = 0; end < 2; ++end)
        ends.push_back({.seen_free = random.uniform(0, 1), .hidden_reach = random.uniform(0, 0.1)});
    }
    while (joins.size() < kJoins) {
      const std::uint32_t a = any_of(2 * kPieces), b = any_of(2 * kPieces), absorbed = any_of(3 * kPieces);
      if (a >= b || a / 2 == b / 2) continue;
      const Vec3 from(double(joins.size()), 0, 0), across(random.uniform(0.01, 0.1), 0, 0);
      joins.push_back(
          {.end_a = a, .end_b = b, .cost = random.uniform(-4, 2), .bridge = {from, from + across}, .absorbed = {}});
      if (absorbed < kPieces && absorbed != a / 2 && absorbed != b / 2) joins.back().absorbed.push_back(absorbed);
    }
  }

  std::vector<TubePiece> pieces;
  std::vector<PieceEnd> ends;
  std::vector<JoinCandidate> joins;
};

/// What a subset of the joins makes of the pieces, by definition.
class Joined {
 public:
  Joined(const PieceGraph& graph, const LengthModel& lengths, unsigned subset)
      : graph_(graph), lengths_(lengths), join_of_end_(graph.ends.size()), held_(graph.pieces.size(), 0) {
    for (std::uint32_t j = 0; j < graph.joins.size(); ++j)
      if ((subset >> j & 1U) != 0) choose(graph.joins[j], j);
  }

  /// Nothing where an end has two joins, pieces make a ring, one is in two tubes, or a tube is too long.
  std::optional<double> cost() {
    if (has_double_end_) return std::nullopt;
    double cost = 0.0;
    for (std::uint32_t end = 0; end < graph_.ends.size(); ++end) {
      if (join_of_end_[end] || is_absorbed(end / 2)) continue;
      const auto of_tube = cost_of_tube(end);
      if (!of_tube) return std::nullopt;
      cost += *of_tube / 2.0;  // each is met from both ends
    }
    for (std::uint32_t k = 0; k < held_.size(); ++k)
      if (held_[k] != (is_absorbed(k) ? 1 : 2)) return std::nullopt;
    return cost;
  }

 private:
  void choose(const JoinCandidate& join, std::uint32_t j) {
    for (const std::uint32_t end : {join.end_a, join.end_b}) {
      has_double_end_ |= join_of_end_[end].has_value();
      join_of_end_[end] = j;
    }
    for (const std::uint32_t k : join.absorbed) {
      ++held_[k];
      absorbed_.push_back(k);
    }
  }
  bool is_absorbed(std::uint32_t piece) const {
    return std::find(absorbed_.begin(), absorbed_.end(), piece) != absorbed_.end();
  }

  std::optional<double> cost_of_tube(std::uint32_t first) {
    double joins = 0.0, length = 0.0, bridged = 0.0;
    std::size_t count = 0;
    std::uint32_t end = first;
    while (true) {
      ++held_[end / 2];
      ++count;
      length += graph_.piece_lengths[end / 2];
      end ^= 1U;
      if (!join_of_end_[end]) break;
      const std::uint32_t j = *join_of_end_[end];
      joins += graph_.joins[j].cost;
      length += graph_.bridge_lengths[j];
      bridged += graph_.bridge_lengths[j];
      end = graph_.joins[j].end_a == end ? graph_.joins[j].end_b : graph_.joins[j].end_a;
    }
    if (count > 1 && length > lengths_.longest()) return std::nullopt;
    double room = 0.0, hidden = 0.0;
    for (const std::uint32_t tip : {first, end}) {
      hidden += kHiddenEndCost * (1.0 - graph_.ends[tip].seen_free);
      if (graph_.ends[tip].seen_free < 0.5) room += graph_.ends[tip].hidden_reach + kThickness;
    }
    return joins + hidden + lengths_.cost(length, bridged, room, false);
  }

  const PieceGraph& graph_;
  const LengthModel& lengths_;
  std::vector<std::optional<std::uint32_t>> join_of_end_;
  std::vector<int> held_;  ///< of each piece, how often tubes met it
  std::vector<std::uint32_t> absorbed_;
  bool has_double_end_ = false;
};

TEST(Chains, HaveTheBestCoverAmongThem) {
  std::size_t joined = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    RandomPieces random(seed);
    const PieceGraph graph(random.pieces, random.ends, random.joins);
    const LengthModel lengths{.radius = kThickness,
                              .common = seed % 2 == 0 ? std::vector<double>{0.5} : std::vector<double>{}};
    double least = std::numeric_limits<double>::infinity();
    for (unsigned subset = 0; subset < 1U << kJoins; ++subset)
      if (const auto cost = Joined(graph, lengths, subset).cost()) least = std::min(least, *cost);

    const std::vector<Chain> chains = find_chains(graph, lengths);
    std::vector<PathCandidate> paths;
    for (const Chain& chain : chains) paths.push_back(chain.path);
    double cost = 0.0;
    for (const std::uint32_t c : cheapest_path_cover(kPieces, paths, graph.collisions, 100000).chosen) {
      cost += paths[c].cost;
      joined += chains[c].path.places.size();
    }
    EXPECT_NEAR(cost, least, 1e-9) << "seed " << seed;
  }
  EXPECT_GT(joined, 100u);  // or the scenes would say little
}

TEST(LengthModel, CountsWhatIsMissingBeyondTheRoomForIt) {
  const LengthModel lengths{.radius = kThickness, .common = {0.5}};
  EXPECT_EQ(lengths.cost(0.5, 0.0, 0.0, false), 0.0);
  EXPECT_EQ(lengths.cost(0.4, 0.0, 0.1, false), 0.0);
  EXPECT_NEAR(lengths.cost(0.39, 0.0, 0.105, false), 2.0, 1e-9);  // two standard deviations of a quarter of a radius
  EXPECT_EQ(lengths.cost(0.2, 0.0, 0.0, false), 10.0);
  EXPECT_EQ(lengths.cost(0.2, 0.0, 0.1, false), 6.0);  // a hidden end may lead elsewhere
  EXPECT_EQ(lengths.cost(0.2, 0.0, 0.1, true), 3.0);
  EXPECT_EQ(lengths.cost(0.7, 0.0, 0.3, true), 10.0);  // room explains nothing that is too much
  EXPECT_EQ(LengthModel{.radius = kThickness}.cost(0.2, 0.0, 0.0, false), 0.0);
}

/// A normal density of a quarter of a radius about 0.5 m, and one over 0.5 m for how far a hidden end lies, against one over
/// 0.8 m.
TEST(LengthModel, FavorsTheCommonLengthByTheRatioOfDensities) {
  const LengthModel lengths{.radius = kThickness, .common = {0.5}, .longest_likely = 0.8};
  const double density = 1.0 / (std::sqrt(2.0 * std::numbers::pi) * kThickness / 4.0);
  EXPECT_NEAR(lengths.gain(0.5, 0.0, 0.0), std::log(density / (1.0 / 0.8)), 1e-9);
  EXPECT_NEAR(lengths.gain(0.4, 0.0, 0.2), std::log(0.8 / 0.5), 1e-9);
  EXPECT_EQ(lengths.gain(0.4, 0.0, 0.05), 0.0);
  EXPECT_EQ(lengths.gain(0.6, 0.0, 0.2), 0.0);
}

TEST(LengthModel, OfSeveralLengthsTheOneThatSuitsCounts) {
  const LengthModel lengths{.radius = kThickness, .common = {0.3, 0.5}, .longest_likely = 0.8};
  const LengthModel one{.radius = kThickness, .common = {0.5}, .longest_likely = 0.8};
  EXPECT_EQ(lengths.cost(0.3, 0.0, 0.0, false), 0.0);
  EXPECT_GT(one.cost(0.3, 0.0, 0.0, false), 5.0);
  EXPECT_GT(lengths.cost(0.4, 0.0, 0.0, false), 5.0);
  EXPECT_EQ(lengths.longest(), one.longest());
  // Which of the two it has is one more thing to tell, and each length itself could be any.
  EXPECT_NEAR(lengths.gain(0.5, 0.0, 0.0), one.gain(0.5, 0.0, 0.0) - std::log(2.0), 1e-12);
  const double of_each = one.gain(0.5, 0.0, 0.0) + std::log(4.0);  // the best of four
  EXPECT_NEAR(one.cost_of_common_lengths(), of_each - std::log(10.0), 1e-12);
  EXPECT_NEAR(lengths.cost_of_common_lengths(), 2.0 * of_each, 1e-12);
  EXPECT_EQ(LengthModel{.radius = kThickness}.cost_of_common_lengths(), 0.0);
}

TEST(LengthModel, RecurringLengthsAreSharedByTwoTubesOrMore) {
  const LengthModel lengths{.radius = kThickness};
  EXPECT_EQ(lengths.recurring({0.5, 0.3, 0.5, 0.41, 0.3}), (std::vector<double>{0.3, 0.5}));
  EXPECT_TRUE(lengths.recurring({0.5, 0.5, 0.41, 0.3}).empty());  // a single one
  EXPECT_TRUE(lengths.recurring({}).empty());
}

TEST(LengthModel, TriesTheLengthOfMostTubeFirst) {
  const LengthModel lengths{.radius = kThickness};
  EXPECT_EQ(lengths.possible_common({0.3, 0.5, 0.302, 0.501, 0.298, 0.502, 0.499}), (std::vector<double>{0.501, 0.3}));
  EXPECT_TRUE(lengths.possible_common({}).empty());
}

}  // namespace
}  // namespace tubebin::modeling
