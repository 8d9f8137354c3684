#include <gtest/gtest.h>

#include <cmath>

#include "tubebin/core/random.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {
namespace {

const Bin kBox;
const Bin kReal = {.height = 0.25, .wall_thickness = 0.004, .draft_deg = 6.0, .rim_width = 0.02, .corner_radius = 0.04};

/// How far a place is within the walls of a bin with round corners at its height; negative: beyond them.
double depth_inside_walls(const Bin& bin, const Vec3& p) {
  const double wider = p.z() * std::tan(radians(bin.draft_deg));
  const double x = std::abs(p.x()) - (bin.length / 2.0 + wider - bin.corner_radius);
  const double y = std::abs(p.y()) - (bin.width / 2.0 + wider - bin.corner_radius);
  return bin.corner_radius - (x > 0.0 && y > 0.0 ? std::hypot(x, y) : std::max(x, y));
}

bool is_in_parts(const Bin& bin, const Vec3& p) {
  for (const BinPart& part : bin_parts(bin))
    if (part.box.contains(part.world_from_part.inverse() * p)) return true;
  return false;
}

Vec3 random_place(Random& random) {
  return {random.uniform(-0.35, 0.35), random.uniform(-0.25, 0.25), random.uniform(0.0, 0.3)};
}

TEST(Bin, TheInnerSpaceIsFreeAndSolidWallsAreAroundIt) {
  constexpr double kFacet = 0.0005;  // metres that facets may be off the arc
  for (const Bin& bin : {kBox, kReal}) {
    Random random(1);
    int inside = 0, in_walls = 0;
    for (int i = 0; i < 100000; ++i) {
      const Vec3 p = random_place(random);
      const double depth = depth_inside_walls(bin, p);
      if (depth > 0.0 || p.z() > bin.height) {
        ++inside;
        ASSERT_FALSE(is_in_parts(bin, p)) << p.transpose();
      } else if (depth < -kFacet && depth > -0.9 * bin.wall_thickness && p.z() < bin.height - 0.001) {
        ++in_walls;
        ASSERT_TRUE(is_in_parts(bin, p)) << p.transpose();
      }
    }
    EXPECT_GT(inside, 30000);
    EXPECT_GT(in_walls, 500);
  }
}

TEST(Bin, TheRimIsLevelAndReachesAllAround) {
  Random random(2);
  int on_rim = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3 p = random_place(random);
    p.z() = kReal.height - 1e-6;
    const double depth = depth_inside_walls(kReal, p);
    if (depth > -0.0005 || depth < -0.99 * kReal.rim_width) continue;
    ++on_rim;
    EXPECT_TRUE(is_in_parts(kReal, p)) << p.transpose();
    EXPECT_FALSE(is_in_parts(kReal, p - 2.0 * kReal.wall_thickness * Vec3::UnitZ()) &&
                 depth < -3.0 * kReal.wall_thickness)
        << "the rim is as thick as the walls";
  }
  EXPECT_GT(on_rim, 500);
}

TEST(Bin, FacesBoundTheInnerSpace) {
  for (const Bin& bin : {kBox, kReal}) {
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p = random_place(random);
      const double depth = depth_inside_walls(bin, p);
      double least = 1.0;
      for (const InnerFace& face : inner_faces(bin)) least = std::min(least, face.depth_inside(p));
      if (depth > 0.0) {
        EXPECT_GT(least, -1e-12);
      } else if (depth < -0.0005) {
        EXPECT_LT(least, 0.0);
      }
    }
  }
}

TEST(Bin, ABoxHasFiveUprightParts) {
  EXPECT_EQ(bin_parts(kBox).size(), 5U);
  for (const BinPart& part : bin_parts(kBox)) EXPECT_FALSE(part.is_turned);
  EXPECT_GT(bin_parts(kReal).size(), 5U);
  EXPECT_LE(bin_parts(kReal).size(), 64U);  // as many as the scanner tells apart
}

}  // namespace
}  // namespace tubebin::scene
