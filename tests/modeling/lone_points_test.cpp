#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "modeling/built_scene.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

std::vector<cloud::Point> points_in_box(const Eigen::AlignedBox3d& box, int count) {
  Random random(7);
  std::vector<cloud::Point> points;
  for (int k = 0; k < count; ++k) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(box.min()[axis], box.max()[axis]);
    points.push_back(p.cast<float>());
  }
  return points;
}

constexpr int kInTheAir = 900;

/// Of a sheet of 1600 points a millimetre apart, and of others beside it, each alone.
FilteredCloud filtered_sheet(const FilteringOptions& options) {
  std::vector<cloud::Point> points = points_in_box({Vec3(0.05, 0.0, -0.1), Vec3(0.09, 0.04, 0.0)}, kInTheAir);
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 40; ++column)
      points.emplace_back(0.001f * static_cast<float>(column), 0.001f * static_cast<float>(row), 0.0f);
  const ModelingInput input{
      .points = points, .world_from_sensor = make_pose(Quat(0, 1, 0, 0), {0, 0, 1}), .bin = std::nullopt};
  std::vector<std::uint32_t> indices(points.size());
  std::iota(indices.begin(), indices.end(), 0U);
  return filter(input, view_of(input), indices, options, 1);
}

TEST(LonePoints, AreLeftOutWhereTheOptionAsksForIt) {
  EXPECT_TRUE(filtered_sheet({}).alone.empty());
  const FilteredCloud cloud = filtered_sheet({.remove_outliers = true});
  const auto in_the_air = std::ranges::count_if(cloud.alone, [](std::uint32_t i) { return i < kInTheAir; });
  EXPECT_GE(in_the_air, kInTheAir - 10);
  EXPECT_LE(std::ssize(cloud.alone) - in_the_air, 4);  // the sheet's corners
  std::vector<std::uint32_t> all = cloud.source;
  all.insert(all.end(), cloud.alone.begin(), cloud.alone.end());
  std::ranges::sort(all);
  ASSERT_EQ(all.size(), kInTheAir + 1600u);
  EXPECT_EQ(all.back(), kInTheAir + 1599u);
  EXPECT_EQ(std::ranges::adjacent_find(all), all.end());
}

/// Adds two points to each at a silhouette, below the tube on the way to the floor.
void smear_edges(cloud::Cloud& cloud, const std::vector<double>& tubes_y) {
  Random random(5);
  const Vec3 eye = cloud.world_from_sensor.translation();
  for (std::size_t i = 0, count = cloud.points.size(); i < count; ++i) {
    const Vec3 p = cloud.points[i].cast<double>();
    const auto is_edge = [&](double y) { return std::abs(std::abs(p.y() - y) - 0.9 * kRadius) < 0.1 * kRadius; };
    if (cloud.labels[i] == 0 || std::ranges::none_of(tubes_y, is_edge)) continue;
    for (int k = 0; k < 2; ++k) {
      cloud.points.push_back((p + (p - eye).normalized() * random.uniform(0.03, 0.08)).cast<float>());
      cloud.labels.push_back(0);
    }
  }
}

TEST(LonePoints, AreNotLostToTheResult) {
  constexpr double kY = 0.05, kZ = 0.1;
  const scene::Scene scene = scene_of({tube_along({{-0.2, -kY, kZ}, {0.0, -kY, kZ}, {0.2, -kY - 0.02, kZ}}),
                                       tube_along({{-0.2, kY, kZ}, {0.2, kY, kZ}})});
  cloud::Cloud cloud = scan::scan(scene).cloud;
  const auto is_tubes = [](cloud::Label label) { return label > 0; };
  const std::size_t of_tubes = static_cast<std::size_t>(std::ranges::count_if(cloud.labels, is_tubes));
  const std::size_t scanned = cloud.points.size();
  smear_edges(cloud, {-kY, kY});
  const std::size_t in_the_air = cloud.points.size() - scanned;
  EXPECT_GT(in_the_air, of_tubes / 5);
  ModelingOptions options;
  options.filtering.remove_outliers = true;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), options);
  ASSERT_EQ(result.tubes.size(), 2u);
  EXPECT_EQ(result.source.size(), of_tubes + in_the_air);
  EXPECT_NEAR(result.radius, kRadius, 1e-4);
  const auto all = static_cast<double>(result.source.size());
  EXPECT_GT(micro_recall_of(result, cloud) * all, 0.995 * static_cast<double>(of_tubes));
  std::size_t labeled = 0;
  for (std::size_t k = 0; k < result.source.size(); ++k) labeled += result.source[k] >= scanned && result.labels[k] > 0;
  EXPECT_LT(labeled, in_the_air / 50);
}

}  // namespace
}  // namespace tubebin::modeling
