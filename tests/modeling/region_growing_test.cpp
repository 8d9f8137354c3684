// The paper's method, stage by stage.
#include "tubebin/modeling/region_growing.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "modeling/built_scene.hpp"
#include "tubebin/modeling/greedy_joining.hpp"

namespace tubebin::modeling {
namespace {

/// The upper half of a tube's surface, sampled every 1.5 mm, without the joints' spheres.
FilteredCloud upper_half_of(const std::vector<Vec3>& nodes) {
  constexpr double kSpacing = 0.0015;
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = kSpacing};
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 axis = (nodes[k + 1] - nodes[k]).normalized();
    const Vec3 side = axis.cross(Vec3::UnitZ()).normalized(), up = side.cross(axis);
    for (double along = 0.0; along < (nodes[k + 1] - nodes[k]).norm(); along += kSpacing)
      for (double angle = 0.0; angle < std::numbers::pi; angle += kSpacing / kRadius) {
        const Vec3 normal = std::cos(angle) * side + std::sin(angle) * up;
        cloud.points.push_back((nodes[k] + along * axis + kRadius * normal).cast<float>());
        cloud.normals.push_back(normal.cast<float>());
      }
  }
  cloud.source.resize(cloud.points.size());
  std::iota(cloud.source.begin(), cloud.source.end(), 0U);
  return cloud;
}

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
