// Flat ends of tubes that are seen from the front, apart from what is seen of the tubes.
#include "modeling/end_discs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "modeling/followed_tube.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kApart = 0.001;  // metres
const Vec3 kDiscCenter = {0.1, 0.2, 0.05}, kDiscOutward = Vec3(0.3, -0.2, 1.0).normalized(),
           kDiscViewpoint = kDiscCenter + 1.5 * kDiscOutward;

/// Points of a plane about kDiscCenter that are in the shape, which is asked at two coordinates in radii.
std::vector<Vec3> plane_of(const std::function<bool(double, double)>& is_in, double height = 0.0) {
  const Vec3 right = kDiscOutward.unitOrthogonal(), up = kDiscOutward.cross(right);
  std::vector<Vec3> points;
  for (double x = -5.0 * kRadius; x < 5.0 * kRadius; x += kApart)
    for (double y = -5.0 * kRadius; y < 5.0 * kRadius; y += kApart)
      if (is_in(x / kRadius, y / kRadius)) points.push_back(kDiscCenter + x * right + y * up + height * kDiscOutward);
  return points;
}

std::vector<EndDisc> discs_of(const std::vector<Vec3>& points) {
  return find_end_discs(points, kRadius, kApart, kDiscViewpoint);
}

TEST(EndDiscs, ADiscIsFoundWhereItIs) {
  const std::vector<EndDisc> discs = discs_of(plane_of([](double x, double y) { return std::hypot(x, y) < 1.0; }));
  ASSERT_EQ(discs.size(), 1u);
  EXPECT_LT((discs[0].center - kDiscCenter).norm(), kApart);
  EXPECT_GT(discs[0].outward.dot(kDiscOutward), 0.999);
}

TEST(EndDiscs, OfSeveralDiscsEachIsFound) {
  std::vector<Vec3> points = plane_of([](double x, double y) { return std::hypot(x - 2.2, y) < 1.0; });
  const std::vector<Vec3> second = plane_of([](double x, double y) { return std::hypot(x, y) < 1.0; }, kRadius);
  points.insert(points.end(), second.begin(), second.end());
  EXPECT_EQ(discs_of(points).size(), 2u);
}

TEST(EndDiscs, HalfADiscIsOneAndASmallPartIsNone) {
  const auto above = [](double level) {
    return [level](double x, double y) { return std::hypot(x, y) < 1.0 && y > level; };
  };
  EXPECT_EQ(discs_of(plane_of(above(0.0))).size(), 1u);
  EXPECT_EQ(discs_of(plane_of(above(0.7))).size(), 0u);
}

TEST(EndDiscs, WhatGoesOnIsNone) {
  EXPECT_TRUE(discs_of({}).empty());
  EXPECT_TRUE(discs_of(plane_of([](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 2.0; })).empty());
  EXPECT_TRUE(discs_of(plane_of([](double x, double y) { return std::abs(x) < 0.4 && std::abs(y) < 4.0; })).empty());
}

Step to_discs(const std::vector<double>& lengths) {
  return [lengths](auto& tubes, const auto& cloud, const auto& labels, const auto& projection, const auto& scan) {
    return reach_end_discs(tubes, cloud, labels, projection, scan, lengths);
  };
}

/// A tube that leans by 40 degrees until the bend, from where on it points at the scanner: of that stretch its end alone is seen.
Followed leaning_to_bend(double length) {
  const Vec3 start = kBend + 0.15 * off_ray(ray_at_bend(), 220.0);
  return followed_to_bend({kBend + length * ray_at_bend()}, start);
}

TEST(EndDiscs, ATubeGoesOnToItsDisc) {
  for (const double length : {0.04, 0.07}) {
    const Vec3 end = kBend + length * ray_at_bend();
    EXPECT_LT((leaning_to_bend(length).end(to_discs({})) - end).norm(), 0.25 * kRadius);  // points are as far apart
  }
  EXPECT_EQ(leaning_to_bend(0.14).end(to_discs({})), kBend) << "too far";
}

TEST(EndDiscs, ATubeGetsNoLongerThanTheTubesAre) {
  const Followed followed = leaning_to_bend(0.07);
  EXPECT_EQ(followed.end(to_discs({0.1, 0.15})), kBend);
  EXPECT_NE(followed.end(to_discs({0.1, 0.22})), kBend);
}

TEST(EndDiscs, ATubeDoesNotTurnBackToADisc) {
  const Vec3 start = kBend + 0.15 * off_ray(ray_at_bend(), -30.0);
  EXPECT_EQ(followed_to_bend({kBend + 0.04 * ray_at_bend()}, start).end(to_discs({})), kBend);
}

TEST(EndDiscs, ADiscWhereTheScanSeesThroughTheWayIsAnothers) {
  Followed followed = followed_to_bend({}, kBend + 0.15 * off_ray(ray_at_bend(), 220.0));
  const Followed with_disc = leaning_to_bend(0.07);
  for (std::size_t i = 0; i < with_disc.points.size(); ++i)
    if (with_disc.labels[i] == 0) followed.add(with_disc.points[i], false);
  EXPECT_LT((followed.end(to_discs({})) - kBend).norm(), 0.25 * kRadius);  // the tube's own end
}

}  // namespace
}  // namespace tubebin::modeling
