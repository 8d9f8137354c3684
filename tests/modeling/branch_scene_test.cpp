// Tubes that branch: taken apart into stretches, and put together again.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "modeling/built_scene.hpp"
#include "modeling/built_surface.hpp"
#include "modeling/fitting/branch_splitting.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/joining/branch_links.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::modeling {
namespace {

/// A trunk of 0.36 m that lies along x at `y`, with two branches of 0.12 m in the plane of the floor.
scene::PlacedTube two_branches(double y) {
  scene::PlacedTube tube =
      tube_along({{-0.18, y, kRadius}, {-0.06, y, kRadius}, {0.06, y, kRadius}, {0.18, y, kRadius}});
  for (const double x : {-0.06, 0.06}) {
    tube.tube.nodes.push_back({x + 0.06, y + 0.10, kRadius});
    tube.tube.cylinders.push_back({x < 0.0 ? 1 : 2, static_cast<int>(tube.tube.nodes.size()) - 1, 0});
  }
  return tube;
}

TEST(Branches, OneTubeIsFoundForEachTree) {
  const scene::Scene scene = scene_of({two_branches(-0.12), two_branches(0.04)});
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), known_radius());
  ASSERT_EQ(result.tubes.size(), 2u);
  EXPECT_GE(micro_recall_of(result, cloud), 0.995);
  for (const TubeModel& tube : result.tubes) {
    EXPECT_EQ(tube.paths.size(), 3u);
    EXPECT_NEAR(tube.length(), scene.tubes[0].tube.length(), 0.02);
  }
  ASSERT_EQ(result.lengths.size(), 1u);
  EXPECT_NEAR(result.lengths.front(), scene.tubes[0].tube.length(), 0.02);
}

TEST(Branches, LengthsThatPlainTubesShareAreTold) {
  std::vector<scene::PlacedTube> tubes;
  for (const double y : {-0.14, -0.10, -0.06, -0.02, 0.02, 0.06, 0.10, 0.14})
    tubes.push_back(tube_along({{-0.1, y, kRadius}, {y < 0.0 ? 0.05 : 0.15, y, kRadius}}));
  const scene::Scene scene = scene_of(tubes);
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), known_radius());
  ASSERT_EQ(result.lengths.size(), 2u);
  EXPECT_NEAR(result.lengths.front(), 0.15, kRadius / 2.0);
  EXPECT_NEAR(result.lengths.back(), 0.25, kRadius / 2.0);
  EXPECT_THAT(describe_found(result),
              ::testing::HasSubstr(fmt::format("length {:.3f}, {:.3f} m;", result.lengths[0], result.lengths[1])));
}

TEST(Branches, OneForkAmongPlainTubesIsOneTube) {
  std::vector<scene::PlacedTube> tubes = {
      tube_along({{-0.18, 0.03, kRadius}, {0.0, 0.03, kRadius}, {0.18, 0.03, kRadius}})};
  tubes.front().tube.nodes.push_back({0.06, 0.13, kRadius});
  tubes.front().tube.cylinders.push_back({1, 3, 0});
  for (const double y : {-0.16, -0.12, -0.08, -0.04})
    tubes.push_back(tube_along({{-0.15, y, kRadius}, {0.15, y, kRadius}}));
  const scene::Scene scene = scene_of(tubes);
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), known_radius());
  ASSERT_EQ(result.tubes.size(), tubes.size());
  EXPECT_EQ(std::ranges::count_if(result.tubes, [](const TubeModel& tube) { return tube.paths.size() == 2; }), 1);
  EXPECT_GE(micro_recall_of(result, cloud), 0.995);
}

TEST(Branches, ATrunkThatAnotherTubeHidesStillJoinsItsBranches) {
  const scene::Scene scene = scene_of({two_branches(0.0), two_branches(-0.15),
                                       tube_along({{-0.08, -0.02, 0.05}, {-0.04, 0.03, 0.05}, {0.12, 0.03, 0.05}})});
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), known_radius());
  EXPECT_EQ(result.tubes.size(), 3u);
  EXPECT_GE(micro_recall_of(result, cloud), 0.99);
}

TEST(Branches, SegmentsOfTreesAreTakenApartAndThoseOfChainsAreNot) {
  for (const bool is_tree : {true, false}) {
    const scene::Scene scene = scene_of(
        {is_tree ? two_branches(0.0) : tube_along({{-0.1, 0, kRadius}, {0, 0, kRadius}, {0.1, 0.05, kRadius}})});
    const cloud::Cloud cloud = scan::scan(scene).cloud;
    const ModelingInput input = input_of(cloud, scene.bin);
    FilteredCloud filtered = filter(input, view_of(input), crop_bin(input, {}), {}, 1);
    add_normals(filtered, view_of(input), kRadius);
    const std::vector<Segment> segments = segment_by_votes(filtered, kRadius);
    ASSERT_EQ(segments.size(), 1u);
    const std::vector<Stretch> stretches = split_branches(filtered, segments[0], kRadius);
    EXPECT_EQ(stretches.size(), is_tree ? 3u : 1u);
    std::size_t points = 0;
    for (const Stretch& stretch : stretches) points += stretch.segment.size();
    EXPECT_EQ(points, segments[0].size());
    const Split split = split_off_longest({segments[0], VoteGraph(filtered, segments[0], kRadius)}, kRadius);
    EXPECT_EQ(split.longest.segment, stretches[0].segment);
    EXPECT_EQ(split.others.empty(), !is_tree);
  }
}

