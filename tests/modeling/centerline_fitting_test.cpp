#include "modeling/fitting/centerline_fitting.hpp"

#include <gtest/gtest.h>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

const Vec3 kAbove(0, 0, 1);  // metres, the viewpoint

std::optional<TubePiece> fit_all(const FilteredCloud& cloud, double radius) {
  const VoteCurve curve = find_vote_curve(cloud, {cloud.source, VoteGraph(cloud, cloud.source, radius)}, radius);
  return fit_centerline(cloud, curve, bend_tolerance({&curve, 1}, radius), {}, radius, kAbove);
}

TEST(CenterlineFitting, FindsTheCylindersThatPointsLieOn) {
  const std::vector<std::vector<Vec3>> tubes = {
      {{-0.1, 0, 0}, {0.1, 0.03, 0.02}},
      {{-0.1, 0, 0}, {0, 0, 0}, {0.08, 0.05, 0.01}},
      {{-0.2, 0, 0}, {-0.1, 0.02, 0}, {0, 0, 0}, {0.06, 0.08, 0}, {0.04, 0.18, 0}}};
  for (const std::vector<Vec3>& nodes : tubes)
    for (const double noise : {0.0, 0.0003}) {
      FilteredCloud cloud = upper_half_of(nodes);
      Random random(8);
      for (std::size_t i = 0; i < cloud.points.size(); ++i)
        cloud.points[i] += static_cast<float>(noise * random.normal()) * cloud.normals[i];
      const std::optional<TubePiece> piece = fit_all(cloud, kRadius);
      ASSERT_TRUE(piece.has_value());
      EXPECT_GE(piece->nodes.size(), nodes.size());
      EXPECT_LE(piece->nodes.size(), nodes.size() + 1);
      EXPECT_LT(distance_between(piece->nodes, nodes), noise == 0.0 ? 0.1 * kRadius : 0.2 * kRadius);
      EXPECT_EQ(piece->points, cloud.source);
    }
}

TEST(CenterlineFitting, KeepsBothLegsOfACornerThatIsALittleSharperThanRight) {
  for (const double degrees : {85.0, 95.0}) {
    const Vec3 leg = 0.1 * Vec3(std::cos(radians(degrees)), std::sin(radians(degrees)), 0.0);
    const std::vector<Vec3> nodes = {{-0.15, 0, 0}, Vec3::Zero(), leg};
    const std::optional<TubePiece> piece = fit_all(upper_half_of(nodes), kRadius);
    ASSERT_TRUE(piece.has_value());
    EXPECT_LT(distance_between(piece->nodes, nodes), 0.5 * kRadius) << degrees;
  }
}

TEST(CenterlineFitting, GivesAStretchShorterThanItIsWideTheAxisOfItsNormals) {
  const std::vector<Vec3> nodes = {{0, 0, 0}, {0.012, 0.009, 0}};
  const std::optional<TubePiece> piece = fit_all(upper_half_of(nodes), kRadius);
  ASSERT_TRUE(piece.has_value());
  const Vec3 axis = (piece->nodes.back() - piece->nodes.front()).normalized();
  EXPECT_GT(std::abs(axis.dot((nodes[1] - nodes[0]).normalized())), std::cos(radians(5.0)));
  EXPECT_LT(distance_between(piece->nodes, nodes), 0.3 * kRadius);
}

TEST(CenterlineFitting, MakesNothingOfPointsThatLieOnNoTube) {
  Random random(9);
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = 0.0015};
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const Vec3 anywhere(random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03));
    cloud.source.push_back(i);
    cloud.points.push_back(anywhere.cast<float>());
    cloud.normals.push_back(Vec3(random.normal(), random.normal(), random.normal()).normalized().cast<float>());
  }
  EXPECT_FALSE(fit_all(cloud, kRadius).has_value());
}

TEST(CenterlineFitting, CutsAPieceWhereItTurnsBackButNotAtAFork) {
  const TubePiece straight{.nodes = {{0, 0, 0}, {0.1, 0, 0}, {0.2, 0.01, 0}}, .radius = kRadius, .points = {0}};
  const std::vector<cloud::Point> points = {{0.02f, 0.0f, 0.0125f}, {0.09f, 0.03f, 0.0125f}, {0.0f, 0.14f, 0.0125f}};
  EXPECT_EQ(cut_where_it_turns_back(straight, points).front().nodes, straight.nodes);

  const TubePiece back{
      .nodes = {{0, 0, 0}, {0.1, 0, 0}, {0.06, 0.005, 0}, {0.0, 0.15, 0}}, .radius = kRadius, .points = {0, 1, 2}};
  const std::vector<TubePiece> parts = cut_where_it_turns_back(back, points);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].nodes, (std::vector<Vec3>{{0, 0, 0}, {0.1, 0, 0}}));
  EXPECT_EQ(parts[1].nodes, (std::vector<Vec3>{{0.1, 0, 0}, {0.06, 0.005, 0}, {0.0, 0.15, 0}}));
  EXPECT_EQ(parts[0].points, Segment{0});
  EXPECT_EQ(parts[1].points, (Segment{1, 2}));

  const Vec3 arm = 0.1 * Vec3(-std::cos(radians(40.0)), std::sin(radians(40.0)), 0.0);
  const TubePiece fork{.nodes = {{0, 0, 0}, {0.1, 0, 0}, Vec3(0.1, 0, 0) + arm}, .radius = kRadius, .points = {}};
  EXPECT_EQ(cut_where_it_turns_back(fork, points).size(), 1U);
}

std::vector<Vec3> loop_beside(const Vec3& start) {
  return {start, start + Vec3(kRadius, kRadius, 0), start + Vec3(0, 2.5 * kRadius, 0),
          start + Vec3(-kRadius, kRadius, 0), start + Vec3(0.1 * kRadius, 0, 0)};
}

std::vector<Vec3> nodes_of_whole(std::vector<Vec3> nodes) {
  const auto parts = cut_where_it_turns_back({.nodes = std::move(nodes), .radius = kRadius, .points = {}}, {});
  return parts.size() == 1 ? parts.front().nodes : std::vector<Vec3>{};
}

TEST(CenterlineFitting, DropsALoopOfACourse) {
  const Vec3 start(0, 0, 0), end(0.3, 0, 0);
  const std::vector<Vec3> loop = loop_beside({0.1, 0, 0}), second = loop_beside({0.2, 0, 0});
  std::vector<Vec3> nodes = {start};
  nodes.insert(nodes.end(), loop.begin(), loop.end());
  nodes.push_back(end);
  EXPECT_EQ(nodes_of_whole(nodes), (std::vector<Vec3>{start, loop.front(), end}));

  nodes.insert(nodes.end() - 1, second.begin(), second.end());
  EXPECT_EQ(nodes_of_whole(nodes), nodes) << "of two loops: it is no tube, and stays as it is";
  EXPECT_EQ(nodes_of_whole(loop), loop) << "nothing but a loop";

  std::vector<Vec3> ring;
  for (int k = 0; k <= 12; ++k)
    ring.push_back(3.0 * kRadius * Vec3(std::cos(radians(30.0 * k)), std::sin(radians(30.0 * k)), 0.0));
  EXPECT_EQ(nodes_of_whole(ring), ring);
}

}  // namespace
}  // namespace tubebin::modeling
