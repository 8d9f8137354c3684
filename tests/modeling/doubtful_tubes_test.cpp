#include "modeling/doubtful_tubes.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace tubebin::modeling {
namespace {

TubeModel tube_of(double length, double radius, double evidence) {
  return {.paths = {{.nodes = {{0, 0, 0}, {length, 0, 0}}, .bridged = {false}, .evidence = evidence}},
          .radius = radius};
}

/// Of tubes that have no lengths in common.
std::vector<WeakTube> drop_doubtful(std::vector<TubeModel>& tubes, const std::vector<cloud::Label>& labels,
                                    bool is_rough) {
  std::vector<double> lengths;
  return modeling::drop_doubtful(tubes, lengths, labels, is_rough);
}

TEST(DoubtfulTubes, OneThatSaysLittleAPointBesideOthersOfItsRadiusIsWeakAndOnRoughGroundDropped) {
  const std::vector<TubeModel> all = {tube_of(0.5, 0.01, 1e5), tube_of(0.6, 0.01, 200.0), tube_of(0.4, 0.01, 1e4),
                                      tube_of(0.3, 0.02, 200.0)};
  std::vector<cloud::Label> labels = {0};
  for (const cloud::Label label : {1, 2, 3, 4}) labels.insert(labels.end(), 1000, label);
  for (const bool is_rough : {false, true}) {
    std::vector<TubeModel> tubes = all;
    const auto weak = drop_doubtful(tubes, labels, is_rough);  // 200 nats are a 170th of the 34 nats a point of this radius
    EXPECT_EQ(weak.size(), is_rough ? 0u : 1u);
    ASSERT_EQ(tubes.size(), 3u);
    EXPECT_NEAR(tubes[1].length(), 0.4, 1e-12);
    EXPECT_NEAR(tubes[2].radius, 0.02, 1e-12);  // alone with its radius
  }
}

TEST(DoubtfulTubes, OneWithFewPointsMayBeOne) {
  std::vector<TubeModel> tubes = {tube_of(0.5, 0.01, 1e5), tube_of(0.2, 0.01, 500.0)};
  std::vector<cloud::Label> labels(1000, 1);
  labels.insert(labels.end(), 50, 2);
  EXPECT_TRUE(drop_doubtful(tubes, labels, false).empty());
  EXPECT_EQ(tubes.size(), 2u);
}

TEST(DoubtfulTubes, AShortOneOnRoughGroundNeedsMoreAPoint) {
  std::vector<TubeModel> tubes = {tube_of(0.5, 0.01, 1e5), tube_of(0.07, 0.01, 380.0), tube_of(0.3, 0.01, 380.0),
                                  tube_of(0.07, 0.01, 1000.0)};
  std::vector<cloud::Label> labels(1000, 1);
  for (const cloud::Label label : {2, 3, 4}) labels.insert(labels.end(), 100, label);
  EXPECT_TRUE(drop_doubtful(tubes, labels, false).empty());
  ASSERT_EQ(tubes.size(), 4u);
  drop_doubtful(tubes, labels, true);  // 3.8 of the 78 nats a point, 5 %
  ASSERT_EQ(tubes.size(), 3u);
  EXPECT_NEAR(tubes[1].length(), 0.3, 1e-12);
}

TEST(DoubtfulTubes, AWeakOneComesBackWhereMostOfItsPointsAreNoOthers) {
  const WeakTube weak = {.tube = tube_of(0.3, 0.01, 200.0), .points = {1, 2, 3}};
  for (const auto& [labels, comes_back] : std::vector<std::pair<std::vector<cloud::Label>, bool>>{
           {{1, 0, 0, 1}, true}, {{1, 0, 1, 1}, false}, {{0, 1, 1, 1}, false}}) {
    std::vector<TubeModel> tubes = {tube_of(0.5, 0.01, 1e5)};
    std::vector<double> lengths = {0.3, 0.5};
    EXPECT_EQ(restore_unexplained({weak}, tubes, lengths, labels), comes_back);
    EXPECT_EQ(tubes.size(), comes_back ? 2u : 1u);
    EXPECT_EQ(lengths.front(), comes_back ? 0.3 : 0.5) << "a length that only a dropped one has is none";
  }
}

TEST(DoubtfulTubes, AShortOneOfLittleEvidenceIsDropped) {
  std::vector<TubeModel> tubes = {tube_of(0.05, 0.01, 50.0)};
  EXPECT_TRUE(drop_doubtful(tubes, {1, 1, 1}, false).empty());
  EXPECT_TRUE(tubes.empty());
}

TEST(DoubtfulTubes, TheLengthsThatOnlyTheyHadGo) {
  std::vector<TubeModel> tubes = {tube_of(0.5, 0.01, 1e5), tube_of(0.036, 0.01, 50.0), tube_of(0.036, 0.01, 50.0),
                                  tube_of(0.3, 0.01, 1e5)};
  std::vector<double> lengths = {0.036, 0.4, 0.504};
  modeling::drop_doubtful(tubes, lengths, {1, 2, 3, 4}, false);
  EXPECT_EQ(lengths, (std::vector<double>{0.4, 0.504})) << "0.4: of tubes that are seen in part";
}

}  // namespace
}  // namespace tubebin::modeling
