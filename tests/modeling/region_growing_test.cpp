// The paper's method, stage by stage.
#include "tubebin/modeling/region_growing.hpp"

#include <gtest/gtest.h>

#include "modeling/built_surface.hpp"
#include "tubebin/modeling/greedy_joining.hpp"

namespace tubebin::modeling {
namespace {

/// A cylinder across the bends of several would have points of each of them.
TEST(RegionGrowing, ShortCylindersInABendAreFoundOneByOne) {
  for (const double bend_deg : {15.0, 20.0}) {
    std::vector<Vec3> nodes = {Vec3::Zero()};
    for (int k = 0; k < 7; ++k) {
      const double turned = radians(k * bend_deg);
      nodes.push_back(nodes.back() + 0.02 * Vec3(std::cos(turned), std::sin(turned), 0.0));
    }
    const FilteredCloud cloud = upper_half_of(nodes);
    const auto pieces = fit_cylinders(cloud, cloud.source, kRadius, RegionGrowingOptions{});
    EXPECT_EQ(pieces.size(), 7U);
    for (const TubePiece& piece : pieces)
      for (const Vec3& node : piece.nodes) EXPECT_LT(distance_to_polyline(node, nodes), 0.05 * kRadius);
  }
}

TEST(GreedyJoining, WhatIsShorterThanItIsWideIsATubeOnlyAsPartOfOne) {
  const auto piece = [](double from, double to, double y) {
    return TubePiece{.nodes = {Vec3(from, y, 0), Vec3(to, y, 0)}, .radius = kRadius, .points = {}};
  };
  const std::vector<TubePiece> pieces = {piece(0.0, 0.2, 0.0), piece(0.21, 0.23, 0.0), piece(0.0, 0.02, 0.3)};
  const auto tubes = join_greedily(pieces, GreedyJoiningOptions{});
  ASSERT_EQ(tubes.size(), 1U);
  EXPECT_NEAR(tubes[0].length(), 0.23, 1e-9);
}

}  // namespace
}  // namespace tubebin::modeling
