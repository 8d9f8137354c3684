// Clouds of several scanners: each point is taken as the scanner saw it that measured it.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "modeling/built_scene.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

/// Three layers of tubes across the line from one scanner to the other: each scanner sees other sides of them.
scene::Scene pile_between_scanners() {
  scene::Scene scene = scene_of({});
  for (const double x : {-0.1, -0.04, 0.02, 0.08})
    scene.tubes.push_back(tube_along({{x, -0.15, kRadius}, {x, 0.15, kRadius}}));
  for (const double y : {-0.1, 0.0, 0.1})
    scene.tubes.push_back(tube_along({{-0.2, y, 3 * kRadius}, {0.2, y, 3 * kRadius}}));
  for (const double x : {-0.06, 0.05})
    scene.tubes.push_back(tube_along({{x, -0.15, 5 * kRadius}, {x, 0.15, 5 * kRadius}}));
  scene.scanner = looking_from({-1.4, 0.0, 1.0});
  scene.further_scanners = {looking_from({1.4, 0.0, 1.0})};
  return scene;
}

ModelingInput merged_input(const cloud::Cloud& cloud, const scene::Scene& scene) {
  ModelingInput input = input_of(cloud, scene.bin);
  input.world_from_further_sensors = {scene.further_scanners.front().world_from_scanner()};
  input.sources = cloud.sources;
  return input;
}

TEST(MergedViews, ShowMoreThanOneViewpointForAllPoints) {
  const scene::Scene scene = pile_between_scanners();
  const cloud::Cloud cloud = scan::scan_from_all(scene).cloud;
  const ModelingResult merged = model_tubes(merged_input(cloud, scene), {});
  const ModelingResult alone = model_tubes(input_of(cloud, scene.bin), {});
  EXPECT_EQ(merged.tubes.size(), scene.tubes.size());
  EXPECT_GE(micro_recall_of(merged, cloud), 0.99);
  EXPECT_GT(micro_recall_of(merged, cloud), micro_recall_of(alone, cloud));
  EXPECT_NE(alone.tubes.size(), scene.tubes.size());
  EXPECT_EQ(merged.found.further_viewpoints.size(), 1U);
  const ModelingResult grown = model_tubes(merged_input(cloud, scene), known_radius(ModelingMethod::region_growing));
  EXPECT_GE(micro_recall_of(grown, cloud), 0.85);
}

TEST(MergedViews, NormalsPointOutOfTheTubes) {
  const scene::Scene scene = pile_between_scanners();
  const cloud::Cloud cloud = scan::scan_from_all(scene).cloud;
  const ModelingInput input = merged_input(cloud, scene);
  const ViewProjection projection = view_of(input);
  FilteredCloud filtered = filter(input, projection, crop_bin(input, {}), {}, 1);
  add_normals(filtered, projection, kRadius);
  std::size_t outward = 0, all = 0;
  for (std::size_t i = 0; i < filtered.points.size(); ++i) {
    const cloud::Label label = cloud.labels[filtered.source[i]];
    const Vec3 p = filtered.points[i].cast<double>();
    if (label == 0 || filtered.normals[i].isZero()) continue;
    const scene::PlacedTube& tube = scene.tubes[label - 1];
    const Vec3 along = (tube.node_in_world(1) - tube.node_in_world(0)).normalized(), offset = p - tube.node_in_world(0);
    outward += (offset - offset.dot(along) * along).dot(filtered.normals[i].cast<double>()) > 0.0;
    ++all;
  }
  EXPECT_GT(all, 10000U);
  EXPECT_GT(outward, all * 99 / 100);
}

/// Two scanners above a floor, each with a lid of its own that hides part of it.
TEST(MergedViews, ArePlaceByPlaceWhatTheScannersSayTogether) {
  const Vec3 eyes[2] = {{-1.0, 0, 2}, {1.0, 0, 2}};
  std::vector<cloud::Point> points;
  std::vector<std::uint32_t> sources;
  std::vector<OcclusionTest> alone;
  std::vector<Pose> poses;
  for (std::uint32_t source = 0; source < 2; ++source) {
    std::vector<cloud::Point> seen;
    for (double x = -0.6; x <= 0.6; x += 0.004)
      for (double y = -0.6; y <= 0.6; y += 0.004) {
        seen.emplace_back(x, y, -0.3);
        if (std::abs(x) < 0.12 && std::abs(y - 0.05 * source) < 0.08) seen.emplace_back(x, y, 0.1);
      }
    poses.push_back(make_pose(Quat(0, 1, 0, 0), eyes[source]));
    ModelingInput one;
    one.points = seen;
    one.world_from_sensor = poses.back();
    FilteringOptions options;
    std::vector<std::uint32_t> all(seen.size());
    std::iota(all.begin(), all.end(), 0U);
    alone.emplace_back(one, view_of(one), filter(one, view_of(one), all, options, 1).spacing, kRadius);
    points.insert(points.end(), seen.begin(), seen.end());
    sources.insert(sources.end(), seen.size(), source);
  }
  ModelingInput both;
  both.points = points;
  both.world_from_sensor = poses[0];
  both.world_from_further_sensors = {poses[1]};
  both.sources = sources;
  const OcclusionTest together(both, view_of(both), 0.0, kRadius);

  int hidden_from_one = 0, hidden_from_both = 0, seen_by_both = 0;
  for (double x = -0.3; x <= 0.3; x += 0.02)
    for (double y = -0.3; y <= 0.3; y += 0.02) {
      // Along y, whose places across look alike to both; only those that a scanner alone has no doubt about.
      const StretchEvidence a = alone[0].around({x, y, 0}, Vec3::UnitY()),
                            b = alone[1].around({x, y, 0}, Vec3::UnitY());
      if (std::max(a.hidden, a.empty) < 1.0 || std::max(b.hidden, b.empty) < 1.0) continue;
      const StretchEvidence sum = together.around({x, y, 0}, Vec3::UnitY());
      EXPECT_EQ(sum.empty, std::max(a.empty, b.empty)) << x << " " << y;
      EXPECT_EQ(sum.hidden, std::min(a.hidden, b.hidden)) << x << " " << y;
      ++(a.hidden + b.hidden == 2.0 ? hidden_from_both : a.hidden + b.hidden == 1.0 ? hidden_from_one : seen_by_both);
    }
  EXPECT_GT(hidden_from_one, 10);
  EXPECT_GT(hidden_from_both, 10);
  EXPECT_GT(seen_by_both, 100);
}

}  // namespace
}  // namespace tubebin::modeling
