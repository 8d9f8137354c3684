#include "modeling/input/viewpoint_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "modeling/built_scene.hpp"

namespace tubebin::modeling {
namespace {

using ::testing::HasSubstr;

scene::Scene crossing_tubes() {
  return scene_of({tube_along({{-0.2, 0.03, kRadius}, {0.1, 0.03, kRadius}, {0.2, -0.05, kRadius}}),
                   tube_along({{0.02, -0.15, 3 * kRadius}, {-0.02, 0.15, 3 * kRadius}})});
}

TEST(ViewpointCheck, TakesWhatTheGridShows) {
  const cloud::Cloud cloud = scan::scan(crossing_tubes()).cloud;
  ASSERT_TRUE(cloud.organized());
  ModelingInput input{
      .points = cloud.points, .world_from_sensor = cloud.world_from_sensor, .bin = {}, .width = cloud.width};
  const ModelingResult told = model_tubes(input, {});
  EXPECT_TRUE(told.found.doubts.empty());
  input.world_from_sensor.translation() = Vec3::Zero();  // a file in the bin's frame that says nothing
  const ModelingResult found = model_tubes(input, {});
  ASSERT_EQ(found.found.doubts.size(), 1u);
  EXPECT_THAT(found.found.doubts.front(), HasSubstr("not seen from (0.000, 0.000, 0.000)"));
  EXPECT_LT((found.found.viewpoint - cloud.world_from_sensor.translation()).norm(), 0.01);
  EXPECT_TRUE(told.found.viewpoint_is_told);
  EXPECT_FALSE(found.found.viewpoint_is_told);
  EXPECT_EQ(found.tubes.size(), told.tubes.size());
  EXPECT_NEAR(micro_recall_of(found, cloud), micro_recall_of(told, cloud), 0.001);
}

/// In a frame whose origin lies at `base` of the bin's, and no word of where the scanner stood.
ModelingResult model_without_viewpoint(const cloud::Cloud& cloud, const Vec3& base) {
  std::vector<cloud::Point> points = cloud.points;
  for (cloud::Point& point : points) point -= base.cast<float>();
  return model_tubes({.points = points, .bin = {}}, {});
}

/// Whether as many tubes were found as there are, and nearly all points of each have one label of its own.
void expect_all_found(const ModelingResult& found, const cloud::Cloud& cloud, std::size_t tubes) {
  EXPECT_EQ(found.tubes.size(), tubes);
  std::vector<std::map<cloud::Label, double>> labels(tubes + 1);
  for (std::size_t k = 0; k < found.source.size(); ++k) ++labels.at(cloud.labels[found.source[k]])[found.labels[k]];
  std::set<cloud::Label> used;
  for (std::size_t tube = 1; tube <= tubes; ++tube) {
    const auto& [label, most] =
        *std::ranges::max_element(labels[tube], {}, [](const auto& entry) { return entry.second; });
    double all = 0.0;
    for (const auto& [other, count] : labels[tube]) all += count;
    EXPECT_GT(most, 0.98 * all);
    EXPECT_NE(label, 0);
    EXPECT_TRUE(used.insert(label).second);
  }
}

TEST(ViewpointCheck, FindsTheOpenSideOfACloudInAnyOrder) {
  const cloud::Cloud cloud = scan::scan(crossing_tubes()).cloud;
  const std::pair<Vec3, const char*> cases[] = {
      {{0.0, 0.0, 0.02}, "lie all around"},          // among the tubes
      {{-0.7, 0.1, 0.0}, "lie far behind others"},   // beside the bin, at the height of its floor
      {{0.0, 0.05, -4.0}, "lie far behind others"},  // below it
  };
  for (const auto& [base, why] : cases) {
    const ModelingResult found = model_without_viewpoint(cloud, base);
    ASSERT_FALSE(found.found.doubts.empty());
    EXPECT_THAT(found.found.doubts.front(), HasSubstr("not seen from (0.000, 0.000, 0.000)"));
    EXPECT_THAT(found.found.doubts.front(), HasSubstr(why));
    EXPECT_FALSE(found.found.viewpoint_is_told);
    EXPECT_GT(found.found.up.z(), 0.99);
    expect_all_found(found, cloud, 2);
  }
}

TEST(ViewpointCheck, LooksFromTheOtherSideOfATable) {
  const cloud::Cloud cloud = scan::scan(crossing_tubes()).cloud;
  std::vector<cloud::Point> points;  // not the walls, which the floor hides from below
  for (const cloud::Point& point : cloud.points)
    if (point.z() < 0.06 && std::abs(point.x()) < 0.25 && std::abs(point.y()) < 0.17) points.push_back(point);
  ModelingInput input{.points = points, .world_from_sensor = make_pose(Quat::Identity(), {0.05, 0.0, -1.2}), .bin = {}};
  const ModelingResult found = model_tubes(input, {});
  ASSERT_FALSE(found.found.doubts.empty());
  EXPECT_THAT(found.found.doubts.front(), HasSubstr("look hollow"));
  EXPECT_GT(found.found.viewpoint.z(), 0.0);
  EXPECT_EQ(found.tubes.size(), 2u);
}

TEST(ViewpointCheck, LeavesAPossibleOneAlone) {
  const cloud::Cloud cloud = scan::scan(crossing_tubes()).cloud;
  ModelingInput input{.points = cloud.points, .world_from_sensor = cloud.world_from_sensor, .bin = {}};
  const ViewpointCheck check = check_viewpoint(input);
  EXPECT_EQ(check.doubt, "");
  EXPECT_EQ(input.world_from_sensor.translation(), cloud.world_from_sensor.translation());
  const ModelingResult told = model_tubes(input, {});
  EXPECT_TRUE(told.found.viewpoint_is_told);
  EXPECT_EQ(told.found.viewpoint, cloud.world_from_sensor.translation());
  expect_all_found(told, cloud, 2);
  // In the scanner's own frame a file that says nothing is right.
  const ModelingResult found = model_without_viewpoint(cloud, cloud.world_from_sensor.translation());
  EXPECT_TRUE(found.found.viewpoint.isZero());
  expect_all_found(found, cloud, 2);
}

TEST(ViewpointCheck, TakesScansFromSeveralPlacesAsOneCloud) {
  scene::Scene scene = crossing_tubes();
  for (const Vec3& position : {Vec3(-1.2, 0.0, 1.0), Vec3(1.2, 0.3, 1.0), Vec3(0.0, -1.2, 1.0)})
    scene.further_scanners.push_back(looking_from(position));
  const cloud::Cloud cloud = scan::scan_from_all(scene).cloud;
  const ModelingResult found = model_without_viewpoint(cloud, Vec3::Zero());
  ASSERT_FALSE(found.found.doubts.empty());
  EXPECT_THAT(found.found.doubts.front(), HasSubstr("not seen from (0.000, 0.000, 0.000)"));
  expect_all_found(found, cloud, 2);
}

}  // namespace
}  // namespace tubebin::modeling
