#include "modeling/fitting/tube_stretches.hpp"

#include <gtest/gtest.h>

#include <set>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

/// Of a length of 0.4 m, which is bent.
const std::vector<Vec3> kNodes = {{-0.2, 0, 0}, {0, 0, 0}, {0, 0.2, 0}};

class TubeStretches : public ::testing::Test {
 protected:
  /// The stretches of a piece along all of the nodes where only `is_tube` places of them are tube.
  std::vector<TubePiece> stretches(const std::function<bool(const Vec3&)>& is_tube) const {
    return tube_stretches(piece_, cloud_.points,
                          [&](const TubePiece& stretch) { return std::ranges::all_of(stretch.nodes, is_tube); });
  }

  FilteredCloud cloud_ = upper_half_of(kNodes);
  TubePiece piece_{.nodes = kNodes, .radius = kRadius, .points = cloud_.source};
};

TEST_F(TubeStretches, AreTheWholePieceWhereAllOfItIsTube) {
  const auto all = stretches([](const Vec3&) { return true; });
  ASSERT_EQ(all.size(), 1u);
  EXPECT_NEAR(all[0].length(), 0.4, 1e-9);
  EXPECT_LT(distance_between(all[0].nodes, kNodes), 1e-9);
  EXPECT_EQ(std::set(all[0].points.begin(), all[0].points.end()).size(), cloud_.points.size());
}

TEST_F(TubeStretches, LeaveOutWhatIsNone) {
  const auto ends = stretches([](const Vec3& place) { return place.x() < -0.05 || place.y() > 0.05; });
  ASSERT_EQ(ends.size(), 2u);
  for (const TubePiece& end : ends) {
    EXPECT_EQ(end.radius, kRadius);
    EXPECT_GT(end.length(), 0.15 - 4.0 * kRadius);
    EXPECT_LT(end.length(), 0.15 + 1e-9);
    for (const std::uint32_t i : end.points)
      EXPECT_LT(distance_to_polyline(cloud_.points[i].cast<double>(), end.nodes), 1.05 * kRadius);
  }
  EXPECT_LT(ends[0].nodes.back().x(), -0.05);
  EXPECT_GT(ends[1].nodes.front().y(), 0.05);
}

TEST_F(TubeStretches, AreNoneWhereTheyAreShort) {
  EXPECT_TRUE(stretches([](const Vec3& place) { return place.x() < -0.2 + 7.0 * kRadius; }).empty());
  EXPECT_TRUE(stretches([](const Vec3&) { return false; }).empty());
}

}  // namespace
}  // namespace tubebin::modeling
