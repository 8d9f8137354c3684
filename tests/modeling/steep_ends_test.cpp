// Ends of tubes that go on almost straight toward the scanner or away from it.
#include "modeling/steep_ends.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "modeling/followed_tube.hpp"

namespace tubebin::modeling {
namespace {

TEST(SteepEnds, ASideSeenAtAFewDegreesIsFollowedToItsEnd) {
  for (const double degrees : {8.0, 12.0, 25.0}) {
    const Vec3 end = kBend + 0.15 * off_ray(ray_at_bend(), degrees);
    EXPECT_LT((followed_to_bend({end}).end(reach_steep_ends) - end).norm(), kRadius) << degrees << " degrees";
  }
}

TEST(SteepEnds, WhereNothingGoesOnTheEndStays) { EXPECT_EQ(followed_to_bend({}).end(reach_steep_ends), kBend); }

TEST(SteepEnds, PointsWhereTheScanSawThroughAreNone) {
  Followed followed = followed_to_bend({});
  const Followed steep = followed_to_bend({kBend + 0.15 * off_ray(ray_at_bend(), 12.0)});
  for (std::size_t i = 0; i < steep.points.size(); ++i)
    if (steep.labels[i] == 0) followed.add(steep.points[i], false);
  EXPECT_EQ(followed.end(reach_steep_ends), kBend);
}

TEST(SteepEnds, PointsInTheAirBehindAnEdgeAreNone) {
  Followed followed = followed_to_bend({});
  const Vec3 ray = ray_at_bend(), side = ray.unitOrthogonal(), up = ray.cross(side);
  for (double angle = 0.0; angle < 2.0 * std::numbers::pi; angle += 0.3)
    for (double back = 0.0; back < 0.15; back += 0.005) {
      const Vec3 edge = kBend + kRadius * (std::cos(angle) * side + std::sin(angle) * up);
      followed.add((edge - back * (kEye - edge).normalized()).cast<float>(), false);
    }
  EXPECT_EQ(followed.end(reach_steep_ends), kBend);
}

}  // namespace
}  // namespace tubebin::modeling
