#include "modeling/fitting/vote_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

/// Points whose votes lie about the corners of a polyline, and one far from all.
FilteredCloud votes_about(const std::vector<Vec3>& nodes, double off) {
  Random random(6);
  FilteredCloud cloud = upper_half_of(nodes);
  for (cloud::Point& point : cloud.points)
    for (float& coordinate : point) coordinate += static_cast<float>(random.uniform(-off, off));
  cloud.source.push_back(static_cast<std::uint32_t>(cloud.points.size()));
  cloud.points.emplace_back(0.5f, 0.5f, 0.5f);
  cloud.normals.push_back(cloud::Point::UnitZ());
  return cloud;
}

/// Shortest ways between all voxels by Floyd and Warshall, over the links that the voxels' means allow.
std::vector<std::vector<double>> all_distances(const VoteGraph& graph) {
  const std::size_t n = graph.size();
  std::vector<std::vector<double>> d(n, std::vector<double>(n, std::numeric_limits<double>::infinity()));
  const auto cell = [&](std::size_t i) {
    return (graph.mean(i).array() / static_cast<float>(kRadius / 3.0)).floor().eval();
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const auto apart = static_cast<double>((graph.mean(i) - graph.mean(j)).norm());
      if (apart <= kRadius / 2.0 && (cell(i) - cell(j)).abs().maxCoeff() < 1.5f) d[i][j] = apart;
    }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) d[i][j] = std::min(d[i][j], d[i][k] + d[k][j]);
  return d;
}

TEST(VoteGraph, DistancesAreThoseOfAllShortestWays) {
  const FilteredCloud cloud = votes_about({{0, 0, 0}, {0.08, 0, 0}, {0.08, 0.06, 0}}, 0.004);
  const VoteGraph graph(cloud, cloud.source, kRadius);
  ASSERT_GT(graph.size(), 40u);
  const auto expected = all_distances(graph);
  const std::vector<std::uint32_t> two = {0, static_cast<std::uint32_t>(graph.size() / 2)};
  const std::vector<double> from_first = graph.distances_from(std::span(two).first(1)),
                            from_two = graph.distances_from(two);
  const auto agree = [](double a, double b) { return a == b || std::abs(a - b) < 1e-6; };  // both may be infinite
  for (std::size_t i = 0; i < graph.size(); ++i) {
    EXPECT_PRED2(agree, from_first[i], expected[two[0]][i]);
    EXPECT_PRED2(agree, from_two[i], std::min(expected[two[0]][i], expected[two[1]][i]));
  }
}

TEST(VoteGraph, TheLongestWayLeadsFromEndToEndWithoutStrays) {
  const std::vector<Vec3> nodes = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.08, 0}};
  const FilteredCloud cloud = votes_about(nodes, 0.001);
  const VoteGraph graph(cloud, cloud.source, kRadius);
  EXPECT_EQ(graph.distances_from_end()[graph.voxel_of(cloud.source.back())], std::numeric_limits<double>::infinity());
  std::vector<Vec3> way;
  for (const std::uint32_t voxel : graph.longest_way()) way.push_back(graph.mean(voxel).cast<double>());
  if ((way.front() - nodes.back()).norm() < (way.front() - nodes.front()).norm()) std::reverse(way.begin(), way.end());
  EXPECT_LT((way.front() - nodes.front()).norm(), kRadius / 3.0);
  EXPECT_LT((way.back() - nodes.back()).norm(), kRadius / 3.0);
  EXPECT_LT(distance_between(way, nodes), kRadius / 3.0);
  EXPECT_LE(longest_step(way), kRadius / 2.0);
}

TEST(VoteGraph, PartsAreWhatTheirPointsAloneWouldMake) {
  const FilteredCloud cloud = votes_about({{0, 0, 0}, {0.08, 0, 0}, {0.08, 0.06, 0}}, 0.004);
  const VoteGraph whole(cloud, cloud.source, kRadius);
  Random random(9);
  constexpr std::size_t kParts = 3;
  std::vector<std::uint32_t> part_of_voxel;
  for (std::size_t i = 0; i < whole.size(); ++i)
    part_of_voxel.push_back(whole.mean(i).x() < 0.03f ? 0 : random.uniform(0.0, 1.0) < 0.5 ? 1 : 2);
  const std::vector<VoteGraph> parts = whole.divided(part_of_voxel, kParts);
  ASSERT_EQ(parts.size(), kParts);
  for (std::uint32_t part = 0; part < kParts; ++part) {
    Segment points;
    for (std::size_t k = 0; k < cloud.source.size(); ++k)
      if (part_of_voxel[whole.voxel_of(k)] == part) points.push_back(cloud.source[k]);
    const VoteGraph expected(cloud, points, kRadius);
    ASSERT_EQ(parts[part].size(), expected.size());
    EXPECT_EQ(parts[part].end(), expected.end());
    EXPECT_EQ(parts[part].distances_from_end(), expected.distances_from_end());
    for (std::uint32_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(parts[part].mean(i), expected.mean(i));
      EXPECT_EQ(parts[part].count(i), expected.count(i));
      EXPECT_TRUE(std::ranges::equal(parts[part].linked(i), expected.linked(i)));
    }
    for (std::size_t k = 0; k < points.size(); ++k) EXPECT_EQ(parts[part].voxel_of(k), expected.voxel_of(k));
  }
}

}  // namespace
}  // namespace tubebin::modeling
