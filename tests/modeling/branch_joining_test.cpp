#include "modeling/joining/branch_joining.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "modeling/joining/branch_links.hpp"
#include "modeling/lid_scene.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kLongest = 1.0;  // metres, longer than any of these

class BranchJoining : public LidScene {
 protected:
  static TubePath path(std::vector<Vec3> nodes) {
    std::vector<bool> bridged(nodes.size() - 1, false);
    return {.nodes = std::move(nodes), .bridged = std::move(bridged)};
  }
  /// Along x, with a branch from `start` toward +y: its fitted end lies within the trunk.
  static std::vector<TubePath> tree(double y, double start) {
    return {path({{-0.15, y, 0}, {0.15, y, 0}}), path({{0.0, y + start, 0}, {0.0, y + 0.1, 0}})};
  }
};

TEST_F(BranchJoining, ABranchThatStartsOnASideIsLedUpToIt) {
  const auto tubes = join_branches(tree(0.3, 0.5 * kRadius), kRadius, occlusion(), 0.0).tubes;
  ASSERT_EQ(tubes.size(), 1u);
  ASSERT_EQ(tubes[0].paths.size(), 2u);
  EXPECT_NEAR(polyline_length(tubes[0].paths[0].nodes), 0.3, 1e-9);  // longest first
  EXPECT_LT((tubes[0].paths[1].nodes.front() - Vec3(0, 0.3, 0)).norm(), 0.2 * kRadius);
  EXPECT_EQ(tubes[0].paths[1].bridged, (std::vector<bool>{true, false}));
  EXPECT_NEAR(tubes[0].length(), 0.4, 0.2 * kRadius);
}

TEST_F(BranchJoining, ATubeThatEndsBesideAnotherIsNoBranchOfIt) {
  EXPECT_EQ(join_branches(tree(0.3, 2.1 * kRadius), kRadius, occlusion(), 0.0).tubes.size(),
            2u);  // the gap is in sight
  EXPECT_TRUE(join_branches({}, kRadius, occlusion(), 0.0).tubes.empty());
}

TEST_F(BranchJoining, ATubeThatRunsAcrossAnotherIsNoBranchOfIt) {
  std::vector<TubePath> paths = tree(0.3, 0.5 * kRadius);
  paths.push_back(path({{0.0, 0.3 - 0.5 * kRadius, 0}, {0.0, 0.2, 0}}));
  EXPECT_EQ(join_likely_branches(paths, kRadius, occlusion(), 0.0, kLongest).tubes.size(), 3u);
  paths.back() = path({{0.1, 0.3 - 0.5 * kRadius, 0}, {0.1, 0.2, 0}});  // two branches, at two places
  EXPECT_EQ(join_likely_branches(paths, kRadius, occlusion(), 0.0, kLongest).tubes.size(), 1u);

  std::vector<TubePiece> pieces;
  for (const TubePath& p : paths) pieces.push_back({.nodes = p.nodes, .radius = kRadius, .points = {}});
  EXPECT_TRUE(show_branches(pieces, find_piece_ends(pieces, occlusion(), kLongest)));
  for (Vec3& node : pieces.back().nodes) node.x() = 0.0;
  EXPECT_FALSE(show_branches(pieces, find_piece_ends(pieces, occlusion(), kLongest)));
}

TEST_F(BranchJoining, AmongTubesOfOneLengthOnlyWhatIsNotAsLongIsABranch) {
  const auto tubes_of_length = [&](double length, double start) {
    return join_likely_branches(tree(0.3, start), kRadius, occlusion(), length, kLongest).tubes;
  };
  EXPECT_EQ(tubes_of_length(0.0, 0.5 * kRadius).size(), 1u);
  EXPECT_EQ(tubes_of_length(0.5, 0.5 * kRadius).size(), 1u);
  EXPECT_EQ(tubes_of_length(0.3, 0.5 * kRadius).size(), 2u);   // the trunk is whole
  EXPECT_EQ(tubes_of_length(0.35, 0.5 * kRadius).size(), 2u);  // together they are longer
  EXPECT_EQ(tubes_of_length(0.5, 2.1 * kRadius).size(), 2u);
  EXPECT_TRUE(join_likely_branches({}, kRadius, occlusion(), 0.0, kLongest).tubes.empty());
}

TEST_F(BranchJoining, OnlyASureBranchMakesATubeLongerThanALengthThatRecurs) {
  const auto tubes_beside = [&](std::vector<TubePath> paths, int of_one_length) {
    for (int k = 0; k < of_one_length; ++k)
      paths.push_back(path({{-0.125, -0.2 - 0.1 * k, 0}, {0.125, -0.2 - 0.1 * k, 0}}));
    return join_likely_branches(paths, kRadius, occlusion(), 0.0, kLongest).tubes.size() - of_one_length;
  };
  EXPECT_EQ(tubes_beside(tree(0.0, 2.0 * kRadius), 2), 1u);  // starts under the lid
  EXPECT_EQ(tubes_beside(tree(0.0, 2.0 * kRadius), 3), 2u);
  EXPECT_EQ(tubes_beside(tree(0.0, 0.5 * kRadius), 3), 1u);
}

