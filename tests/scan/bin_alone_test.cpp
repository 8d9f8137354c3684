// Scans that take what the bin alone looks like from before: they are those that trace every ray.
#include <gtest/gtest.h>

#include <algorithm>

#include "scan/random_scene.hpp"
#include "scan/same_points.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::scan {
namespace {

constexpr std::uint64_t kSeed = 7;

scene::Scene small_scene(std::uint64_t seed) {
  scene::Scene scene = testing::random_scene(6, seed);
  testing::look_closely(scene.scanner, 240, 150);
  return scene;
}

void expect_same(const MergedScan& scanned, const MergedScan& fresh) {
  EXPECT_TRUE(testing::same_points(scanned.cloud, fresh.cloud));
  EXPECT_EQ(scanned.cloud.labels, fresh.cloud.labels);
  EXPECT_EQ(scanned.cloud.colors, fresh.cloud.colors);
  EXPECT_EQ(scanned.cloud.sources, fresh.cloud.sources);
  EXPECT_EQ(scanned.cloud.width, fresh.cloud.width);
  EXPECT_EQ(scanned.window, fresh.window);
  EXPECT_EQ(scanned.further_windows, fresh.further_windows);
  EXPECT_EQ(scanned.tube_pixels, fresh.tube_pixels);
}

/// Whatever part of the image becomes the cloud, with and without effects.
void expect_no_difference(scene::Scene scene) {
  const std::vector<Scan> bins_alone = scan_bin_alone(scene);
  for (const scene::ScanRegion region : {scene::ScanRegion::bin, scene::ScanRegion::full, scene::ScanRegion::tubes}) {
    SCOPED_TRACE(static_cast<int>(region));
    scene.scanner.region = region;
    scene.scanner.effects = {};
    const MergedScan fresh = scan_from_all(scene, kSeed);
    EXPECT_GT(fresh.cloud.size(), 1000u);
    expect_same(scan_from_all(scene, kSeed, bins_alone), fresh);
    scene.scanner.effects.range_noise.sigma = 0.001;
    expect_same(scan_from_all(scene, kSeed, bins_alone), scan_from_all(scene, kSeed));
    expect_same(scan_exactly_from_all(scene, bins_alone), fresh);
  }
}

TEST(BinAlone, ChangesNoByteOfAScan) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) expect_no_difference(small_scene(seed));
}

TEST(BinAlone, ChangesNoByteFromTheSide) {
  scene::Scene scene = small_scene(5);
  scene.scanner.position = {1.0, -0.15, 1.2};
  scene.scanner.rotation_deg = {20.0, 37.0, 20.0};
  expect_no_difference(scene);
  scene.scanner.position = {0.05, 0.0, 0.1};  // within the bin's space, so that the image is full of it
  scene.scanner.horizontal_fov_deg = 90.0;
  scene.scanner.range_min = 0.15;  // within the floor and the walls
  expect_no_difference(scene);
}

TEST(BinAlone, ChangesNoByteInOtherBinsAndAmongWhatStandsAround) {
  scene::Scene scene = small_scene(6);
  scene.bin.draft_deg = 7.0;
  scene.bin.rim_width = 0.03;
  scene.bin.corner_radius = 0.05;
  expect_no_difference(scene);
  scene.surroundings = {{.table = {.position = {0.0, 0.0, -0.05}, .size = {1.4, 1.2, 0.03}},
                         .boxes = {{.position = {0.25, 0.1, -0.02}, .yaw_deg = 35.0, .size = {0.2, 0.1, 0.3}}},
                         .cylinders = {{.position = {-0.4, -0.2, -0.02}, .radius = 0.06, .height = 0.5}},
                         .bins = {{.position = {0.1, 0.55, 0.0}, .yaw_deg = 100.0}}}};
  expect_no_difference(scene);
}

TEST(BinAlone, ChangesNoByteInABinFromAMesh) {
  scene::Scene scene = small_scene(7);
  scene.bin.mesh = "tub.stl";
  scene.bin.mesh_scale = 0.001;
  scene::load_mesh(scene.bin, TUBEBIN_SOURCE_DIR "/config");
  expect_no_difference(scene);
}

TEST(BinAlone, ChangesNoByteOfWhatSeveralScannersSee) {
  scene::Scene scene = small_scene(8);
  scene.further_scanners.assign(2, scene.scanner);
  scene.further_scanners[0].position = {0.9, -0.1, 1.7};
  scene.further_scanners[0].rotation_deg = {0.0, 28.0, 0.0};
  scene.further_scanners[1].region = scene::ScanRegion::tubes;
  expect_no_difference(scene);
}

TEST(BinAlone, IsWhereMostPointsOfTheBinComeFrom) {
  const scene::Scene scene = small_scene(9);
  std::vector<Scan> bins_alone = scan_bin_alone(scene);
  const cloud::Point elsewhere(1.0F, 2.0F, 3.0F);
  std::ranges::fill(bins_alone.front().cloud.points, elsewhere);
  const cloud::Cloud cloud = scan_from_all(scene, kSeed, bins_alone).cloud;
  std::size_t taken = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.points[i] != elsewhere) continue;
    EXPECT_EQ(cloud.labels[i], 0u);
    ++taken;
  }
  EXPECT_GT(2 * taken, static_cast<std::size_t>(std::ranges::count(cloud.labels, 0u)));
}

}  // namespace
}  // namespace tubebin::scan