/// A hose of 2.8 m, laid to and fro: 560 radii.
TEST(Branches, AWayOfHundredsOfRadiiIsCutAndMadeWholeAgain) {
  constexpr double kThin = 0.005;
  std::vector<Vec3> nodes;
  for (int row = 0; row < 6; ++row) {
    const double y = 0.05 * row, side = row % 2 == 0 ? 1.0 : -1.0;
    for (const Vec3& node : {Vec3(-0.2 * side, y, kThin), Vec3(0.2 * side, y, kThin),
                             Vec3(0.2125 * side, y + 0.0125, kThin), Vec3(0.2125 * side, y + 0.0375, kThin)})
      nodes.push_back(node);
  }
  FilteredCloud hose = upper_half_of(nodes, kThin);
  std::size_t stretches = 0;
  for (const Segment& segment : segment_by_votes(hose, kThin))
    for (const Stretch& stretch : split_branches(hose, segment, kThin)) {
      EXPECT_LT(std::ranges::max(stretch.graph.distances_from_end()), 310.0 * kThin);
      ++stretches;
    }
  EXPECT_GE(stretches, 2u);
  ModelingOptions options;
  options.radius = kThin;
  const ModelingInput input{
      .points = hose.points, .world_from_sensor = make_pose(Quat(0, 1, 0, 0), {0, 0, 1}), .bin = std::nullopt};
  const ModelingResult result = model_tubes(input, options);
  ASSERT_EQ(result.tubes.size(), 1u);
  EXPECT_NEAR(result.tubes[0].length(), polyline_length(nodes), 0.02);
}

TEST(Branches, TubesThatHangTogetherByTheirEndsAreTakenApart) {
  const double apart = 2.02 * kRadius;
  const scene::Scene scene = scene_of(
      {tube_along({{-0.10, 0.0, 0.02}, {-0.05, 0.0, 0.15}}), tube_along({{-0.10, apart, 0.02}, {-0.05, apart, 0.15}})});
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingInput input = input_of(cloud, scene.bin);
  FilteredCloud filtered = filter(input, view_of(input), crop_bin(input, {}), {}, 1);
  add_normals(filtered, view_of(input), kRadius);
  std::vector<Segment> segments = segment_by_votes(filtered, kRadius);
  ASSERT_EQ(segments.size(), 1u);  // the votes of the flat ends lie between the centrelines
  EXPECT_EQ(split_branches(filtered, segments[0], kRadius).size(), 2u);
  const ModelingResult result = model_tubes(input, known_radius());
  EXPECT_EQ(result.tubes.size(), 2u);
  EXPECT_GE(micro_recall_of(result, cloud), 0.995);
}

TEST(Branches, StartOnASideButNotAtAnEnd) {
  const std::vector<Vec3> nodes = {{0, 0, 0}, {0.2, 0, 0}};
  EXPECT_TRUE(place_on_side({0.1, 0.6 * kRadius, 0}, {0, -1, 0}, nodes, kRadius));
  EXPECT_FALSE(place_on_side({0.1, 1.1 * kRadius, 0}, {0, -1, 0}, nodes, kRadius));  // another tube's end may touch it
  EXPECT_FALSE(place_on_side({0.1, 0.8 * kRadius, 0}, {0, 1, 0}, nodes, kRadius));   // leads away
  EXPECT_FALSE(place_on_side({0.195, 0.4 * kRadius, 0}, {0, -1, 0}, nodes, kRadius));
}

TEST(Branches, AreFoundUnderATubeThatHidesWhereTheyStart) {
  const scene::Scene scene = scene_of({two_branches(-0.17), two_branches(-0.04), two_branches(0.08),
                                       tube_along({{-0.20, -0.02, 0.05}, {0.20, -0.02, 0.05}})});
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), known_radius());
  EXPECT_EQ(result.tubes.size(), 4u);
  EXPECT_GE(micro_recall_of(result, cloud), 0.99);
}

class PublishedSetC : public ::testing::TestWithParam<int> {};

TEST_P(PublishedSetC, HasATubeForEachTree) {
  const std::string path = PUBLISHED_SCENES_DIR "/C" + std::to_string(GetParam()) + "_1.txt";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs the published scenes in " PUBLISHED_SCENES_DIR;
  scene::Scene scene = scene_of(scene::read_tubes_txt(path));
  scene.bin = {.length = 0.80, .width = 0.60, .height = 0.20, .wall_thickness = 0.02};
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult result = model_tubes(input_of(cloud, scene.bin), known_radius());
  EXPECT_LE(static_cast<int>(result.tubes.size()), GetParam() + GetParam() / 5);
  EXPECT_GE(micro_recall_of(result, cloud), 0.95);
}

INSTANTIATE_TEST_SUITE_P(Trees, PublishedSetC, ::testing::Values(5, 10));

}  // namespace
}  // namespace tubebin::modeling
