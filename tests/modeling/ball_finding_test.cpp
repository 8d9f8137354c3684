#include "modeling/fitting/ball_finding.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kBall = 0.025;  // metres

/// Two tubes, and a ball that touches the floor and one of them.
scene::Scene tubes_and_ball() {
  const double aside = std::sqrt(4.0 * kRadius * kBall);  // of centres at their radii's heights whose surfaces touch
  scene::PlacedTube ball{{.radius = kBall, .mass = 0.03, .nodes = {{0.03, aside, kBall}}, .cylinders = {}},
                         Pose::Identity()};
  return scene_of({tube_along({{-0.2, 0.0, kRadius}, {0.2, 0.0, kRadius}}),
                   tube_along({{-0.15, -0.12, kRadius}, {0.0, -0.08, kRadius}, {0.15, -0.12, kRadius}}), ball});
}

class Balls : public ::testing::TestWithParam<double> {};  // metres, of range noise

TEST_P(Balls, AreFoundBeforeAKnownBin) {
  const scene::Scene scene = tubes_and_ball();
  cloud::Cloud cloud = scan::scan(scene).cloud;
  add_range_noise(cloud, GetParam(), 3);
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), {});
  ASSERT_EQ(result.tubes.size(), 3U);
  const TubeModel& ball = result.tubes.back();
  ASSERT_TRUE(ball.is_ball());
  EXPECT_NEAR(ball.radius, kBall, 1e-4 + GetParam() / 2.0);
  EXPECT_LT((ball.paths.front().nodes.front() - scene.tubes.back().node_in_world(0)).norm(), 1e-4 + GetParam());
  EXPECT_EQ(result.radii.size(), 1U);
  EXPECT_GT(micro_recall_of(result, cloud), 0.99);
}

INSTANTIATE_TEST_SUITE_P(Noise, Balls, ::testing::Values(0.0, 0.0003));

TEST(Ball, IsNoneWithoutABin) {
  const cloud::Cloud cloud = scan::scan(tubes_and_ball()).cloud;
  ModelingInput input = input_of(cloud, {});
  input.bin.reset();
  const ModelingResult result = model_tubes(input, {});
  for (const TubeModel& tube : result.tubes) EXPECT_FALSE(tube.is_ball());
}

/// What a scanner above sees of a ball.
FilteredCloud cap_of_ball(const Vec3& center) {
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = 0.001};
  constexpr int kPoints = 4000;
  for (int k = 0; k < kPoints / 2; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / kPoints, angle = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const Vec3 normal(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
    cloud.points.push_back((center + kBall * normal).cast<float>());
  }
  return cloud;
}

TEST(Ball, TakesWhatTubesHaveOnItsSurface) {
  const Vec3 center(0.1, 0.2, 0.3);
  const FilteredCloud cloud = cap_of_ball(center);
  const CurvedPlaces places = curved_places_of(cloud);
  const TubePiece on_ball{
      .nodes = {center + Vec3(-0.01, 0.0, 0.01), center + Vec3(0.01, 0.0, 0.01)}, .radius = kRadius, .points = {}};
  const TubePiece beside{.nodes = {center, center + Vec3(0.2, 0.0, 0.0)}, .radius = kRadius, .points = {}};
  std::vector<TubeClass> classes = {{.radius = kRadius, .radius_error = 0.0, .pieces = {on_ball, beside}},
                                    {.radius = 0.008, .radius_error = 0.0, .pieces = {on_ball}}};
  const std::vector<TubePiece> balls = find_balls(places.round, cloud, view_from_above(), 0.0, classes);
  ASSERT_EQ(balls.size(), 1U);
  EXPECT_LT((balls.front().nodes.front() - center).norm(), 1e-6);
  EXPECT_NEAR(balls.front().radius, kBall, 1e-6);
  ASSERT_EQ(classes.size(), 1U);
  ASSERT_EQ(classes.front().pieces.size(), 1U);
  EXPECT_EQ(classes.front().pieces.front().nodes, beside.nodes);
}

TEST(Ball, IsNoneAsThickAsTubes) {
  const FilteredCloud cloud = cap_of_ball(Vec3::Zero());
  const CurvedPlaces places = curved_places_of(cloud);
  std::vector<TubeClass> classes = {{.radius = kBall,
                                     .radius_error = 0.0,
                                     .pieces = {{.nodes = {{0, 0, 0}, {0.2, 0, 0}}, .radius = kBall, .points = {}}}}};
  EXPECT_TRUE(find_balls(places.round, cloud, view_from_above(), 0.0, classes).empty());
  EXPECT_EQ(classes.size(), 1U);
}

TEST(Ball, IsNoneAlongATube) {
  const FilteredCloud cloud = upper_half_of({{-0.1, 0, 0}, {0.0, 0, 0}, {0.08, 0.06, 0}});
  const CurvedPlaces places = curved_places_of(cloud);
  std::vector<TubeClass> classes;
  EXPECT_TRUE(find_balls(places.round, cloud, view_from_above(), 0.0, classes).empty());
}

/// Few points of a tube, as downsampling leaves them, were taken for balls of a metre to 800 km.
TEST(Ball, IsNoneOnAFlatPatch) {
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = 0.001};
  Random random(7);
  for (double x = -0.01; x <= 0.01; x += 0.001)
    for (double y = -0.01; y <= 0.01; y += 0.001)
      cloud.points.push_back(Vec3(x, y, 1e-4 * random.normal()).cast<float>());
  std::vector<TubeClass> classes;
  for (const double radius : {0.05, 0.1, 0.3, 1.0, 10.0}) {
    const std::vector<RoundPlace> round(4, {.center = {0, 0, -radius}, .radius = radius});
    EXPECT_TRUE(find_balls(round, cloud, view_from_above(), 1e-4, classes).empty()) << radius;
  }
}

}  // namespace
}  // namespace tubebin::modeling
