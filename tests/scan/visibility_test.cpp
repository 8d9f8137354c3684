#include "tubebin/scan/visibility.hpp"

#include <gtest/gtest.h>

#include <map>

#include "scan/random_scene.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::scan {
namespace {

using testing::look_closely;
using testing::random_scene;

constexpr float kRounding = 1e-5F;  // metres: of float32 points

/// The full image that the scanner makes of these tubes, with the bin and what stands around, or with a bin that hides
/// nothing.
cloud::Cloud scan_all(const scene::Scene& scene, const std::vector<scene::PlacedTube>& tubes, bool with_bin) {
  scene::Scene shown = {scene.bin, scene.scanner, tubes};
  shown.scanner.region = scene::ScanRegion::full;
  if (with_bin) shown.surroundings = scene.surroundings;
  else shown.bin = {.length = 1e-6, .width = 1e-6, .height = 1e-6, .wall_thickness = 1e-6};
  return scan(shown).cloud;
}

double depth_of(const cloud::Cloud& cloud, std::size_t i) {
  return (cloud.world_from_sensor.inverse() * cloud.points[i].cast<double>()).z();
}

/// The views and occlusions of a scene are what scans of it with one or two bodies in it show.
void expect_agreement_with_scans(const scene::Scene& scene) {
  const auto views = view_tubes_alone(scene);
  ASSERT_EQ(views.size(), scene.tubes.size());
  std::map<std::pair<cloud::Label, cloud::Label>, std::size_t> expected;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const cloud::Cloud alone = scan_all(scene, {scene.tubes[k]}, false);
    std::size_t seen = 0;
    for (const SeenPixel& pixel : views[k]) {
      const std::size_t i = static_cast<std::size_t>(pixel.row) * alone.width + static_cast<std::size_t>(pixel.column);
      ASSERT_EQ(alone.labels[i], 1U) << "tube " << k + 1 << " at " << pixel.column << ", " << pixel.row;
      ASSERT_NEAR(depth_of(alone, i), pixel.depth, kRounding);
    }
    for (const cloud::Label label : alone.labels) seen += label == 1;
    EXPECT_EQ(views[k].size(), seen) << "tube " << k + 1;

    const auto count_hidden = [&](const cloud::Cloud& together, cloud::Label front) {
      for (std::size_t i = 0; i < together.size(); ++i)
        if (alone.labels[i] == 1 && together.labels[i] != 1) ++expected[{static_cast<cloud::Label>(k + 1), front}];
    };
    count_hidden(scan_all(scene, {scene.tubes[k]}, true), 0);
    for (std::size_t j = 0; j < views.size(); ++j)
      if (j != k)
        count_hidden(scan_all(scene, {scene.tubes[k], scene.tubes[j]}, false), static_cast<cloud::Label>(j + 1));
  }
  std::map<std::pair<cloud::Label, cloud::Label>, std::size_t> found;
  for (const scene::Occlusion& occlusion : find_occlusions(scene, views))
    found[{occlusion.behind, occlusion.front}] = occlusion.pixels;
  EXPECT_EQ(found, expected);
}

/// Counting alone gives what the pixels give.
void expect_same_counts(const scene::Scene& scene) {
  const auto views = view_tubes_alone(scene);
  const PileView pile = view_pile(scene);
  ASSERT_EQ(pile.amodal_pixels.size(), views.size());
  for (std::size_t k = 0; k < views.size(); ++k) EXPECT_EQ(pile.amodal_pixels[k], views[k].size()) << "tube " << k + 1;
  EXPECT_EQ(pile.occlusions, find_occlusions(scene, views));
}

TEST(Visibility, CountingAgreesWithThePixels) {
  for (std::uint64_t seed = 61; seed < 81; ++seed) {
    scene::Scene scene = random_scene(2 + static_cast<int>(seed % 10), seed);
    if (seed % 2 == 0) look_closely(scene.scanner, 500, 300);
    expect_same_counts(scene);
    scene.scanner.position = {0.9, -0.1, 0.7};  // walls before tubes, tubes partly outside the image
    scene.scanner.rotation_deg = {0.0, 55.0, 0.0};
    expect_same_counts(scene);
    scene.scanner.horizontal_fov_deg /= 3.0;
    expect_same_counts(scene);
  }
}

