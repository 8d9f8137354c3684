// The published scenes, scanned as their authors did, against signed distances and sphere tracing.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "scan/signed_distance.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/camera.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::scan {
namespace {

class PublishedScene : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string path = std::string(PUBLISHED_SCENES_DIR) + "/" + GetParam() + ".txt";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is missing";
    scene_.bin = {0.80, 0.60, 0.20, 0.02};
    scene_.scanner.range_max = 2.0;
    scene_.tubes = scene::read_tubes_txt(path);
  }

  scene::Scene scene_;
};

TEST_P(PublishedScene, PointsLieOnTheSurfacesTheyName) {
  const Scan result = scan(scene_);
  EXPECT_LT(testing::worst_surface_distance(scene_, result.cloud), 5e-6);
  for (const std::size_t pixels : result.tube_pixels) EXPECT_GT(pixels, 0u);
}

/// Compares pixels along silhouettes, where another label is next to them, and others here and there.
TEST_P(PublishedScene, LabelsAgreeWithSphereTracingAlongSilhouettes) {
  const Scan result = scan(scene_);
  const scene::Camera camera(scene_.scanner);
  const cloud::Cloud& cloud = result.cloud;
  const testing::SphereTracer tracer(scene_);
  std::size_t silhouettes = 0, compared = 0, wrong = 0;
  for (std::size_t i = 1; i < cloud.size(); ++i) {
    const bool silhouette = cloud.labels[i] != cloud.labels[i - 1];
    if (silhouette) ++silhouettes;
    if (!(silhouette && silhouettes % 4 == 0) && i % 501 != 0) continue;
    const int column = result.window.x + static_cast<int>(i % cloud.width);
    const int row = result.window.y + static_cast<int>(i / cloud.width);
    const auto traced = tracer.trace(camera.pixel_direction_in_world(column, row));
    ++compared;
    if (traced.found != cloud::is_finite(cloud.points[i]) || (traced.found && traced.label != cloud.labels[i])) ++wrong;
  }
  EXPECT_GT(compared, 500u);
  EXPECT_EQ(wrong, 0u);
}

TEST_P(PublishedScene, FloorAtTheRangesEndIsThere) {
  const Scan result = scan(scene_);
  std::size_t holes = 0;
  for (const cloud::Point& point : result.cloud.points) holes += cloud::is_finite(point) ? 0 : 1;
  // From above, every pixel of the bin's window shows the bin or a tube; a tube that leans out widens the
  // window.
  const scene::Camera camera(scene_.scanner);
  const double border = scene_.bin.wall_thickness;
  const Eigen::Vector2d corner =
      camera.project_from_world({scene_.bin.length / 2 + border, -scene_.bin.width / 2 - border, scene_.bin.height});
  const double bin_pixels = 4.0 * std::abs(corner.x() - 960.0) * std::abs(corner.y() - 600.0);
  EXPECT_NEAR(static_cast<double>(result.cloud.size() - holes), bin_pixels, 0.01 * bin_pixels);
}

INSTANTIATE_TEST_SUITE_P(All, PublishedScene,
                         ::testing::Values("A1_1", "A5_1", "A10_1", "A10_2", "A15_1", "A20_1", "B1_1", "B5_1", "B10_1",
                                           "B10_2", "B20_1", "C5_1", "C10_1"));

}  // namespace
}  // namespace tubebin::scan
