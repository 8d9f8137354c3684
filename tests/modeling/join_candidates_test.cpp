#include "modeling/joining/join_candidates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "modeling/lid_scene.hpp"

namespace tubebin::modeling {
namespace {

/// Tubes that bend by 4 degrees a radius.
const double kBendingRate = std::pow(radians(4.0), 2) / kRadius;

class JoinCandidates : public LidScene {
 protected:
  std::vector<JoinCandidate> candidates_of(const std::vector<TubePiece>& pieces,
                                           JoinLimits limits = {.cost = 9.0, .joins_per_end = 4}) const {
    const OcclusionTest occlusion = this->occlusion();
    const std::vector<PieceEnd> ends = find_piece_ends(pieces, occlusion, 0.5);
    const auto pairs = find_possible_joins(pieces, ends, occlusion, kBendingRate, 100.0);
    return find_join_candidates(pieces, ends, pairs, occlusion, kBendingRate, limits);
  }
  /// Allows five deviations of length, a twentieth of a quarter each.
  static LengthModel no_longer_than(double length) { return {.longest_likely = length / (1.0 + 5.0 / 80.0)}; }
  static std::vector<TubePiece> in_line(double y) { return {straight(y, -0.25, -0.02), straight(y, 0.02, 0.25)}; }
};

TEST_F(JoinCandidates, BridgeWhatTheLidHides) {
  const auto candidates = candidates_of(in_line(0.0));
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_EQ(candidates[0].end_a, 1u);
  EXPECT_EQ(candidates[0].end_b, 2u);
  EXPECT_LT(candidates[0].cost, 0.0);  // likelier than not
  EXPECT_EQ(candidates[0].bridge.front(), Vec3(-0.02, 0, 0));
  EXPECT_EQ(candidates[0].bridge.back(), Vec3(0.02, 0, 0));
  EXPECT_NEAR(polyline_length(candidates[0].bridge), 0.04, 1e-9);
}

TEST_F(JoinCandidates, AreUnlikelyThroughPlacesThatAreSeenToBeEmpty) {
  EXPECT_TRUE(candidates_of(in_line(0.3), {.cost = 0.0, .joins_per_end = 4}).empty());
  EXPECT_GT(candidates_of(in_line(0.3)).at(0).cost, candidates_of(in_line(0.0)).at(0).cost + 10.0);
}

TEST_F(JoinCandidates, LeadNotThroughAnotherTube) {
  std::vector<TubePiece> pieces = in_line(0.0);
  pieces.push_back({.nodes = {{0, -0.2, 0}, {0, 0.2, 0}}, .radius = kRadius, .points = {}});
  const auto is_bridge = [](const JoinCandidate& join) { return join.end_a == 1 && join.end_b == 2; };
  EXPECT_TRUE(std::ranges::none_of(candidates_of(pieces), is_bridge));
  for (Vec3& node : pieces.back().nodes) node.z() = -2.1 * kRadius;  // below, where there is room
  const auto candidates = candidates_of(pieces);
  const auto bridge = std::ranges::find_if(candidates, is_bridge);
  ASSERT_NE(bridge, candidates.end());
  EXPECT_LT(bridge->cost, 0.0);
}

TEST_F(JoinCandidates, DoNotTurnBackToATubeAlongside) {
  const auto may_turn_back = [&](double apart) {
    const std::vector<TubePiece> pieces = {straight(0.0, -0.25, -0.02), straight(apart, -0.25, -0.02)};
    const OcclusionTest scan = occlusion();
    return std::ranges::any_of(
        find_possible_joins(pieces, find_piece_ends(pieces, scan, 0.5), scan, kBendingRate, 100.0),
        [](const PossibleJoin& join) { return join.end_a == 1 && join.end_b == 3; });
  };
  EXPECT_FALSE(may_turn_back(2.0 * kRadius));
  EXPECT_TRUE(may_turn_back(4.0 * kRadius));
}

TEST_F(JoinCandidates, TurnNoMoreThanTheScenesTubesDo) {
  const double middle = -0.05;
  const std::vector<TubePiece> corner = {
      straight(0.0, -0.25, -0.02), {.nodes = {{0.0, 0.02, 0.0}, {0.0, 0.25, 0.0}}, .radius = kRadius, .points = {}}};
  const TubePiece bent = {
      .nodes = {{-0.25, 0.4, 0}, {middle, 0.4, 0}, {middle, 0.6, 0}}, .radius = kRadius, .points = {}};
  const auto cost_among = [&](const TubePiece& other, std::size_t count) {
    std::vector<TubePiece> pieces = corner;
    pieces.insert(pieces.end(), count, other);
    const OcclusionTest scan = occlusion();
    const std::vector<PieceEnd> ends = find_piece_ends(pieces, scan, 0.5);
    for (const PossibleJoin& join : find_possible_joins(pieces, ends, scan, kBendingRate, 100.0))
      if (join.end_a == 1 && join.end_b == 2) return join.cost;
    return std::numeric_limits<double>::infinity();
  };
  TubePiece even = bent;
  even.nodes = {{-0.25, 0.4, 0}, {-0.15, 0.5, 0}, {middle, 0.6, 0}};
  EXPECT_GT(cost_among(even, 30), cost_among(bent, 30) + 1.0);
}

TEST_F(JoinCandidates, AbsorbTheFragmentsOnTheirWay) {
  std::vector<TubePiece> pieces = in_line(0.0);
  pieces.push_back(straight(0.0, -0.004, 0.006));
  pieces.push_back(straight(1.2 * kRadius, -0.004, 0.006));
  for (const JoinCandidate& join : candidates_of(pieces))
    if (join.end_a == 1 && join.end_b == 2) {
      EXPECT_EQ(join.absorbed, std::vector<std::uint32_t>{2});
      return;
    }
  FAIL() << "the two long pieces are no candidate";
}

TEST_F(JoinCandidates, MayCostMoreWhereTheyMakeATubeWhole) {
  const auto pieces = in_line(0.3);  // 0.5 m with the gap
  const double cost = candidates_of(pieces).at(0).cost;
  constexpr double all = std::numeric_limits<double>::infinity();
  const auto count = [&](double limit, const std::vector<double>& common) {
    const LengthModel lengths{.radius = kRadius, .common = common, .longest_likely = 1.0};
    return candidates_of(
               pieces, {.cost = limit, .lengths = lengths, .joins_per_end = 4, .chain_lengths = {all, 0.23, 0.23, all}})
        .size();
  };
  EXPECT_EQ(count(cost - 3.0, {}), 0u);
  EXPECT_EQ(count(cost - 3.0, {0.5}), 1u);
  EXPECT_EQ(count(cost - 3.0, {0.47}), 0u);
  EXPECT_EQ(count(cost - 6.0, {0.5}), 0u);
}

TEST_F(JoinCandidates, KeepToTheirLimits) {
  EXPECT_EQ(candidates_of(in_line(0.0), {.cost = 9.0, .lengths = no_longer_than(0.501), .joins_per_end = 4}).size(),
            1u);
  EXPECT_TRUE(candidates_of(in_line(0.0), {.cost = 9.0, .lengths = no_longer_than(0.499), .joins_per_end = 4}).empty());
  EXPECT_TRUE(candidates_of(in_line(0.0), {.cost = -20.0, .joins_per_end = 4}).empty());
  // Three pieces end on either side, a diameter apart: nine ways, of each end the cheapest is straight on.
  std::vector<TubePiece> pieces;
  for (const double y : {-0.018, 0.0, 0.018})
    for (const TubePiece& piece : in_line(y)) pieces.push_back(piece);
  const auto candidates = candidates_of(pieces, {.cost = 20.0, .joins_per_end = 1});
  ASSERT_EQ(candidates.size(), 3u);
  for (const JoinCandidate& join : candidates) EXPECT_EQ(join.end_b, join.end_a + 1);
  EXPECT_GT(candidates_of(pieces, {.cost = 20.0, .joins_per_end = 4}).size(), 3u);
}

}  // namespace
}  // namespace tubebin::modeling
