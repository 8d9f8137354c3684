// Which part of the image a scan shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scan/random_scene.hpp"
#include "scan/signed_distance.hpp"
#include "tubebin/core/geometry.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {
namespace {

using testing::random_scene;
using testing::SphereTracer;

TEST(ScanWindow, RegionsShowTheSameSurfaces) {
  scene::Scene scene = random_scene(10, 12);
  const Scan bin = scan(scene);
  scene.scanner.region = scene::ScanRegion::full;
  const Scan full = scan(scene);
  scene.scanner.region = scene::ScanRegion::tubes;
  const Scan tubes = scan(scene);

  ASSERT_EQ(full.cloud.size(), 1920u * 1200u);
  ASSERT_EQ(full.window, (scene::PixelWindow{0, 0, 1920, 1200}));
  EXPECT_EQ(tubes.cloud.height, 1u);
  EXPECT_EQ(tubes.cloud.width, tubes.cloud.size());
  EXPECT_LT(bin.cloud.size(), full.cloud.size() / 8);

  std::size_t tube_point = 0;
  for (std::size_t i = 0; i < full.cloud.size(); ++i) {
    const int column = static_cast<int>(i % 1920) - bin.window.x, row = static_cast<int>(i / 1920) - bin.window.y;
    if (column < 0 || row < 0 || column >= bin.window.width || row >= bin.window.height) {
      ASSERT_FALSE(cloud::is_finite(full.cloud.points[i]));
      continue;
    }
    const std::size_t j = static_cast<std::size_t>(row) * bin.cloud.width + static_cast<std::size_t>(column);
    ASSERT_EQ(cloud::is_finite(full.cloud.points[i]), cloud::is_finite(bin.cloud.points[j]));
    ASSERT_EQ(full.cloud.labels[i], bin.cloud.labels[j]);
    ASSERT_EQ(full.cloud.colors[i], bin.cloud.colors[j]);
    if (cloud::is_finite(full.cloud.points[i])) {
      ASSERT_EQ(full.cloud.points[i], bin.cloud.points[j]);
    }
    if (full.cloud.labels[i] == 0) continue;
    ASSERT_LT(tube_point, tubes.cloud.size());
    ASSERT_EQ(full.cloud.points[i], tubes.cloud.points[tube_point]);
    ASSERT_EQ(full.cloud.labels[i], tubes.cloud.labels[tube_point]);
    ++tube_point;
  }
  EXPECT_EQ(tube_point, tubes.cloud.size());
  EXPECT_EQ(full.tube_pixels, bin.tube_pixels);
  EXPECT_EQ(full.tube_pixels, tubes.tube_pixels);
}

/// The smallest window that has all that the image shows, found pixel by pixel without the scanner.
scene::PixelWindow traced_window(const scene::Scene& scene) {
  const scene::Camera camera(scene.scanner);
  const SphereTracer tracer(scene);
  int left = camera.width(), right = -1, top = camera.height(), bottom = -1;
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      if (!tracer.trace(camera.pixel_direction_in_world(column, row)).found) continue;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
    }
  }
  return {left, top, right - left + 1, bottom - top + 1};
}

/// `slack` more pixels on a side are allowed: the tip of a corner may lie between pixel centres.
void expect_window_covers(const scene::PixelWindow& window, const scene::PixelWindow& traced, int slack) {
  EXPECT_LE(window.x, traced.x);
  EXPECT_LE(window.y, traced.y);
  EXPECT_GE(window.x + window.width, traced.x + traced.width);
  EXPECT_GE(window.y + window.height, traced.y + traced.height);
  EXPECT_LE(window.width, traced.width + 2 * slack);
  EXPECT_LE(window.height, traced.height + 2 * slack);
}

TEST(ScanWindow, IsTheSmallestThatShowsBinAndTubes) {
  scene::Scene scene = random_scene(6, 13);
  scene.scanner.width = 192;
  scene.scanner.height = 120;
  expect_window_covers(scan(scene).window, traced_window(scene), 0);
  scene.scanner.position = {0.8, -0.3, 1.0};
  scene.scanner.rotation_deg = {15.0, 38.0, 0.0};
  expect_window_covers(scan(scene).window, traced_window(scene), 1);
  scene.scanner.position = {0.3, 0.3, 1.0};  // the bin reaches out of the image
  scene.scanner.rotation_deg = {0.0, 0.0, 30.0};
  expect_window_covers(scan(scene).window, traced_window(scene), 5);
}

TEST(ScanWindow, OfTubesAloneIsTheirs) {
  scene::Scene scene = random_scene(6, 18);
  scene.bin.length = scene.bin.width = 0.01;  // so small that the tubes alone decide
  scene.bin.height = 0.001;
  scene.scanner.width = 192;
  scene.scanner.height = 120;
  for (const double pitch : {0.0, 20.0}) {
    scene.scanner.rotation_deg.y() = pitch;
    scene.scanner.position.x() = 2.0 * std::tan(radians(pitch));
    scene.scanner.region = scene::ScanRegion::tubes;
    expect_window_covers(scan(scene).window, traced_window(scene), 1);
  }
}

}  // namespace
}  // namespace tubebin::scan
