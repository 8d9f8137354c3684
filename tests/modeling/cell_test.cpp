// Tubes in a bin that stands in a cell, and bins that nobody describes.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "modeling/built_scene.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {
namespace {

/// One tube over three in a bin on a table among boxes and bottles, seen whole.
scene::Scene one_over_three_in_a_cell() {
  scene::Scene scene = one_over_three();
  const double floor = -scene.bin.wall_thickness;
  scene.surroundings =
      scene::Surroundings{.table = {.position = {0, 0, floor - 0.03}, .yaw_deg = 0.0, .size = {1.6, 1.2, 0.03}},
                          .boxes = {{.position = {0.5, 0.1, floor}, .yaw_deg = 20.0, .size = {0.2, 0.15, 0.4}},
                                    {.position = {-0.45, -0.2, floor}, .yaw_deg = -10.0, .size = {0.15, 0.2, 0.35}}},
                          .cylinders = {},
                          .bins = {}};
  scene.scanner.region = scene::ScanRegion::full;
  return scene;
}

/// All tubes are found, and nothing else is taken for one.
void expect_the_tubes_alone(const ModelingResult& result, const cloud::Cloud& cloud, std::size_t tubes = 4) {
  EXPECT_EQ(result.tubes.size(), tubes);
  EXPECT_NEAR(result.radius, kRadius, 0.01 * kRadius);
  std::size_t of_tubes = 0, found = 0, false_points = 0;
  for (const cloud::Label label : cloud.labels) of_tubes += label > 0;
  for (std::size_t i = 0; i < result.source.size(); ++i) {
    const bool is_tube = cloud.labels[result.source[i]] > 0;
    found += is_tube && result.labels[i] > 0;
    false_points += !is_tube && result.labels[i] > 0;
  }
  EXPECT_GT(found, 0.97 * static_cast<double>(of_tubes));  // the others lie next to the floor
  EXPECT_LT(false_points, 0.005 * static_cast<double>(of_tubes));
}

TEST(Cell, WhatStandsAroundAKnownBinIsNoTube) {
  const scene::Scene scene = one_over_three_in_a_cell();
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), ModelingOptions{});
  expect_the_tubes_alone(result, cloud);
  EXPECT_LT(result.found.unexplained, 0.2);
}

TEST(Cell, BottlesAndEdgesAreNoTubesWhereNothingIsTold) {
  scene::Scene scene = one_over_three_in_a_cell();
  const double floor = -scene.bin.wall_thickness;
  scene.surroundings->cylinders = {{.position = {0.45, -0.3, floor}, .radius = 0.036, .height = 0.33},
                                   {.position = {-0.5, 0.3, floor}, .radius = 0.06, .height = 0.25}};
  scene.scanner.position = {0.0, -0.8, 1.4};
  scene.scanner.rotation_deg = {30.0, 0.0, 0.0};
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  const ModelingResult result = model_tubes(input, ModelingOptions{});
  expect_the_tubes_alone(result, cloud);
  EXPECT_EQ(result.radii.size(), 1u);
}

/// The scene's tubes on a mesh of wires, 5 mm thick and 30 mm apart.
scene::Scene on_a_mesh(scene::Scene scene) {
  constexpr double kHalf = 0.24, kApart = 0.03, kWire = 0.0025, kHeight = 0.03;
  for (scene::PlacedTube& placed : scene.tubes) placed.world_from_tube.translation().z() += kHeight + 3.0 * kWire;
  const auto add_wire = [&](const Vec3& from, const Vec3& to) {
    scene.tubes.push_back(tube_along({from, to}));
    scene.tubes.back().tube.radius = kWire;
  };
  for (double at = -kHalf / 2; at < kHalf / 2 + 0.001; at += kApart)
    add_wire({-kHalf, at, kHeight}, {kHalf, at, kHeight});
  for (double at = -kHalf; at < kHalf + 0.001; at += kApart)
    add_wire({at, -kHalf / 2, kHeight + 2.0 * kWire}, {at, kHalf / 2, kHeight + 2.0 * kWire});
  return scene;
}

TEST(Cell, WiresOfAMeshAreNoTubes) {
  scene::Scene scene = on_a_mesh(one_over_three());
  scene.scanner = looking_from({0.02, 0.0, 1.0});
  cloud::Cloud cloud = scan::scan(scene).cloud;
  for (cloud::Label& label : cloud.labels)
    if (label > 4) label = 0;
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  const ModelingResult result = model_tubes(input, ModelingOptions{});
  expect_the_tubes_alone(result, cloud);
  EXPECT_NEAR(result.found.wire_radius, 0.0025, 0.0001);
  EXPECT_LT(result.found.unexplained, 0.2);
}

