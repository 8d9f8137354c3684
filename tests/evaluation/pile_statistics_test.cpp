#include "tubebin/evaluation/pile_statistics.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace tubebin::evaluation {
namespace {

constexpr double kRadius = 0.0125;

scene::PlacedTube tube_between(const Vec3& start, const Vec3& end) {
  scene::PlacedTube placed;
  placed.tube.radius = kRadius;
  placed.tube.nodes = {start, end};
  placed.tube.cylinders = {{0, 1, 0}};
  return placed;
}

TEST(PileStatistics, TwoCrossingTubes) {
  scene::Scene scene;
  scene.tubes = {tube_between({-0.2, 0, kRadius}, {0.2, 0, kRadius}),
                 tube_between({0, -0.2, 3 * kRadius - 0.0003}, {0, 0.2, 3 * kRadius - 0.0003})};
  const PileStatistics s = pile_statistics(scene, {1000, 3000});
  EXPECT_NEAR(s.mean_height, 2 * kRadius - 0.00015, 1e-9);
  EXPECT_NEAR(s.top_height, 4 * kRadius - 0.0003, 1e-9);
  EXPECT_NEAR(s.mean_tilt_deg, 0.0, 1e-9);
  EXPECT_NEAR(s.spread, 0.4 / std::sqrt(12.0), 1e-4);  // of a uniform distribution over 0.4 m
  EXPECT_DOUBLE_EQ(s.contacts, 1.0);
  EXPECT_NEAR(s.penetration, 0.0003, 1e-9);
  EXPECT_DOUBLE_EQ(s.visible_points, 2000.0);
}

TEST(PileStatistics, ALeaningTubeStandsOnItsRim) {
  scene::Scene scene;
  const double tilt = radians(30.0);
  const Vec3 low(0, 0, kRadius * std::cos(tilt));
  scene.tubes = {tube_between(low, low + 0.3 * Vec3(std::cos(tilt), 0, std::sin(tilt)))};
  const PileStatistics s = pile_statistics(scene, {10});
  EXPECT_NEAR(s.mean_tilt_deg, 30.0, 1e-9);
  EXPECT_NEAR(s.penetration, 0.0, 1e-12);
  EXPECT_EQ(s.contacts, 0.0);
}

TEST(PileStatistics, TableTellsHowManyPublishedPilesAreLikeOurs) {
  PileComparison comparison{"A10", {}, {}};
  for (int i = 0; i <= 100; ++i) {
    PileStatistics pile;
    pile.contacts = 0.01 * i;
    comparison.here.push_back(pile);
  }
  comparison.published.resize(2);
  comparison.published[0].contacts = 0.5;
  comparison.published[1].contacts = 0.99;
  const Table table = pile_table({comparison});
  ASSERT_THAT(table.rows, ::testing::SizeIs(8));
  EXPECT_EQ(table.rows[4][1].text, "contacts a tube");
  EXPECT_EQ(table.rows[4][6].text, "1 of 2");
}

}  // namespace
}  // namespace tubebin::evaluation
