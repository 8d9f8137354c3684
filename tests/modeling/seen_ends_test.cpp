// Ends of tubes beyond what cylinders were fitted to.
#include "modeling/seen_ends.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tubebin::modeling {
namespace {

constexpr double kEndRadius = 0.01, kEndSpacing = 0.001;  // metres

/// A tube along x that was followed to x = 0, and what it reaches when these points have no label, metres.
double reached(const std::vector<cloud::Point>& unlabeled, bool is_reversed = false,
               const std::vector<double>& lengths = {}) {
  std::vector<Vec3> nodes = {{-0.1, 0, 0}, {-0.002, 0, 0}, {0, 0, 0}};
  if (is_reversed) std::ranges::reverse(nodes);
  std::vector<TubeModel> tubes = {{.paths = {{.nodes = nodes, .bridged = {false, false}}}, .radius = kEndRadius}};
  const std::vector<cloud::Label> labels(unlabeled.size(), 0);
  const bool any = reach_seen_ends(tubes, unlabeled, labels, kEndSpacing, lengths);
  const std::vector<Vec3>& after = tubes[0].paths[0].nodes;
  EXPECT_EQ(any, after != nodes);
  EXPECT_EQ(is_reversed ? after.back() : after.front(), Vec3(-0.1, 0, 0));
  return is_reversed ? after.front().x() : after.back().x();
}

/// The half of a ball about `center` that faces along x.
std::vector<cloud::Point> rounded_end(double center) {
  std::vector<cloud::Point> points;
  for (double y = -kEndRadius; y <= kEndRadius; y += kEndSpacing)
    for (double z = -kEndRadius; z <= kEndRadius; z += kEndSpacing)
      if (const double squared = kEndRadius * kEndRadius - y * y - z * z; squared >= 0.0)
        points.push_back(Vec3(center + std::sqrt(squared), y, z).cast<float>());
  return points;
}

TEST(SeenEnds, ARoundedEndIsReached) {
  for (const bool is_reversed : {false, true}) {
    EXPECT_NEAR(reached(rounded_end(0.3 * kEndRadius), is_reversed), 1.3 * kEndRadius, 1e-6);
    EXPECT_NEAR(reached(rounded_end(kEndRadius), is_reversed), 2.0 * kEndRadius, 1e-6);
  }
}

TEST(SeenEnds, WhatIsNarrowerOrGoesOnIsNoEnd) {
  std::vector<cloud::Point> wire, other_tube;
  for (double x = 0.0; x < 0.1; x += kEndSpacing) {
    if (x < 2.0 * kEndRadius) wire.push_back(Vec3(x, 0.0, 0.002).cast<float>());
    for (double angle = 0.0; angle < std::numbers::pi; angle += kEndSpacing / kEndRadius)
      other_tube.push_back(Vec3(x, kEndRadius * std::cos(angle), kEndRadius * std::sin(angle)).cast<float>());
  }
  EXPECT_EQ(reached(wire), 0.0);
  EXPECT_EQ(reached(other_tube), 0.0);
  EXPECT_EQ(reached(rounded_end(-2.0 * kEndRadius)), 0.0) << "not beyond the end";
  EXPECT_EQ(reached(rounded_end(2.0 * kEndRadius)), 0.0) << "apart from it";
  EXPECT_EQ(reached({}), 0.0);
}

/// The upper half of a tube's side along x.
std::vector<cloud::Point> side(double from, double to) {
  std::vector<cloud::Point> points;
  for (double x = from; x < to; x += kEndSpacing)
    for (double angle = 0.0; angle < std::numbers::pi; angle += kEndSpacing / kEndRadius)
      points.push_back(Vec3(x, kEndRadius * std::cos(angle), kEndRadius * std::sin(angle)).cast<float>());
  return points;
}

TEST(SeenEnds, ASideThatShowsAgainIsReachedWhereALengthGoesOn) {
  for (const bool is_reversed : {false, true})
    EXPECT_NEAR(reached(side(0.03, 0.05), is_reversed, {0.15}), 0.05, kEndSpacing + 1e-6);
  EXPECT_EQ(reached(side(0.03, 0.05)), 0.0) << "no length in common";
  EXPECT_EQ(reached(side(0.03, 0.05), false, {0.105}), 0.0) << "as long as it is";
  EXPECT_EQ(reached(side(0.08, 0.10), false, {0.15}), 0.0) << "beyond the length";
  EXPECT_EQ(reached(side(0.03, 0.032), false, {0.15}), 0.0) << "too few";
  std::vector<cloud::Point> with_others = side(0.03, 0.05);
  for (double x = 0.0; x < 0.06; x += kEndSpacing / 4.0)
    for (double y = 0.0; y < 0.004; y += kEndSpacing) with_others.push_back(Vec3(x, y, 0.004).cast<float>());
  EXPECT_EQ(reached(with_others, false, {0.15}), 0.0) << "other things are there";
}

TEST(SeenEnds, PointsWithALabelAreOthers) {
  std::vector<TubeModel> tubes = {
      {.paths = {{.nodes = {{-0.1, 0, 0}, {0, 0, 0}}, .bridged = {false}}}, .radius = kEndRadius}};
  const std::vector<cloud::Point> points = rounded_end(0.0);
  EXPECT_FALSE(reach_seen_ends(tubes, points, std::vector<cloud::Label>(points.size(), 1), kEndSpacing, {}));
}

}  // namespace
}  // namespace tubebin::modeling