TEST(Cell, ATubeMayEndUpright) {
  scene::Scene scene = scene_of(
      {tube_along({{0.0, -0.1, kRadius}, {0.0, 0.02, 0.08}, {0.0, 0.06, 0.15}, {0.0, 0.08, 0.195}, {0.0, 0.08, 0.235}}),
       tube_along({{-0.2, -0.05, kRadius}, {-0.1, 0.1, kRadius}})});
  scene.scanner = looking_from({0.01, 0.0, 1.2});
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  const ModelingResult result = model_tubes(input, ModelingOptions{});
  ASSERT_EQ(result.tubes.size(), 2u);
  double height = 0.0;
  for (const TubeModel& tube : result.tubes)
    for (const Vec3& node : tube.paths.front().nodes) height = std::max(height, node.z());
  EXPECT_NEAR(height, 0.235, 0.001);
}

TEST(Cell, ATubeMayStandAmongTubesOfItsRadius) {
  scene::Scene scene = one_over_three_in_a_cell();
  scene.tubes.push_back(tube_along({{0.1, 0.1, 0.002}, {0.1, 0.1, 0.3}}));
  scene.scanner.position = {0.0, -0.8, 1.4};
  scene.scanner.rotation_deg = {30.0, 0.0, 0.0};
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  for (const ModelingOptions& options : {ModelingOptions{}, known_radius()})
    expect_the_tubes_alone(model_tubes(input, options), cloud, 5);
}

TEST(Cell, FindsTheTubesInABinThatNobodyDescribes) {
  const scene::Scene scene = one_over_three();
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  const ModelingResult result = model_tubes(input, known_radius());
  EXPECT_EQ(result.tubes.size(), 4u);
  // Strips of the bin that are too narrow to be told from tubes' sides stay in the filtered cloud, and get no label.
  std::size_t tube_points = 0, labelled = 0, false_points = 0;
  for (std::size_t k = 0; k < result.source.size(); ++k) {
    const bool is_tube = cloud.labels[result.source[k]] > 0;
    tube_points += is_tube, labelled += is_tube && result.labels[k] > 0,
        false_points += !is_tube && result.labels[k] > 0;
  }
  const auto all =
      std::count_if(cloud.labels.begin(), cloud.labels.end(), [](cloud::Label label) { return label > 0; });
  EXPECT_GE(static_cast<double>(tube_points), 0.99 * static_cast<double>(all));
  EXPECT_GE(static_cast<double>(labelled), 0.99 * static_cast<double>(all));
  EXPECT_LE(static_cast<double>(false_points), 0.005 * static_cast<double>(all));
}

/// A bin about the world's origin, to a tolerance in metres.
void expect_bin(const std::optional<BinFound>& found, const scene::Bin& bin, double tolerance) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->length, bin.length, tolerance);
  EXPECT_NEAR(found->width, bin.width, tolerance);
  EXPECT_NEAR(found->height, bin.height, 0.001);
  EXPECT_LT(found->world_from_bin.translation().norm(), tolerance);
  EXPECT_GT(std::abs(found->world_from_bin.linear()(0, 0)), 0.9999);
}

/// The cell seen so obliquely that the bin hides one of its walls.
scene::Scene with_a_hidden_wall() {
  scene::Scene scene = one_over_three_in_a_cell();
  scene.bin.draft_deg = 3.0;
  scene.surroundings->bins = {{.position = {0.0, 0.65, 0.0}, .yaw_deg = 8.0}};
  scene.scanner.position = {0.0, -0.9, 1.4};
  scene.scanner.rotation_deg = {33.0, 0.0, 0.0};
  return scene;
}

TEST(Cell, FindsTheBinWithTheTubesWhereItHidesAWall) {
  const scene::Scene scene = with_a_hidden_wall();
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  expect_bin(model_tubes(input, known_radius()).found.bin, scene.bin, 0.004);
}

TEST(Cell, AHiddenWallIsNoneThatIsAsFarAwayAsWallsAreLookedFor) {
  const scene::Scene scene = with_a_hidden_wall();
  cloud::Cloud cloud = scan::scan(scene).cloud;
  for (double y = -2.9; y < -2.8; y += 0.0005)  // 3 m from the wall across, as high as walls are
    for (double x = -0.25; x < 0.25; x += 0.001) cloud.points.push_back(Vec3(x, y, scene.bin.height).cast<float>());
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  input.width = 0;
  expect_bin(model_tubes(input, known_radius()).found.bin, scene.bin, 0.004);
}

TEST(Cell, FindsTheBinThatNobodyDescribes) {
  const scene::Scene scene = one_over_three();
  cloud::Cloud cloud = scan::scan(scene).cloud;
  ModelingInput input = input_of(cloud, scene.bin);
  input.bin.reset();
  const std::optional<BinFound> bin = model_tubes(input, known_radius()).found.bin;
  expect_bin(bin, scene.bin, 0.002);

  for (cloud::Point& point : cloud.points)  // out of sight: a wall
    if (point.x() > 0.25F) point.x() = std::numeric_limits<float>::quiet_NaN();
  input.points = cloud.points;
  EXPECT_FALSE(model_tubes(input, known_radius()).found.bin);
}

}  // namespace
}  // namespace tubebin::modeling
