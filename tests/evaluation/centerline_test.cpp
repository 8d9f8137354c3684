#include "tubebin/evaluation/centerline.hpp"

#include <gtest/gtest.h>

namespace tubebin::evaluation {
namespace {

/// A straight tube between two points, world frame.
scene::PlacedTube straight_tube(const Vec3& start, const Vec3& end, double radius = 0.0125) {
  scene::PlacedTube placed;
  placed.tube.radius = radius;
  placed.tube.nodes = {start, end};
  placed.tube.cylinders = {{0, 1, 0}};
  return placed;
}

TEST(Centerline, PosesTheNodes) {
  scene::PlacedTube tube = straight_tube({0, 0, 0}, {1, 0, 0});
  tube.world_from_tube = make_pose(Quat(Eigen::AngleAxisd(radians(90.0), Vec3::UnitZ())), {0, 0, 2});
  const Centerline line = centerline(tube);
  ASSERT_EQ(line.size(), 1U);
  EXPECT_TRUE(line[0].end.isApprox(Vec3(0, 1, 2)));
}

TEST(Centerline, ParallelOffsetIsTheError) {
  scene::Scene scene;
  scene.tubes = {straight_tube({0, 0, 0.01}, {0.5, 0, 0.01})};
  const auto samples = sample_centerlines(scene);
  EXPECT_EQ(samples[0].points.size(), 100U);
  const Centerline model = {{{0, 0.002, 0.01}, {0.5, 0.002, 0.01}}};
  const CenterlineError error = centerline_error(centerline(scene.tubes[0]), samples[0], model);
  EXPECT_NEAR(error.model_mean, 0.002, 1e-12);
  EXPECT_NEAR(error.model_p95, 0.002, 1e-12);
  EXPECT_NEAR(error.truth_mean, 0.002, 1e-12);
  EXPECT_EQ(error.truth_samples, 100);
}

TEST(Centerline, AModelThatIsTooShortErrsInOneDirection) {
  scene::Scene scene;
  scene.tubes = {straight_tube({0, 0, 0}, {0.5, 0, 0})};
  const Centerline model = {{{0, 0, 0}, {0.4, 0, 0}}};
  const auto samples = sample_centerlines(scene);
  const CenterlineError error = centerline_error(centerline(scene.tubes[0]), samples[0], model);
  EXPECT_NEAR(error.model_mean, 0.0, 1e-12);
  EXPECT_NEAR(error.truth_mean, 0.2 * 0.05, 1e-6);  // the last fifth is 0.05 m away on average
  EXPECT_NEAR(error.truth_p95, 0.075, 0.0026);
}

TEST(Centerline, BridgedPiecesAreNotMeasured) {
  scene::Scene scene;
  scene.tubes = {straight_tube({0, 0, 0}, {0.5, 0, 0})};
  const Centerline model = {{{0, 0, 0}, {0.3, 0, 0}}, {{0.3, 0, 0}, {0.3, 0.4, 0}, true}};
  const auto samples = sample_centerlines(scene);
  EXPECT_NEAR(centerline_error(centerline(scene.tubes[0]), samples[0], model).model_mean, 0.0, 1e-12);
}

/// A tube of radius r above another hides 2 r (h_scanner - h_low) / (h_scanner - h_high) of it.
TEST(Centerline, ACrossingTubeHidesItsShadow) {
  scene::Scene scene;
  scene.scanner.position = {0, 0, 2};
  scene.tubes = {straight_tube({-0.25, 0, 0.0125}, {0.25, 0, 0.0125}),
                 straight_tube({0, -0.2, 0.0375}, {0, 0.2, 0.0375})};
  const auto samples = sample_centerlines(scene);
  const double hidden = 0.025 * (2.0 - 0.0125) / (2.0 - 0.0375);
  EXPECT_NEAR(samples[0].visible_fraction(), 1.0 - hidden / 0.5, 0.011);
  EXPECT_EQ(samples[1].visible_fraction(), 1.0);
}

TEST(Centerline, ATubeUnderAnotherAlongItsWholeLengthIsHidden) {
  scene::Scene scene;
  scene.scanner.position = {0, 0, 2};
  scene.tubes = {straight_tube({0, -0.2, 0.0125}, {0, 0.2, 0.0125}),
                 straight_tube({0, -0.25, 0.0375}, {0, 0.25, 0.0375})};
  EXPECT_EQ(sample_centerlines(scene)[0].visible_fraction(), 0.0);
}

}  // namespace
}  // namespace tubebin::evaluation