TEST(Visibility, CountingAgreesWhereTheRangeCutsTubesAndWhereTheyAreHollow) {
  scene::Scene scene = random_scene(6, 91);
  scene.scanner.range_max = 1.92;
  expect_same_counts(scene);
  scene.scanner.range_min = 1.85;
  expect_same_counts(scene);
  scene = random_scene(6, 92);
  for (scene::PlacedTube& tube : scene.tubes) tube.tube.wall_thickness = 0.2 * tube.tube.radius;
  expect_same_counts(scene);
}

TEST(Visibility, AgreesWithScansOfOneAndTwoBodies) {
  for (std::uint64_t seed = 21; seed < 24; ++seed) {
    scene::Scene scene = random_scene(5, seed);
    look_closely(scene.scanner, 240, 150);
    expect_agreement_with_scans(scene);
  }
}

TEST(Visibility, AgreesWhenTheScannerIsTiltedAndTheBinCovers) {
  scene::Scene scene = random_scene(5, 31);
  look_closely(scene.scanner, 240, 150);
  scene.scanner.position = {0.9, -0.1, 0.7};
  scene.scanner.rotation_deg = {0.0, 55.0, 0.0};
  expect_agreement_with_scans(scene);
}

TEST(Visibility, AgreesWhenWhatStandsAroundCovers) {
  scene::Scene scene = random_scene(5, 32);
  look_closely(scene.scanner, 240, 150);
  scene.scanner.position = {1.2, -0.1, 0.9};
  scene.scanner.rotation_deg = {0.0, 55.0, 0.0};
  expect_same_counts(scene);
  const PileView before = view_pile(scene);
  scene.surroundings = {.table = {.position = {0.0, 0.0, -0.05}, .size = {1.4, 1.2, 0.03}},
                        .boxes = {{.position = {0.45, -0.1, -0.02}, .yaw_deg = 20.0, .size = {0.1, 0.1, 0.5}}},
                        .cylinders = {{.position = {0.5, 0.1, -0.02}, .radius = 0.05, .height = 0.4}},
                        .bins = {{.position = {0.0, 0.75, 0.0}, .yaw_deg = 100.0}}};
  expect_same_counts(scene);
  expect_agreement_with_scans(scene);
  EXPECT_EQ(view_pile(scene).amodal_pixels, before.amodal_pixels);
  EXPECT_NE(view_pile(scene).occlusions, before.occlusions);
}

TEST(Visibility, AgreesWhenTheRangeBeginsAmongTheTubesAndEndsBeforeTheFloor) {
  scene::Scene scene = random_scene(5, 41);
  look_closely(scene.scanner, 240, 150);
  scene.scanner.range_min = 1.85;
  scene.scanner.range_max = 1.92;
  expect_agreement_with_scans(scene);
}

TEST(Visibility, WhatNobodyCoversIsWhatTheScanShows) {
  scene::Scene scene = random_scene(8, 51);
  const auto views = view_tubes_alone(scene);
  const Scan scanned = scan(scene);
  std::vector<std::size_t> covered(scene.tubes.size(), 0);
  for (const scene::Occlusion& occlusion : find_occlusions(scene, views))
    covered[occlusion.behind - 1] += occlusion.pixels;
  for (std::size_t k = 0; k < views.size(); ++k) {
    EXPECT_GE(views[k].size(), scanned.tube_pixels[k]);
    EXPECT_GE(scanned.tube_pixels[k] + covered[k], views[k].size());  // several may cover one pixel
  }
}

TEST(Visibility, ACrossCoversItsOwnWidth) {
  scene::Scene scene;
  const auto bar = [](const Vec3& a, const Vec3& b) {
    return scene::PlacedTube{{.radius = 0.0125, .nodes = {a, b}, .cylinders = {{0, 1, 0}}}, Pose::Identity()};
  };
  scene.tubes = {bar({-0.2, 0, 0.02}, {0.2, 0, 0.02}), bar({0, -0.1, 0.06}, {0, 0.1, 0.06})};
  const auto views = view_tubes_alone(scene);
  const auto occlusions = find_occlusions(scene, views);
  ASSERT_EQ(occlusions.size(), 1U);
  EXPECT_EQ(occlusions[0].front, 2U);
  EXPECT_EQ(occlusions[0].behind, 1U);
  // Both 25 mm wide, at depths 1.98 m (axis) and 1.94 m; 960 / tan(0.61) = 1373 pixels a metre at 1 m.
  const double focal_length = 960.0 / std::tan(0.61);
  const double expected = (0.025 / 1.98 * focal_length) * (0.025 / 1.94 * focal_length);
  EXPECT_NEAR(static_cast<double>(occlusions[0].pixels), expected, 0.08 * expected);
}

}  // namespace
}  // namespace tubebin::scan
