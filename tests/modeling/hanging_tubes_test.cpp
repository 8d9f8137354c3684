#include "modeling/input/hanging_tubes.hpp"

#include <gtest/gtest.h>

#include "modeling/built_scene.hpp"

namespace tubebin::modeling {
namespace {

TEST(HangingTubes, AreWhatHangsTogetherWithWhatIsOverTheWalls) {
  constexpr double kSpacing = 0.001;
  std::vector<cloud::Point> points;
  std::vector<std::uint32_t> walls, beside;
  const auto add_line = [&](float from, float to, float y) {
    for (float x = from; x < to; x += 0.001f) {
      (x < 0.2f ? walls : beside).push_back(static_cast<std::uint32_t>(points.size()));
      points.emplace_back(x, y, 0.25f);
    }
  };
  add_line(0.1f, 0.3f, 0.0f);  // over the wall
  const std::size_t hanging = beside.size();
  add_line(0.25f, 0.3f, 0.05f);  // beside it
  EXPECT_EQ(hanging_over(points, walls, beside, kSpacing),
            std::vector<std::uint32_t>(beside.begin(), beside.begin() + static_cast<std::ptrdiff_t>(hanging)));
  EXPECT_TRUE(hanging_over(points, {}, beside, kSpacing).empty());
}

/// It leans over the wall, and its end is far below the rim.
TEST(HangingTubes, AreFoundWholeWithAKnownBin) {
  const scene::Bin bin;
  const double wall = bin.length / 2.0 + bin.wall_thickness;
  const scene::Scene scene =
      scene_of({tube_along({{0.0, 0.0, 0.1}, {wall - 0.05, 0.0, 0.25}, {wall + 0.15, 0.0, 0.05}}),
                tube_along({{-0.2, -0.1, kRadius}, {0.2, -0.1, kRadius}})});
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  ModelingOptions options = known_radius();
  options.label_all = true;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), options);
  ASSERT_EQ(result.tubes.size(), 2u);
  std::size_t missed = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) missed += cloud.labels[i] == 1 && result.all_labels[i] == 0;
  EXPECT_EQ(missed, 0u);
  EXPECT_EQ(micro_recall_of(result, cloud), 1.0);
}

}  // namespace
}  // namespace tubebin::modeling
