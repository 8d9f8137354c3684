#include "modeling/point_labels.hpp"

#include <gtest/gtest.h>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

TubeModel model_along(const std::vector<Vec3>& nodes) {
  TubeModel tube;
  tube.radius = kRadius;
  tube.paths.push_back({.nodes = nodes, .bridged = std::vector<bool>(nodes.size() - 1, false)});
  return tube;
}

/// Points of a scan that were not modelled must not change whose label is whose, wherever they lie about a tube.
TEST(PointLabels, FurtherPointsLeaveTheTubesAsTheyAre) {
  const std::vector<Vec3> first = {{-0.1, 0, 0}, {0.1, 0, 0}}, second = {{-0.1, 0.1, 0}, {0.1, 0.1, 0}};
  std::vector<TubeModel> tubes = {model_along(first), model_along(second)};
  std::vector<cloud::Point> points = upper_half_of(first).points;
  const std::size_t of_first = points.size();
  for (const cloud::Point& point : upper_half_of(second).points) points.push_back(point);
  const PointLabels modelled = label_points(points, tubes, {});
  ASSERT_EQ(tubes.size(), 2u);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(modelled.labels[i], i < of_first ? 1u : 2u);

  // About the first tube, but not on its surface: alone they would be chance.
  std::vector<cloud::Point> further = upper_half_of(first, 0.7 * kRadius).points;
  const std::size_t strays = further.size();
  for (const cloud::Point& point : upper_half_of(second).points) further.push_back(point);
  const std::vector<cloud::Label> labels = label_further_points(further, tubes, {});
  for (std::size_t i = strays; i < further.size(); ++i) ASSERT_EQ(labels[i], 2u);
}

/// Where exactly a tube ends is less well known than how it lies: points of its side beyond the end are the tube's, and
/// those of a floor that it lies on are not.
TEST(PointLabels, BeyondAnEndLiesTheTubeAndNotTheFloorBeneath) {
  const std::vector<Vec3> nodes = {{-0.1, 0, 0}, {0.1, 0, 0}};
  std::vector<TubeModel> tubes = {model_along(nodes)};
  std::vector<cloud::Point> points = upper_half_of(nodes).points;
  const std::size_t seen = points.size();
  const auto beyond = static_cast<float>(0.1 + 0.4 * kRadius), radius = static_cast<float>(kRadius);
  points.emplace_back(beyond, 0.0f, radius);
  for (const float side : {0.5f, 0.7f, 0.9f}) points.emplace_back(beyond, side * radius, -radius);
  const PointLabels labels = label_points(points, tubes, {});
  EXPECT_EQ(labels.labels[seen], 1u);
  for (std::size_t i = seen + 1; i < points.size(); ++i) EXPECT_EQ(labels.labels[i], 0u) << points[i].transpose();
}

TEST(PointLabels, OnRoughGroundLessAboutATubeIsItsOwn) {
  const std::vector<Vec3> nodes = {{-0.1, 0, 0}, {0.1, 0, 0}};
  std::vector<TubeModel> tubes = {model_along(nodes)};
  std::vector<cloud::Point> points = upper_half_of(nodes).points;
  points.push_back(Vec3(0.0, 1.3 * kRadius, 0.0).cast<float>());
  EXPECT_EQ(label_points(points, tubes, {}).labels.back(), 1u);
  Background rough;
  rough.is_rough = true;
  EXPECT_EQ(label_points(points, tubes, rough).labels.back(), 0u);
}

/// A tube touches a wall that the scanner sees from before it: what is seen where they touch is the wall. From behind it, as
/// through a wall of wire, it would be the tube.
TEST(PointLabels, WhereATubeTouchesAWallTheWallIsSeen) {
  const std::vector<TubeModel> tubes = {model_along({{-0.1, 0, 0}, {0.1, 0, 0}})};
  const auto wall = static_cast<float>(kRadius);
  std::vector<cloud::Point> points;
  for (float x = -0.08f; x <= 0.08f; x += 0.01f) points.emplace_back(x, wall, 0.0f);
  const auto labels_seen_from = [&](const Vec3& viewpoint) {
    const ViewProjection view(make_pose(Quat(0, 1, 0, 0), viewpoint), cloud::Point::Zero());
    return label_set_aside(points, tubes, 1e-4, view, {});
  };
  EXPECT_EQ(labels_seen_from({0.0, -0.2, 1.5}), std::vector<cloud::Label>(points.size(), 0));
  EXPECT_EQ(labels_seen_from({0.0, 0.2, 1.5}), std::vector<cloud::Label>(points.size(), 1));
}

}  // namespace
}  // namespace tubebin::modeling
