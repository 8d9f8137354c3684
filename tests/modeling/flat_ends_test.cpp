#include "modeling/fitting/flat_ends.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modeling/built_scene.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::testing {

using namespace modeling;
namespace {

/// Points all over the flat end at the origin that faces `outward`, and on `depth` metres of the half of the side that
/// faces up, with normals that are 5 degrees off.
std::vector<SurfacePoint> end_of_tube(const Vec3& outward, double depth, Random& random) {
  constexpr double kSpacing = 0.0025;
  std::vector<SurfacePoint> surface;
  const auto add = [&](const Vec3& position, const Vec3& normal) {
    surface.push_back({position, (normal + 0.09 * (random.rotation() * Vec3::UnitX())).normalized()});
  };
  const Vec3 across = outward.cross(Vec3::UnitZ()).normalized(), up = across.cross(outward);
  for (double x = -kRadius; x <= kRadius; x += kSpacing)
    for (double y = -kRadius; y <= kRadius; y += kSpacing)
      if (std::hypot(x, y) < kRadius) add(x * across + y * up, outward);
  for (double along = kSpacing; along < depth; along += kSpacing)
    for (double angle = 0.0; angle < std::numbers::pi; angle += kSpacing / kRadius) {
      const Vec3 normal = std::cos(angle) * across + std::sin(angle) * up;
      add(kRadius * normal - along * outward, normal);
    }
  return surface;
}

TEST(FlatEnds, ThatAreMostOfWhatIsSeenShowTheAxisBehindThem) {
  Random random(3);
  for (const double depth : {0.0, 0.006}) {
    const Vec3 outward = Vec3(0.8, 0.3, 0.3).normalized();
    const std::vector<Vec3> axis = axis_of_flat_end(end_of_tube(outward, depth, random), kRadius);
    ASSERT_EQ(axis.size(), 2u) << depth;
    EXPECT_GT((axis[1] - axis[0]).normalized().dot(outward), std::cos(radians(5.0)));
    EXPECT_LT(axis[1].norm(), 0.1 * kRadius);
    EXPECT_GT((axis[1] - axis[0]).norm(), 0.99 * std::max(kRadius, depth));
  }
}

TEST(FlatEnds, AreNotSeenInASide) {
  Random random(4);
  for (const double depth : {0.01, 0.02, 0.04}) {
    std::vector<SurfacePoint> surface = end_of_tube(Vec3::UnitX(), depth, random);
    std::erase_if(surface, [](const SurfacePoint& p) { return p.position.x() > -0.001; });
    EXPECT_TRUE(axis_of_flat_end(surface, kRadius).empty()) << depth;
    std::erase_if(surface, [](const SurfacePoint& p) { return std::abs(p.position.y()) > 0.3 * kRadius; });
    EXPECT_TRUE(axis_of_flat_end(surface, kRadius).empty()) << depth;  // all normals within 20 degrees
  }
}

}  // namespace
}  // namespace tubebin::testing
