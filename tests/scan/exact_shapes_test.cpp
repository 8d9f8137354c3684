#include "scan/exact_shapes.hpp"

#include <gtest/gtest.h>

#include "scan/signed_distance.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::scan {
namespace {

using testing::box_distance;
using testing::cylinder_distance;

TEST(SolidCylinder, IsHitAtItsSideAndItsCaps) {
  const SolidCylinder cylinder({-1, 0, 3}, {1, 0, 3}, 0.5);
  const Interval across = cylinder.intersect({0, 0, 1});
  EXPECT_DOUBLE_EQ(across.begin, 2.5);
  EXPECT_DOUBLE_EQ(across.end, 3.5);

  const SolidCylinder upright({0, 0, 2}, {0, 0, 5}, 0.5);
  const Interval along = upright.intersect({0, 0, 1});
  EXPECT_DOUBLE_EQ(along.begin, 2.0);
  EXPECT_DOUBLE_EQ(along.end, 5.0);
  const Interval cap_to_side = upright.intersect({0.2, 0, 1});
  EXPECT_DOUBLE_EQ(cap_to_side.begin, 2.0);
  EXPECT_DOUBLE_EQ(cap_to_side.end, 2.5);
}

TEST(SolidCylinder, EndsFlatAndAtItsRadius) {
  const SolidCylinder cylinder({-1, 0, 3}, {1, 0, 3}, 0.5);
  // The cap x = 1 reaches from z = 2.5 to z = 3.5; a ray below its near rim passes.
  EXPECT_DOUBLE_EQ(cylinder.intersect({1.0, 0, 2.6}).begin, 2.5 / 2.6);
  EXPECT_DOUBLE_EQ(cylinder.intersect({1.0, 0, 2.6}).end, 1.0);
  EXPECT_TRUE(cylinder.intersect({1.0, 0, 2.499}).empty());
  const SolidCylinder below({0, -1, 3}, {0, 1, 3}, 0.5);
  const double tangent = 0.5 / std::sqrt(9.0 - 0.25);  // slope of the line from the origin that touches the circle
  EXPECT_FALSE(below.intersect({tangent * (1.0 - 1e-12), 0, 1}).empty());
  EXPECT_TRUE(below.intersect({tangent * (1.0 + 1e-12), 0, 1}).empty());
}

TEST(SolidCylinder, AroundTheOriginIsEnteredBehindIt) {
  const SolidCylinder cylinder({-1, 0, 0.1}, {1, 0, 0.1}, 0.5);
  const Interval part = cylinder.intersect({0, 0, 1});
  EXPECT_DOUBLE_EQ(part.begin, -0.4);
  EXPECT_DOUBLE_EQ(part.end, 0.6);
}

TEST(SolidCylinder, ParallelRayOutsideMisses) {
  EXPECT_TRUE(SolidCylinder({0.6, 0, 2}, {0.6, 0, 5}, 0.5).intersect({0, 0, 1}).empty());
}

TEST(SolidSphere, IsEnteredAndLeftOnItsSurface) {
  const Interval part = SolidSphere({0, 0, 3}, 0.5).intersect({0, 0, 2});
  EXPECT_DOUBLE_EQ(part.begin, 1.25);
  EXPECT_DOUBLE_EQ(part.end, 1.75);
  EXPECT_TRUE(SolidSphere({0.6, 0, 3}, 0.5).intersect({0, 0, 1}).empty());
}

TEST(SolidBox, RayWithinAFacesPlaneTouches) {
  const scene::Box box(Vec3(0, -1, 2), Vec3(1, 1, 3));
  EXPECT_FALSE(intersect(box, inverse_direction({0, 0, 1})).empty());
  EXPECT_TRUE(intersect(box, inverse_direction({-1e-9, 0, 1})).empty());
}

/// Both ends of every interval lie on the surface, its middle inside, and what misses never comes inside.
template <typename Intersect, typename Distance>
void expect_exact(const Intersect& intersect_ray, const Distance& distance, const Vec3& direction) {
  const Interval part = intersect_ray(direction);
  if (part.empty()) {
    for (int i = -2000; i <= 2000; ++i) ASSERT_GE(distance(direction * (i * 0.002)), -1e-12);
    return;
  }
  ASSERT_NEAR(distance(part.begin * direction), 0.0, 1e-11);
  ASSERT_NEAR(distance(part.end * direction), 0.0, 1e-11);
  ASSERT_LE(distance((part.begin + part.end) / 2 * direction), 1e-12);
}

TEST(ExactShapes, AgreeWithSignedDistancesOnRandomRays) {
  Random random(7);
  const auto point = [&](double reach) {
    return Vec3(random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach));
  };
  int hits = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Vec3 a = point(2.0), b = a + point(0.3), direction = (a + point(0.05)).normalized();
    const double radius = random.uniform(0.002, 0.05);
    const SolidCylinder cylinder(a, b, radius);
    const auto hit_cylinder = [&](const Vec3& d) { return cylinder.intersect(d); };
    hits += hit_cylinder(direction).empty() ? 0 : 1;
    expect_exact(
        hit_cylinder, [&](const Vec3& p) { return cylinder_distance(p, a, b, radius); }, direction);

    const SolidSphere sphere(a, radius);
    expect_exact([&](const Vec3& d) { return sphere.intersect(d); },
                 [&](const Vec3& p) { return (p - a).norm() - radius; }, direction);

    const scene::Box box(a.cwiseMin(b), a.cwiseMax(b));
    expect_exact([&](const Vec3& d) { return intersect(box, inverse_direction(d)); },
                 [&](const Vec3& p) { return box_distance(p, box.min(), box.max()); }, direction);
  }
  EXPECT_GT(hits, 500);
  EXPECT_LT(hits, 3500);
}

TEST(ExactShapes, BoundsTouchTheSurfaceOnEverySide) {
  Random random(8);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 a(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec3 axis = random.rotation() * Vec3::UnitZ();
    const Vec3 b = a + axis * random.uniform(0.01, 1.0);
    const Eigen::AlignedBox3d bounds = SolidCylinder(a, b, 0.1).bounds();
    Eigen::AlignedBox3d sampled;  // both rims, finely
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    for (int i = 0; i < 3600; ++i) {
      const double angle = radians(i / 10.0);
      const Vec3 offset = 0.1 * (std::cos(angle) * u + std::sin(angle) * v);
      sampled.extend(a + offset);
      sampled.extend(b + offset);
    }
    EXPECT_LT((bounds.min() - sampled.min()).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((bounds.max() - sampled.max()).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_TRUE((bounds.min().array() <= sampled.min().array() + 1e-15).all());
  }
}

}  // namespace
}  // namespace tubebin::scan