TEST_F(BranchJoining, OnlyASureBranchMakesATubeLongerThanTheLongestPath) {
  const auto tubes_where_longest = [&](double length, double start) {
    return join_likely_branches(tree(0.0, start), kRadius, occlusion(), 0.0, length).tubes.size();
  };
  EXPECT_EQ(tubes_where_longest(0.3, 2.0 * kRadius), 2u);  // starts under the lid; together they are 0.4 m
  EXPECT_EQ(tubes_where_longest(0.4, 2.0 * kRadius), 1u);
  EXPECT_EQ(tubes_where_longest(0.3, 0.5 * kRadius), 1u);  // sure
}

TEST_F(BranchJoining, ABranchThatWasFollowedBeyondItsTrunkIsCutBackToIt) {
  const std::vector<TubePath> paths = tree(0.3, -1.5 * kRadius);
  for (const auto& tubes : {join_branches(paths, kRadius, occlusion(), 0.0).tubes,
                            join_likely_branches(paths, kRadius, occlusion(), 0.0, kLongest).tubes}) {
    ASSERT_EQ(tubes.size(), 1u);
    ASSERT_EQ(tubes[0].paths.size(), 2u);
    EXPECT_NEAR(tubes[0].length(), 0.4, kRadius);
    for (const Vec3& node : tubes[0].paths[1].nodes) EXPECT_GT(node.y(), 0.3 - 0.6 * kRadius);
  }
}

TEST_F(BranchJoining, ArmsThatAreAlikeByChanceShowNoLengthThatRecurs) {
  std::vector<TubePath> paths = tree(0.0, 2.0 * kRadius);  // starts under the lid
  const double arm = polyline_length(paths[1].nodes);
  for (const double y : {-0.3, -0.4}) paths.push_back(path({{0, y, 0}, {arm, y, 0}}));
  EXPECT_EQ(join_likely_branches(paths, kRadius, occlusion(), 0.0, kLongest).tubes.size(), 3u);
}

/// What tells a branch from a flat end that touches a side is in sight or is not.
TEST_F(BranchJoining, AFlatEndThatTouchesASideIsABranchOnlyWhereTheWedgeBetweenThemIsHidden) {
  const auto tubes_at = [&](double y) {
    return join_likely_branches(tree(y, 1.1 * kRadius), kRadius, occlusion(), 0.0, kLongest).tubes.size();
  };
  EXPECT_EQ(tubes_at(0.3), 2u);
  EXPECT_EQ(tubes_at(0.0), 1u);  // under the lid
}

/// Under the lid a branch's start is out of sight, and so is whether it is one.
TEST_F(BranchJoining, AKnownLengthDecidesWhatTheLidHides) {
  const auto tubes_of_length = [&](double length) {
    return join_branches(tree(0.0, 0.038), kRadius, occlusion(), length).tubes;
  };
  EXPECT_EQ(tubes_of_length(0.0).size(), 2u);  // not known
  EXPECT_EQ(tubes_of_length(0.3).size(), 2u);
  ASSERT_EQ(tubes_of_length(0.4).size(), 1u);
  EXPECT_NEAR(tubes_of_length(0.4)[0].length(), 0.4, kRadius);
}

/// Stem and arm end short of the fork that they lead to, so neither leads to the other's side.
TEST_F(BranchJoining, AForkUnderTheLidIsWhereTheWaysStraightOnMeet) {
  const auto arm_at = [&](double angle, double z) {
    const Vec3 outward(std::cos(angle), std::sin(angle), 0.0), below(0, 0, z);
    return TubePiece{
        .nodes = {below + 2.0 * kRadius * outward, below + 0.15 * outward}, .radius = kRadius, .points = {}};
  };
  const auto link_to_stem = [&](double z) {
    const std::vector<TubePiece> pieces = {arm_at(0.0, 0.0), arm_at(radians(110.0), z)};
    const auto links = find_branch_links(pieces, find_piece_ends(pieces, occlusion(), kLongest), occlusion(), 9.0);
    const auto link = std::ranges::find_if(links, [](const BranchLink& l) { return l.end == 2 && !l.other_end; });
    return link == links.end() ? std::nullopt : std::optional(*link);
  };
  const std::optional<BranchLink> link = link_to_stem(0.0);
  ASSERT_TRUE(link);
  EXPECT_LT(link->place.norm(), 0.5 * kRadius);
  EXPECT_LT((link->on_path - Vec3(2.0 * kRadius, 0, 0)).norm(), 1e-9);
  EXPECT_NEAR(link->length, 2.0 * kRadius, 0.5 * kRadius);
  const std::optional<BranchLink> passing = link_to_stem(-4.0 * kRadius);
  EXPECT_TRUE(!passing || passing->cost > link->cost + 2.0);
}

TEST_F(BranchJoining, AnArmIsLedByAHiddenForkToTheStem) {
  std::vector<TubePath> paths = {path({{2.0 * kRadius, 0, 0}, {0.15, 0, 0}}),
                                 path({{0, 2.0 * kRadius, 0}, {0, 0.15, 0}})};
  const auto tubes = join_branches(paths, kRadius, occlusion(), 0.3).tubes;
  ASSERT_EQ(tubes.size(), 1u);
  EXPECT_NEAR(tubes[0].length(), 0.3, 0.5 * kRadius);
}

}  // namespace
}  // namespace tubebin::modeling
