#include "tubebin/render/preview.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <set>

#include "scan/random_scene.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::render {
namespace {

class Preview : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!can_render()) GTEST_SKIP() << "this build has no OSMesa";
  }
};

/// The drawn labels and the scanned ones: at least 99.5 % of the pixels are the same, and where they are not,
/// one of the eight pixels around has another scanned label.
void expect_labels_agree(const scene::Scene& scene) {
  const scan::Scan scanned = scan::scan(scene);
  const Image drawn = render_labels(scene, scanned.window);
  ASSERT_EQ(drawn.width, scanned.window.width);
  ASSERT_EQ(drawn.height, scanned.window.height);
  const auto color_at = [&](int column, int row) {
    return scanned.cloud.colors[static_cast<std::size_t>(row) * scanned.cloud.width + static_cast<std::size_t>(column)];
  };
  const auto at_silhouette = [&](int column, int row) {
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, drawn.height - 1); ++y)
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, drawn.width - 1); ++x)
        if (color_at(x, y) != color_at(column, row)) return true;
    return false;
  };
  std::size_t different = 0, elsewhere = 0;
  for (int row = 0; row < drawn.height; ++row) {
    for (int column = 0; column < drawn.width; ++column) {
      if (drawn.pixel(column, row) == color_at(column, row)) continue;
      ++different;
      // The window's border is a silhouette of the bin too: outside there is nothing.
      const bool at_border = row == 0 || column == 0 || row == drawn.height - 1 || column == drawn.width - 1;
      if (!at_border && !at_silhouette(column, row)) ++elsewhere;
    }
  }
  EXPECT_LE(static_cast<double>(different), 0.005 * static_cast<double>(scanned.cloud.size()));
  EXPECT_EQ(elsewhere, 0u);
  ::testing::Test::RecordProperty("different_pixels", static_cast<int>(different));
}

TEST_F(Preview, LabelsAgreeWithTheScan) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_labels_agree(testing::random_scene(10, seed));
}

TEST_F(Preview, LabelsAgreeInABinWithLeaningWallsAndARim) {
  scene::Scene scene = testing::random_scene(10, 4);
  scene.bin.draft_deg = 5.0;
  scene.bin.rim_width = 0.02;
  scene.bin.corner_radius = 0.04;
  expect_labels_agree(scene);
}

TEST_F(Preview, LabelsAgreeThroughOpenEnds) {
  scene::Scene scene = testing::random_scene(10, 8);
  for (scene::PlacedTube& placed : scene.tubes) placed.tube.wall_thickness = 0.001;
  // A pipe that stands up: the floor is seen through it.
  tube::Tube pipe{
      .radius = 0.03, .wall_thickness = 0.003, .mass = 1.0, .nodes = {{0, 0, 0}, {0, 0, 0.1}}, .cylinders = {}};
  pipe.cylinders = {{0, 1, 0}};
  scene.tubes.push_back({pipe, make_pose(Quat::Identity(), Vec3(0, 0, 0.15))});
  expect_labels_agree(scene);
}

TEST_F(Preview, LabelsAgreeWithAFloorAtTheRangesEnd) {
  scene::Scene scene = testing::random_scene(10, 4);
  scene.scanner.range_max = 2.0;
  expect_labels_agree(scene);
}

TEST_F(Preview, LabelsAgreeWhenTiltedAndOddlySized) {
  scene::Scene scene = testing::random_scene(10, 5);
  scene.scanner.width = 1001;
  scene.scanner.height = 777;
  scene.scanner.position = {0.8, -0.3, 1.0};
  scene.scanner.rotation_deg = {15.0, 38.0, 0.0};
  expect_labels_agree(scene);
}

TEST_F(Preview, LabelsAgreeInTheFullImage) {
  scene::Scene scene = testing::random_scene(10, 6);
  scene.scanner.region = scene::ScanRegion::full;
  expect_labels_agree(scene);
}

TEST_F(Preview, LitPictureShowsEveryTubesHue) {
  // Two tubes apart from each other, in red and blue say: each hue, shaded, covers part of the picture.
  scene::Scene scene = testing::random_scene(2, 7);
  const Image picture = render_preview(scene, 320, 240);
  ASSERT_EQ(picture.rgb.size(), 3u * 320u * 240u);
  const std::vector<cloud::Color> colors = cloud::label_colors(2);
  for (std::size_t k = 1; k <= 2; ++k) {
    const Vec3 wanted = Vec3(colors[k] >> 16 & 0xFF, colors[k] >> 8 & 0xFF, colors[k] & 0xFF).normalized();
    int pixels = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
      const Vec3 color(picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]);
      if (color.norm() > 40.0 && color.normalized().dot(wanted) > 0.97) ++pixels;
    }
    EXPECT_GT(pixels, 200) << "tube " << k;
  }
}

TEST_F(Preview, LitPictureIsAntialiasedAndShaded) {
  const Image picture = render_preview(testing::random_scene(5, 8), 320, 240);
  std::set<cloud::Color> colors;
  for (int row = 0; row < picture.height; ++row)
    for (int column = 0; column < picture.width; ++column) colors.insert(picture.pixel(column, row));
  EXPECT_GT(colors.size(), 500u);
}

TEST_F(Preview, SameSceneSamePicture) {
  const scene::Scene scene = testing::random_scene(5, 9);
  EXPECT_EQ(render_preview(scene, 200, 150).rgb, render_preview(scene, 200, 150).rgb);
}

TEST_F(Preview, SceneWithoutTubesAndEmptyWindow) {
  const scene::Scene scene;
  EXPECT_EQ(render_preview(scene, 64, 48).width, 64);
  EXPECT_EQ(render_labels(scene, scene::PixelWindow{}).rgb.size(), 0u);
}

TEST(PreviewWithoutOSMesa, IsRefusedWithTheRemedy) {
  if (can_render()) GTEST_SKIP() << "this build has OSMesa";
  try {
    render_preview(scene::Scene(), 64, 48);
    FAIL() << "drawn without OSMesa";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(std::string(error.what()), ::testing::HasSubstr("libosmesa6-dev"));
  }
}

TEST(Png, ReadsBackTheSame) {
  Image image{3, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 1, 2, 3, 4, 5, 6, 7, 8, 9}};
  const std::string bytes = encode_png(image);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()));
  EXPECT_EQ(header.width, 3u);
  EXPECT_EQ(header.height, 2u);
  header.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(header));
  ASSERT_TRUE(png_image_finish_read(&header, nullptr, rgb.data(), 0, nullptr));
  EXPECT_EQ(rgb, image.rgb);
}

}  // namespace
}  // namespace tubebin::render
