#include "modeling/doubtful_tubes.hpp"

#include <gtest/gtest.h>

namespace tubebin::modeling {
namespace {

TubeModel tube_of(double length, double radius, double evidence) {
  return {.paths = {{.nodes = {{0, 0, 0}, {length, 0, 0}}, .bridged = {false}, .evidence = evidence}},
          .radius = radius};
}

TEST(DoubtfulTubes, WhatSaysLittleAPointBesideOthersOfItsRadiusIsDropped) {
  std::vector<TubeModel> tubes = {tube_of(0.5, 0.01, 1e5), tube_of(0.6, 0.01, 200.0), tube_of(0.4, 0.01, 1e4),
                                  tube_of(0.3, 0.02, 200.0)};
  std::vector<cloud::Label> labels = {0};
  for (const cloud::Label label : {1, 2, 3, 4}) labels.insert(labels.end(), 1000, label);
  ASSERT_TRUE(drop_doubtful(tubes, labels, false));  // 200 nats are a 170th of the 34 nats a point of this radius
  ASSERT_EQ(tubes.size(), 3u);
  EXPECT_NEAR(tubes[1].length(), 0.4, 1e-12);
  EXPECT_NEAR(tubes[2].radius, 0.02, 1e-12);  // alone with its radius
}

TEST(DoubtfulTubes, AShortOneWithFewPointsMayBeOne) {
  std::vector<TubeModel> tubes = {tube_of(0.5, 0.01, 1e5), tube_of(0.2, 0.01, 500.0)};
  std::vector<cloud::Label> labels(1000, 1);
  labels.insert(labels.end(), 50, 2);
  EXPECT_FALSE(drop_doubtful(tubes, labels, false));
  EXPECT_EQ(tubes.size(), 2u);
}

TEST(DoubtfulTubes, AShortOneOnRoughGroundNeedsMoreAPoint) {
  std::vector<TubeModel> tubes = {tube_of(0.5, 0.01, 1e5), tube_of(0.07, 0.01, 380.0), tube_of(0.3, 0.01, 380.0),
                                  tube_of(0.07, 0.01, 1000.0)};
  std::vector<cloud::Label> labels(1000, 1);
  for (const cloud::Label label : {2, 3, 4}) labels.insert(labels.end(), 100, label);
  EXPECT_FALSE(drop_doubtful(tubes, labels, false));
  ASSERT_TRUE(drop_doubtful(tubes, labels, true));  // 3.8 of the 78 nats a point, 5 %
  ASSERT_EQ(tubes.size(), 3u);
  EXPECT_NEAR(tubes[1].length(), 0.3, 1e-12);
}

TEST(DoubtfulTubes, AShortOneOfLittleEvidenceIsDropped) {
  std::vector<TubeModel> tubes = {tube_of(0.05, 0.01, 50.0)};
  EXPECT_TRUE(drop_doubtful(tubes, {1, 1, 1}, false));
  EXPECT_TRUE(tubes.empty());
  EXPECT_FALSE(drop_doubtful(tubes, {0}, false));
}

}  // namespace
}  // namespace tubebin::modeling
