// One cloud of several scanners: whose points are in it, and that their own scanners see them.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scan/random_scene.hpp"
#include "scan/signed_distance.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scan/visibility.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {
namespace {

using testing::look_closely;
using testing::random_scene;
using testing::SphereTracer;

scene::Scene scene_of_three(std::uint64_t seed) {
  scene::Scene scene = random_scene(6, seed);
  look_closely(scene.scanner, 120, 76);
  scene.further_scanners.assign(2, scene.scanner);
  scene.further_scanners[0].position = {0.9, -0.1, 1.7};
  scene.further_scanners[0].rotation_deg = {0.0, 28.0, 0.0};
  scene.further_scanners[1].position = {-0.5, 0.6, 1.5};
  scene.further_scanners[1].rotation_deg = {-22.0, -18.0, 0.0};
  scene.further_scanners[1].region = scene::ScanRegion::tubes;
  return scene;
}

TEST(MergedScan, OfOneScannerIsItsScan) {
  const scene::Scene scene = random_scene(4, 2);
  const Scan alone = scan(scene);
  const MergedScan merged = scan_from_all(scene);
  EXPECT_EQ(merged.cloud.labels, alone.cloud.labels);
  EXPECT_EQ(merged.cloud.width, alone.cloud.width);
  EXPECT_TRUE(merged.cloud.sources.empty());
  EXPECT_TRUE(merged.further_windows.empty());
}

/// Sphere tracing from each point's own scanner, through the pixel that the point falls into, finds the point.
TEST(MergedScan, EachPointIsTheFirstSurfaceThatItsScannerSees) {
  const scene::Scene scene = scene_of_three(3);
  const MergedScan merged = scan_exactly_from_all(scene);
  ASSERT_EQ(merged.cloud.sources.size(), merged.cloud.size());
  EXPECT_FALSE(merged.cloud.organized());
  std::vector<std::size_t> points_of(3, 0), tube_points(scene.tubes.size(), 0);
  std::vector<scene::Scene> views;
  std::vector<scene::Camera> cameras;
  std::vector<SphereTracer> tracers;
  for (std::size_t source = 0; source < 3; ++source) {
    views.push_back(seen_from(scene, source));
    cameras.emplace_back(views.back().scanner);
    tracers.emplace_back(views.back());
  }
  for (std::size_t i = 0; i < merged.cloud.size(); ++i) {
    const std::uint32_t source = merged.cloud.sources[i];
    const cloud::Label label = merged.cloud.labels[i];
    const Vec3 point = merged.cloud.points[i].cast<double>();
    ++points_of.at(source);
    if (label > 0) ++tube_points[label - 1];
    if (i % 31 != 0) continue;
    const Eigen::Vector2d pixel = cameras[source].project_from_world(point);
    ASSERT_NEAR(pixel.x() - std::floor(pixel.x()), 0.5, 1e-3);
    ASSERT_NEAR(pixel.y() - std::floor(pixel.y()), 0.5, 1e-3);
    const auto traced = tracers[source].trace(
        cameras[source].direction_in_world(std::floor(pixel.x()) + 0.5, std::floor(pixel.y()) + 0.5));
    ASSERT_TRUE(traced.found);
    EXPECT_EQ(traced.label, label);
    EXPECT_LT((traced.point - point).norm(), 2e-5);
  }
  EXPECT_EQ(tube_points, merged.tube_pixels);
  // And none is missing: pixel by pixel, tracing hits as often as each scanner has points.
  for (std::size_t source = 0; source < 3; ++source) {
    std::size_t hits = 0;
    for (int row = 0; row < cameras[source].height(); ++row)
      for (int column = 0; column < cameras[source].width(); ++column) {
        const auto traced = tracers[source].trace(cameras[source].pixel_direction_in_world(column, row));
        hits += traced.found && (traced.label > 0 || views[source].scanner.region != scene::ScanRegion::tubes);
      }
    EXPECT_EQ(points_of[source], hits) << "source " << source;
    EXPECT_GT(hits, 300U);
  }
}

TEST(MergedScan, EachScannerErrsInItsOwnWay) {
  scene::Scene scene = random_scene(4, 5);
  look_closely(scene.scanner, 200, 120);
  scene.scanner.effects.range_noise.sigma = 0.001;
  scene.further_scanners = {scene.scanner};
  const MergedScan merged = scan_from_all(scene, 42);
  const cloud::Cloud alone = scan(seen_from(scene, 0), 42).cloud;
  std::vector<cloud::Point> expected;
  for (const cloud::Point& point : alone.points)
    if (cloud::is_finite(point)) expected.push_back(point);
  const std::size_t count = expected.size();
  ASSERT_EQ(merged.cloud.size(), 2 * count);
  std::size_t equal = 0;
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(merged.cloud.points[i], expected[i]) << "source 0 is as it is alone";
    equal += merged.cloud.points[i] == merged.cloud.points[count + i];
  }
  EXPECT_LT(equal, count / 100);
}

TEST(MergedScan, CountsPixelsOfAllScanners) {
  const scene::Scene scene = scene_of_three(6);
  std::vector<std::size_t> amodal(scene.tubes.size(), 0);
  std::map<std::pair<cloud::Label, cloud::Label>, std::size_t> pixels;
  for (std::size_t source = 0; source < 3; ++source) {
    const scene::Scene view = seen_from(scene, source);
    const auto views = view_tubes_alone(view);
    for (std::size_t k = 0; k < views.size(); ++k) amodal[k] += views[k].size();
    for (const scene::Occlusion& occlusion : find_occlusions(view, views))
      pixels[{occlusion.behind, occlusion.front}] += occlusion.pixels;
  }
  const PileView pile = view_pile(scene);
  EXPECT_EQ(pile.amodal_pixels, amodal);
  ASSERT_EQ(pile.occlusions.size(), pixels.size());
  auto expected = pixels.begin();
  for (const scene::Occlusion& occlusion : pile.occlusions) {
    EXPECT_EQ(std::pair(occlusion.behind, occlusion.front), expected->first);
    EXPECT_EQ(occlusion.pixels, expected->second);
    ++expected;
  }
}

}  // namespace
}  // namespace tubebin::scan
