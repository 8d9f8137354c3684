#include "modeling/doubtful_tubes.hpp"

#include <gtest/gtest.h>

#include <tuple>
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

/// A tube of 1e5 nats and one of `evidence`, a thousand points each, and one of another radius.
std::vector<TubeModel> beside_a_sure_one(double evidence) {
  return {tube_of(0.5, 0.01, 1e5), tube_of(0.6, 0.01, evidence), tube_of(0.3, 0.02, 200.0)};
}

TEST(DoubtfulTubes, OneThatSaysLittleAPointBesideOthersOfItsRadiusIsWeak) {
  std::vector<cloud::Label> labels = {0};
  for (const cloud::Label label : {1, 2, 3}) labels.insert(labels.end(), 1000, label);
  // A fortieth of the mean, 51 nats, is 1.3 nats a point.
  for (const auto& [evidence, is_rough, left, weak] : std::vector<std::tuple<double, bool, std::size_t, std::size_t>>{
           {1400.0, false, 3, 0}, {1200.0, false, 2, 1}, {1200.0, true, 2, 0}, {900.0, false, 2, 0}}) {
    std::vector<TubeModel> tubes = beside_a_sure_one(evidence);
    EXPECT_EQ(drop_doubtful(tubes, labels, is_rough).size(), weak) << evidence;
    ASSERT_EQ(tubes.size(), left) << evidence;
    EXPECT_NEAR(tubes.back().radius, 0.02, 1e-12) << "alone with its radius";
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
