// Points in mid-air behind tubes' edges.
#include "modeling/mixed_pixels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tubebin::modeling {
namespace {

constexpr double kTubeRadius = 0.01, kApart = 0.001, kHeight = 1.0;  // metres; the scanner looks down from kHeight

/// Two tubes along x, of which the second is the higher one.
std::vector<TubeModel> two_tubes() {
  std::vector<TubeModel> tubes;
  for (const double z : {0.1, 0.2})
    tubes.push_back({.paths = {{.nodes = {{-0.1, z, z}, {0.0, z, z}, {0.1, z, z}}, .bridged = {false, false}}},
                     .radius = kTubeRadius});
  return tubes;
}

/// At height z, in the direction in which the edge of a tube is seen, and `aside` metres farther out there.
Vec3 behind_edge(double tube, double x, double z, double aside) {
  const Vec3 eye(0, 0, kHeight), axis(x, tube, tube);
  // The tangent from the eye to the tube's circle, on the side of greater y.
  const Eigen::Vector2d to_axis(axis.y() - eye.y(), axis.z() - eye.z());
  const double angle = std::asin((kTubeRadius + aside) / to_axis.norm());
  const Eigen::Vector2d along = Eigen::Rotation2Dd(angle) * to_axis.normalized();
  const double range = (z - kHeight) / along.y();
  const double edge = to_axis.norm() * std::cos(angle);
  return {x * range / edge, range * along.x(), z};
}

std::vector<cloud::Label> labels_of(const std::vector<Vec3>& points, std::vector<cloud::Label> labels) {
  FilteredCloud cloud;
  for (const Vec3& p : points) cloud.points.push_back(p.cast<float>());
  cloud.spacing = kApart;
  Pose world_from_sensor = Pose::Identity();
  world_from_sensor.linear() = Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix();
  world_from_sensor.translation() = Vec3(0, 0, kHeight);
  label_mixed_pixels(cloud, {world_from_sensor, cloud::Point::Zero()}, two_tubes(), labels);
  return labels;
}

TEST(MixedPixels, BelongToTheTubeWhoseEdgeTheyAreBehind) {
  const std::vector<Vec3> points = {behind_edge(0.1, 0.02, 0.05, 0.0), behind_edge(0.2, 0.03, 0.05, 0.5 * kApart),
                                    behind_edge(0.2, -0.05, 0.15, -0.5 * kApart)};
  EXPECT_EQ(labels_of(points, {0, 0, 0}), (std::vector<cloud::Label>{1, 2, 2}));
}

TEST(MixedPixels, AreNotBeforeTheEdgeNorBesideIt) {
  const std::vector<Vec3> points = {behind_edge(0.1, 0.02, 0.3, 0.0), behind_edge(0.1, 0.02, 0.05, 3.0 * kApart),
                                    behind_edge(0.1, 0.02, 0.05, -3.0 * kApart)};
  EXPECT_EQ(labels_of(points, {0, 0, 0}), (std::vector<cloud::Label>{0, 0, 0}));
}

TEST(MixedPixels, AreAloneAndHaveNoLabelYet) {
  std::vector<Vec3> points = {behind_edge(0.1, -0.05, 0.05, 0.0)};
  for (int k = 0; k < 100; ++k)  // a surface beneath the edge
    points.push_back(behind_edge(0.1, 0.02 + kApart * (k % 10), 0.05, kApart * (k / 10 - 5)));
  std::vector<cloud::Label> labels(points.size(), 0), expected = labels;
  labels.front() = expected.front() = 2;
  EXPECT_EQ(labels_of(points, labels), expected);
}

}  // namespace
}  // namespace tubebin::modeling
