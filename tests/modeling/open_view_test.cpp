#include "modeling/input/open_view.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// Points anywhere on the rectangle that two edges span from a corner, metres.
void add_rectangle(const Vec3& corner, const Vec3& a, const Vec3& b, std::size_t count, std::vector<Vec3>& points) {
  Random random(points.size());
  for (std::size_t k = 0; k < count; ++k)
    points.push_back(corner + random.uniform(0.0, 1.0) * a + random.uniform(0.0, 1.0) * b);
}

TEST(HiddenShare, IsNothingOfOneSurface) {
  std::vector<Vec3> points;
  add_rectangle({-0.5, -0.5, 0.0}, {1, 0, 0}, {0, 1, 0}, 8000, points);
  for (const Vec3& viewpoint : {Vec3(0, 0, 2), Vec3(1.5, 0, 0.8), Vec3(0.3, 0.2, -1.0)})
    EXPECT_EQ(hidden_share(points, viewpoint, 4.0), 0.0);
}

TEST(HiddenShare, IsThatOfTheSurfaceBehind) {
  std::vector<Vec3> points;
  add_rectangle({-0.5, -0.5, 0.0}, {1, 0, 0}, {0, 1, 0}, 15000, points);
  add_rectangle({-0.5, -0.5, -0.4}, {1, 0, 0}, {0, 1, 0}, 5000, points);
  // A cell of some four points, mostly three of the upper one: e^-3 of the cells hold none of it.
  EXPECT_NEAR(hidden_share(points, {0, 0, 100}, 4.0), 0.25 * (1.0 - std::exp(-3.0)), 0.02);
  EXPECT_NEAR(hidden_share(points, {0, 0, -100}, 4.0), 0.75 * (1.0 - std::exp(-1.0)), 0.02);
}

TEST(HiddenShare, TakesAnyViewpointAndAnyPoints) {
  EXPECT_EQ(hidden_share({}, Vec3::Zero(), 4.0), 0.0);
  const std::vector<Vec3> one_place(1000, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(hidden_share(one_place, {0, 0, 1}, 4.0), 0.0);
  EXPECT_EQ(hidden_share(one_place, one_place.front(), 4.0), 0.0);
  std::vector<Vec3> around;
  Random random(5);
  for (int k = 0; k < 5000; ++k) around.emplace_back(random.normal(), random.normal(), random.normal());
  EXPECT_GT(hidden_share(around, Vec3::Zero(), 4.0), 0.2);
}

/// A box without a lid, and something in it.
std::vector<Vec3> open_box() {
  std::vector<Vec3> points;
  add_rectangle({-0.3, -0.2, 0.0}, {0.6, 0, 0}, {0, 0.4, 0}, 4000, points);
  for (const double x : {-0.3, 0.3}) add_rectangle({x, -0.2, 0.0}, {0, 0.4, 0}, {0, 0, 0.2}, 1000, points);
  for (const double y : {-0.2, 0.2}) add_rectangle({-0.3, y, 0.0}, {0.6, 0, 0}, {0, 0, 0.2}, 1500, points);
  add_rectangle({-0.1, -0.05, 0.06}, {0.2, 0, 0}, {0, 0.1, 0}, 500, points);
  return points;
}

TEST(MostOpenViewpoint, LooksIntoABoxWhicheverWayItOpens) {
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0.3, -0.5, -0.8)}) {
    const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), up);
    std::vector<Vec3> points = open_box();
    for (Vec3& point : points) point = turn * point + Vec3(3, -2, 1);
    const Vec3 viewpoint = most_open_viewpoint(points, -up);
    EXPECT_GT((viewpoint - Vec3(3, -2, 1)).normalized().dot(up.normalized()), 0.85);
    EXPECT_LT(hidden_share(points, viewpoint, 4.0),
              hidden_share(points, Vec3(3, -2, 1) + turn * Vec3(2.0, 0.4, 0.6), 4.0));
  }
}

TEST(MostOpenViewpoint, IsFarAwayWhereRaysWereParallel) {
  // Squares at many heights, seen from straight above: from a near place or aside, the higher ones hide parts of the lower.
  std::vector<Vec3> points;
  Random random(7);
  for (int column = 0; column < 7; ++column)
    for (int row = 0; row < 7; ++row)
      add_rectangle({0.1 * column, 0.1 * row, random.uniform(0.0, 0.2)}, {0.1, 0, 0}, {0, 0.1, 0}, 400, points);
  const Vec3 viewpoint = most_open_viewpoint(points, -Vec3::UnitZ());
  EXPECT_GT(viewpoint.norm(), 20.0);
  EXPECT_GT(viewpoint.normalized().z(), std::cos(radians(5.0)));
}

TEST(MostOpenViewpoint, IsNotBehind) {
  const std::vector<Vec3> points = open_box();
  for (const Vec3& behind : {Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0.5)})
    EXPECT_LT((most_open_viewpoint(points, behind) - Vec3(0, 0, 0.05)).dot(behind), 0.2);
}

}  // namespace
}  // namespace tubebin::modeling
