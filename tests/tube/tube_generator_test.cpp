#include "tubebin/tube/tube_generator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tubebin::tube {
namespace {

std::vector<double> bend_angles(const std::vector<Vec3>& endpoints) {
  std::vector<double> angles;
  for (std::size_t i = 2; i < endpoints.size(); ++i) {
    const Vec3 before = (endpoints[i - 1] - endpoints[i - 2]).normalized();
    const Vec3 after = (endpoints[i] - endpoints[i - 1]).normalized();
    angles.push_back(std::acos(std::clamp(before.dot(after), -1.0, 1.0)));
  }
  return angles;
}

/// Largest distance between the sample's distribution function and the uniform one (Kolmogorov-Smirnov).
double distance_from_uniform(std::vector<double> sample, double low, double high) {
  std::sort(sample.begin(), sample.end());
  double largest = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double expected = (sample[i] - low) / (high - low);
    const double n = static_cast<double>(sample.size());
    largest = std::max({largest, std::abs(static_cast<double>(i) / n - expected),
                        std::abs(static_cast<double>(i + 1) / n - expected)});
  }
  return largest;
}

TEST(Algorithm2, LengthsSumToTheTubesLengthAndKeepTheMinimum) {
  Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const int count = random.integer(1, 25);
    const std::vector<double> lengths = generate_lengths(count, 0.5, 0.02, random);
    ASSERT_EQ(lengths.size(), static_cast<std::size_t>(count));
    EXPECT_NEAR(std::accumulate(lengths.begin(), lengths.end(), 0.0), 0.5, 1e-12);
    EXPECT_GE(*std::min_element(lengths.begin(), lengths.end()), 0.02 - 1e-12);
  }
}

TEST(Algorithm2, TheFirstLengthIsUniformOverWhatTheOthersLeave) {
  Random random(2);
  std::vector<double> first;
  for (int trial = 0; trial < 4000; ++trial) first.push_back(generate_lengths(6, 0.5, 0.02, random).front());
  EXPECT_LT(distance_from_uniform(first, 0.02, 0.5 - 5 * 0.02), 1.95 / std::sqrt(4000.0));  // 0.1 % level
}

TEST(Algorithm3, BendAnglesAreUniformBetweenTheLimits) {
  Random random(3);
  std::vector<double> angles;
  for (int trial = 0; trial < 500; ++trial)
    for (const double angle :
         bend_angles(generate_endpoints({0.1, 0.05, 0.02, 0.2, 0.13}, radians(5), radians(45), random)))
      angles.push_back(angle);
  EXPECT_GE(*std::min_element(angles.begin(), angles.end()), radians(5) - 1e-7);
  EXPECT_LE(*std::max_element(angles.begin(), angles.end()), radians(45) + 1e-7);
  EXPECT_LT(distance_from_uniform(angles, radians(5), radians(45)), 1.95 / std::sqrt(2000.0));
}

TEST(Algorithm3, TheBendsTurnInEveryDirectionAroundThePreviousAxis) {
  Random random(4);
  std::vector<double> turns;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto p = generate_endpoints({0.1, 0.1}, radians(30), radians(30), random);
    const Vec3 axis = (p[1] - p[0]).normalized();
    const Vec3 u = axis.unitOrthogonal();
    const Vec3 bend = p[2] - p[1];
    turns.push_back(std::atan2(bend.dot(axis.cross(u)), bend.dot(u)));
  }
  EXPECT_LT(distance_from_uniform(turns, -std::numbers::pi, std::numbers::pi), 1.95 / std::sqrt(3000.0));
}

TEST(Algorithm3, TheFirstPolarAngleIsUniform) {
  Random random(5);
  std::vector<double> thetas;
  for (int trial = 0; trial < 3000; ++trial)
    thetas.push_back(std::acos(generate_endpoints({1.0}, 0.0, 0.0, random)[1].z()));
  EXPECT_LT(distance_from_uniform(thetas, 0.0, std::numbers::pi), 1.95 / std::sqrt(3000.0));
}

TEST(Algorithm3, StaysStraightWithoutBendsAlsoUpAndDown) {
  // Parallel and antiparallel to z the rotation's axis vanishes; a bend of 0 keeps every direction in all cases.
  Random random(6);
  for (int trial = 0; trial < 500; ++trial) {
    const auto p = generate_endpoints({0.1, 0.2, 0.3}, 0.0, 0.0, random);
    EXPECT_NEAR((p[3] - p[0]).norm(), 0.6, 1e-9);
  }
  // Half turns go back and forth along one line, through the antiparallel case each time.
  const auto folded = generate_endpoints({0.3, 0.3, 0.3}, std::numbers::pi, std::numbers::pi, random);
  EXPECT_NEAR((folded[2] - folded[0]).norm(), 0.0, 1e-9);
  EXPECT_NEAR((folded[3] - folded[1]).norm(), 0.0, 1e-9);
}

TEST(Algorithm1, MakesChainsWithinTheCountsAndRepeatsWithTheSeed) {
  const TubeOptions options;
  Random random(7);
  Random same(7);
  const std::vector<Tube> tubes = generate_tubes(200, options, random);
  const std::vector<Tube> again = generate_tubes(200, options, same);
  std::vector<int> counts(11, 0);
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    const Tube& tube = tubes[i];
    ASSERT_GE(tube.cylinders.size(), 5u);
    ASSERT_LE(tube.cylinders.size(), 10u);
    ++counts[tube.cylinders.size()];
    EXPECT_NEAR(tube.length(), options.length, 1e-12);
    const std::vector<int> degrees = tube.node_degrees();
    EXPECT_EQ(std::count(degrees.begin(), degrees.end(), 1), 2);
    EXPECT_EQ(std::count(degrees.begin(), degrees.end(), 2), static_cast<long>(tube.cylinders.size()) - 1);
    EXPECT_EQ(tube.nodes, again[i].nodes);
  }
  for (int count = 5; count <= 10; ++count) EXPECT_GT(counts[static_cast<std::size_t>(count)], 10);
}

TEST(TubeOptions, ImpossibleCombinationsAreRefused) {
  const KeyPlaces places;
  TubeOptions long_cylinders;
  long_cylinders.cylinder_length_min = 0.051;
  EXPECT_THROW(check(long_cylinders, places, "tube"), ConfigError);
  TubeOptions exact;
  exact.cylinder_length_min = 0.05;
  EXPECT_NO_THROW(check(exact, places, "tube"));
  TubeOptions counts;
  counts.cylinder_count_min = 11;
  EXPECT_THROW(check(counts, places, "tube"), ConfigError);
  TubeOptions bends;
  bends.bend_angle_min_deg = 31.0;
  EXPECT_THROW(check(bends, places, "tube"), ConfigError);
  TubeOptions wall;
  wall.wall_thickness = 0.0125;
  EXPECT_THROW(check(wall, places, "tube"), ConfigError);
}

}  // namespace
}  // namespace tubebin::tube
