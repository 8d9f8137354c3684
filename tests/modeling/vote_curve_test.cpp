#include "modeling/fitting/vote_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modeling/built_surface.hpp"
#include "modeling/fitting/centerline_fitting.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// Samples a third of a radius apart on an arc (radius of the arc in metres), off it by normal noise.
VoteCurve noisy_arc(double arc_radius, double sigma, std::size_t count) {
  Random random(5);
  VoteCurve curve;
  for (std::size_t k = 0; k < count; ++k) {
    const double angle = static_cast<double>(k) * kRadius / 3.0 / arc_radius;
    const Vec3 place = arc_radius * Vec3(std::cos(angle), std::sin(angle), 0.0);
    curve.samples.push_back(place + sigma * Vec3(random.normal(), random.normal(), random.normal()));
  }
  return curve;
}

TEST(VoteCurve, RunsAlongTheCentreline) {
  const std::vector<Vec3> nodes = {{-0.1, 0, 0}, {0, 0, 0}, {0.08, 0.05, 0.01}};
  const FilteredCloud cloud = upper_half_of(nodes);
  const VoteCurve curve = find_vote_curve(cloud, {cloud.source, VoteGraph(cloud, cloud.source, kRadius)}, kRadius);
  EXPECT_EQ(curve.points, cloud.source);
  ASSERT_GT(curve.samples.size(), 20u);
  for (const Vec3& sample : curve.samples) EXPECT_LT(distance_to_polyline(sample, nodes), 0.1 * kRadius);
}

TEST(VoteCurve, RoughnessIsTheScatterOfSamplesWhateverTheBend) {
  for (const double sigma : {0.02 * kRadius, 0.05 * kRadius})
    for (const double arc_radius : {20.0 * kRadius, 1000.0 * kRadius}) {
      const VoteCurve curve = noisy_arc(arc_radius, sigma, 2000);
      EXPECT_NEAR(roughness({&curve, 1}), sigma, 0.1 * sigma);
    }
  EXPECT_EQ(roughness({}), 0.0);
}

TEST(VoteCurve, BendsAreToldFromNoise) {
  const VoteCurve still = noisy_arc(1.0, 0.0, 100), rough = noisy_arc(1.0, 0.02 * kRadius, 2000),
                  useless = noisy_arc(1.0, kRadius, 100);
  EXPECT_DOUBLE_EQ(bend_tolerance({&still, 1}, kRadius), kRadius / 20.0);
  EXPECT_NEAR(bend_tolerance({&rough, 1}, kRadius), 0.08 * kRadius, 0.01 * kRadius);
  EXPECT_DOUBLE_EQ(bend_tolerance({&useless, 1}, kRadius), kRadius / 9.0);
}

}  // namespace
}  // namespace tubebin::modeling
