#include "modeling/joining/shape_joining.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "modeling/joining/common_shape.hpp"
#include "modeling/joining/sampled_curve.hpp"
#include "modeling/joining/tube_joining.hpp"
#include "modeling/lid_scene.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kLeg = 0.15, kMiddle = 0.2, kLength = 2.0 * kLeg + kMiddle;  // metres

/// A U in the plane of z = 0, its first corner at the origin, its first leg along -x and its middle along -y.
const std::vector<Vec3> kU = {{-kLeg, 0, 0}, {0, 0, 0}, {0, -kMiddle, 0}, {-kLeg, -kMiddle, 0}};

std::vector<Vec3> moved(std::vector<Vec3> nodes, const Pose& pose) {
  for (Vec3& node : nodes) node = pose * node;
  return nodes;
}

Pose turned(double degrees, const Vec3& to) {
  return make_pose(Quat(Eigen::AngleAxisd(radians(degrees), Vec3::UnitZ())), to);
}

TubePiece piece_along(std::vector<Vec3> nodes) { return {.nodes = std::move(nodes), .radius = kRadius, .points = {}}; }

/// The U in the pose without what is nearer to its first corner than this, metres.
std::vector<TubePiece> without_first_corner(const Pose& pose, double hidden) {
  return {piece_along(moved({kU[0], {-hidden, 0, 0}}, pose)),
          piece_along(moved({{0, -hidden, 0}, kU[2], kU[3]}, pose))};
}

std::vector<Vec3> random_tube(Random& random) {
  std::vector<Vec3> nodes = {Vec3::Zero()};
  Vec3 along = Vec3::UnitX();
  for (int k = 0; k < 8; ++k) {
    const Vec3 axis = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    along = Eigen::AngleAxisd(radians(random.uniform(0.0, 30.0)), axis) * along;
    nodes.push_back(nodes.back() + kLength / 8.0 * along);
  }
  return nodes;
}

TEST(SampledCurve, KeepsEqualStepsFromEndToEnd) {
  const auto samples = smooth_samples(kU, kRadius / 2.0, 0.0);
  EXPECT_EQ(samples.front(), kU.front());
  EXPECT_EQ(samples.back(), kU.back());
  EXPECT_NEAR(polyline_length(samples), kLength, 0.2 * kRadius);
  for (std::size_t k = 1; k < samples.size(); ++k)
    EXPECT_LE((samples[k] - samples[k - 1]).norm(), 1.01 * kLength / static_cast<double>(samples.size() - 1));
}

TEST(SampledCurve, FindsTheMotionBetweenTwoCurves) {
  const Pose motion = make_pose(Quat(Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized())), {0.3, -0.2, 0.1});
  const auto samples = smooth_samples(kU, kRadius / 2.0, kRadius);
  const auto there = moved(samples, motion);
  EXPECT_TRUE(best_motion(samples, there).isApprox(motion, 1e-9));
  EXPECT_LT(distance_apart(samples, there, 0, motion * turned(3.0, {0.002, 0, 0})), kRadius / 20.0);
  EXPECT_NEAR(sagitta(samples), kLeg, kRadius);
}

TEST(CommonShape, IsThatOfPartsBentAlike) {
  std::vector<std::vector<Vec3>> whole = {moved(kU, turned(40.0, {0.5, 0, 0}))};
  std::vector<TubePiece> pieces = {piece_along(whole.front()), without_first_corner(turned(80.0, {0, 0.5, 0}), 0.05)[1],
                                   without_first_corner(turned(200.0, {-0.5, 0, 0}), 0.05)[1]};
  const auto shapes = possible_shapes(whole, pieces);
  ASSERT_EQ(shapes.size(), 1u);
  EXPECT_NEAR(polyline_length(shapes.front()), kLength, 2.0 * kRadius);  // the mean over a radius cuts corners
  pieces.resize(2);  // the whole one, and too little to make another
  EXPECT_TRUE(possible_shapes(whole, pieces).empty());
}

TEST(CommonShape, EndsWhereOneTubeAloneLeadsOn) {
  std::vector<Vec3> into_another = moved(kU, turned(40.0, {0.5, 0, 0}));
  const Vec3 end = into_another.back();
  for (const Vec3& beyond : {Vec3(0.04, 0.02, 0.03), Vec3(0.06, 0.07, 0.05)}) into_another.push_back(end + beyond);
  const std::vector<TubePiece> pieces = {piece_along(into_another), piece_along(moved(kU, turned(80.0, {0, 0.5, 0}))),
                                         without_first_corner(turned(200.0, {-0.5, 0, 0}), 0.05)[1]};
  const std::vector<std::vector<Vec3>> tubes = {into_another};
  const auto shapes = possible_shapes(tubes, pieces);
  ASSERT_EQ(shapes.size(), 1u);
  EXPECT_NEAR(polyline_length(shapes.front()), kLength, 3.0 * kRadius);
}

TEST(CommonShape, TubesOfRandomBendsAndStraightOnesHaveNone) {
  Random random(7);
  std::vector<std::vector<Vec3>> bent, straight;
  for (int k = 0; k < 40; ++k) {
    bent.push_back(random_tube(random));
    straight.push_back({{0.1 * k, 0, 0}, {0.1 * k, kLength, 0}});
  }
  for (const auto& whole : {bent, straight}) {
    std::vector<TubePiece> pieces;
    for (const auto& nodes : whole) pieces.push_back(piece_along(nodes));
    EXPECT_TRUE(possible_shapes(whole, pieces).empty());
  }
}

using Centerlines = std::vector<std::vector<Vec3>>;

const Centerlines kShapes = {smooth_samples(kU, kRadius / 2.0, kRadius)};

class ShapeJoiningUnderLid : public LidScene {
 protected:
  /// Two corners under the lid, back to back: straight on, either's leg leads to the other's middle.
  std::vector<TubePiece> back_to_back() const {
    std::vector<TubePiece> pieces = without_first_corner(turned(0.0, {-0.013, -0.013, 0}), 0.03);
    std::ranges::move(without_first_corner(turned(180.0, {0.013, 0.013, 0}), 0.03), std::back_inserter(pieces));
    return pieces;
  }
};

/// Part of a ring in the plane of z = 0.
std::vector<Vec3> ring(double radius, double from_deg, double to_deg) {
  std::vector<Vec3> nodes;
  for (double angle = from_deg; angle <= to_deg; angle += 5.0)
    nodes.push_back(radius * Vec3(std::cos(radians(angle)), std::sin(radians(angle)), 0.0));
  return nodes;
}

TEST(ShapeJoining, TwoCopiesOfARingDoNotLieInOnePlace) {
  std::vector<cloud::Point> points;
  add_sheet({0, 0, 0.1}, 0.5, points);
  const OcclusionTest all_hidden = seen_from_above(points);
  const Centerlines shapes = {smooth_samples(ring(7.0 * kRadius, 0, 310), kRadius / 2.0, kRadius)};
  // Of a larger ring, of which more is seen than the shape has.
  const auto joined = [&](const Vec3& to) {
    return join_by_shapes(
        {piece_along(ring(7.2 * kRadius, 0, 180)), piece_along(moved(ring(7.2 * kRadius, 185, 345), turned(0.0, to)))},
        shapes, all_hidden);
  };
  EXPECT_EQ(joined({0.4, 0, 0}).paths.size(), 2u);
  EXPECT_LE(joined({0, 0, 0}).paths.size(), 1u);
}

TEST_F(ShapeJoiningUnderLid, JoinsWhatOneCopyExplains) {
  const ShapeJoining joining = join_by_shapes(back_to_back(), kShapes, occlusion());
  EXPECT_TRUE(joining.rest.empty());
  EXPECT_DOUBLE_EQ(joining.explained, 1.0);
  ASSERT_EQ(joining.paths.size(), 2u);
  const std::vector<Vec3> first = moved(kU, turned(0.0, {-0.013, -0.013, 0}));
  const std::vector<Vec3> second = moved(kU, turned(180.0, {0.013, 0.013, 0}));
  for (const TubePath& path : joining.paths) {
    const bool is_first = distance_to_polyline(path.nodes.front(), first) < kRadius;
    for (const Vec3& node : path.nodes) EXPECT_LT(distance_to_polyline(node, is_first ? first : second), kRadius);
    EXPECT_EQ(path.bridged.size() + 1, path.nodes.size());
    EXPECT_EQ(std::ranges::count(path.bridged, true), std::ssize(path.bridge_odds));
  }
}

TEST_F(ShapeJoiningUnderLid, GivesUpWhereMuchOfWhatIsSeenIsOfOtherShapes) {
  Random random(3);
  std::vector<TubePiece> pieces = {piece_along(moved(kU, turned(30.0, {-0.4, 0.3, 0})))};
  for (int k = 0; k < 3; ++k) pieces.push_back(piece_along(random_tube(random)));
  const std::vector<std::size_t> all = {0};
  const ShapeJoining few = ShapeSearch(pieces, kShapes, occlusion(), 0.0).join(all);
  EXPECT_EQ(few.paths.size(), 1u);
  EXPECT_LT(few.explained, 0.5);
  const ShapeJoining none = ShapeSearch(pieces, kShapes, occlusion(), 0.75).join(all);
  EXPECT_TRUE(none.paths.empty());
  EXPECT_EQ(none.explained, 0.0);
}

TEST_F(ShapeJoiningUnderLid, AnElbowsCopiesExplainLongerTubesWorse) {
  // A corner of the U with half of its middle, twice over, lies on both bends of each U; the U itself keeps them whole.
  const Centerlines elbow = {smooth_samples({kU[0], kU[1], {0, -kMiddle / 2.0, 0}}, kRadius / 2.0, kRadius)};
  std::vector<TubePiece> whole;
  for (const double x : {-0.4, 0.4}) whole.push_back(piece_along(moved(kU, turned(30.0, {x, 0.3, 0}))));
  const double of_us = join_by_shapes(whole, kShapes, occlusion()).gain;
  EXPECT_GT(of_us, 0.0);
  EXPECT_LT(join_by_shapes(whole, elbow, occlusion()).gain, of_us / 2.0);
}

TEST_F(ShapeJoiningUnderLid, TubesThatAreAlikeByChanceAreJoinedByThemselves) {
  Random random(128);  // of 300 scenes the one where copies of one tube explain three quarters of them
  std::vector<TubePiece> pieces;
  for (int k = 0; k < 8; ++k) {
    std::vector<Vec3> nodes = {Vec3(-0.5 + 0.05 * k, -0.6 + 0.15 * k, 0)};
    Vec3 along = Vec3::UnitX();
    for (int n = 0; n < 8; ++n) {
      along = Eigen::AngleAxisd(radians(random.uniform(-12.0, 12.0)), Vec3::UnitZ()) * along;
      nodes.push_back(nodes.back() + kLength / 8.0 * along);
    }
    pieces.push_back(piece_along(std::move(nodes)));
  }
  const Joining joining = join_pieces(pieces, occlusion(), 0.0);
  EXPECT_FALSE(joining.are_copies);
  EXPECT_EQ(joining.paths.size(), pieces.size());
}

TEST_F(ShapeJoiningUnderLid, LeavesWhatTheScanShowsToBeElsewhere) {
  // In the open, where a corner would be seen.
  std::vector<TubePiece> pieces = without_first_corner(turned(0.0, {0.3, 0.3, 0}), 0.06);
  const ShapeJoining joining = join_by_shapes(pieces, kShapes, occlusion());
  for (const TubePath& path : joining.paths)  // the second piece's two sections alone
    EXPECT_GT(distance_to_polyline(pieces[0].nodes.front(), path.nodes), 2.0 * kRadius);
}

TEST_F(ShapeJoiningUnderLid, TellsTwoKindsApart) {
  // The L has the U's legs for both of its own; one of each kind lies in the open, corners and all.
  const std::vector<Vec3> l = {{-0.3, 0, 0}, {0, 0, 0}, {0, -kLeg, 0}};
  const std::vector<TubePiece> pieces = {piece_along(moved(kU, turned(30.0, {-0.2, 0.4, 0}))),
                                         piece_along(moved(l, turned(-70.0, {0.2, -0.4, 0})))};
  const Joining joining = join_pieces_by_shapes(pieces, occlusion(), Centerlines{l, kU});
  EXPECT_DOUBLE_EQ(joining.explained, 1.0);
  ASSERT_EQ(joining.paths.size(), 2u);
  for (const TubePath& path : joining.paths) {
    const double length = polyline_length(path.nodes);
    EXPECT_LT(std::min(std::abs(length - kLength), std::abs(length - 0.3 - kLeg)), 3.0 * kRadius);
    EXPECT_EQ(std::ranges::count(path.bridged, true), 0);
  }
}

TEST_F(ShapeJoiningUnderLid, ASolidPartIsNotItsMirrorImage) {
  const std::vector<Vec3> part = {{-kLeg, 0, 0}, {0, 0, 0}, {0, -kMiddle, 0}, {0, -kMiddle, kLeg}};
  std::vector<Vec3> mirrored = part;
  for (Vec3& node : mirrored) node.z() = -node.z();
  const std::vector<TubePiece> pieces = {piece_along(moved(part, turned(30.0, {-0.2, 0.4, 0})))};
  EXPECT_DOUBLE_EQ(join_pieces_by_shapes(pieces, occlusion(), Centerlines{part}).explained, 1.0);
  EXPECT_LT(join_pieces_by_shapes(pieces, occlusion(), Centerlines{mirrored}).explained, 0.8);
}

TEST_F(ShapeJoiningUnderLid, ABentPieceIsACopyByItself) {
  // Bent so little that nothing is cut.
  const std::vector<Vec3> part = {{-0.3, 0, 0}, {0, 0, 0}, {0.3 * std::cos(0.5), 0.3 * std::sin(0.5), 0}};
  const std::vector<TubePiece> pieces = {piece_along(moved(part, turned(30.0, {-0.2, 0.4, 0})))};
  const Joining joining = join_pieces_by_shapes(pieces, occlusion(), Centerlines{part});
  EXPECT_DOUBLE_EQ(joining.explained, 1.0);
  EXPECT_EQ(joining.paths.size(), 1u);
}

TEST_F(ShapeJoiningUnderLid, TheSceneShowsTheShapeThoughTubesSeemToBranch) {
  std::vector<TubePiece> pieces = back_to_back();
  const Pose onto_middle = turned(0.0, {kLeg + 0.4 * kRadius, -kMiddle / 2.0, 0});  // as fits of rough rods may lie
  for (const Pose& pose : {turned(30.0, {-0.4, 0.6, 0}), turned(-70.0, {0.4, -0.6, 0})}) {
    pieces.push_back(piece_along(moved(kU, pose)));
    pieces.push_back(piece_along(moved(kU, pose * onto_middle)));
  }
  const Joining joining = join_pieces(pieces, occlusion(), 0.0);
  ASSERT_EQ(joining.lengths.size(), 1u);
  EXPECT_NEAR(joining.lengths.front(), kLength, 2.0 * kRadius);
  ASSERT_EQ(joining.paths.size(), 6u);
  for (const TubePath& path : joining.paths) EXPECT_NEAR(polyline_length(path.nodes), kLength, 3.0 * kRadius);
}

TEST_F(ShapeJoiningUnderLid, TheSceneShowsTwoShapes) {
  // Copies of the L lie on all but a leg of each U.
  const std::vector<Vec3> l = {kU[0], kU[1], kU[2]};
  std::vector<TubePiece> pieces;
  for (const double x : {-0.2, 0.05, 0.3}) {
    pieces.push_back(piece_along(moved(kU, turned(20.0 * x, {x, 0.35, 0}))));
    pieces.push_back(piece_along(moved(l, turned(-20.0 * x, {x, -0.15, 0}))));
  }
  const Joining joining = join_pieces(pieces, occlusion(), 0.0);
  ASSERT_EQ(joining.lengths.size(), 2u);
  EXPECT_NEAR(std::ranges::max(joining.lengths), kLength, 2.0 * kRadius);
  EXPECT_NEAR(std::ranges::min(joining.lengths), polyline_length(l), 2.0 * kRadius);
  EXPECT_DOUBLE_EQ(joining.explained, 1.0);
  ASSERT_EQ(joining.paths.size(), 6u);
  const auto is_u = [](const TubePath& path) { return polyline_length(path.nodes) > kLength - 2.0 * kRadius; };
  EXPECT_EQ(std::ranges::count_if(joining.paths, is_u), 3);
}

TEST_F(ShapeJoiningUnderLid, TheSceneShowsTheShapeItself) {
  std::vector<TubePiece> pieces = back_to_back();
  pieces.push_back(piece_along(moved(kU, turned(30.0, {-0.2, 0.4, 0}))));
  pieces.push_back(piece_along(moved(kU, turned(-70.0, {0.2, -0.4, 0}))));
  const Joining joining = join_pieces(pieces, occlusion(), 0.0);
  ASSERT_EQ(joining.lengths.size(), 1u);
  EXPECT_NEAR(joining.lengths.front(), kLength, 2.0 * kRadius);
  ASSERT_EQ(joining.paths.size(), 4u);
  for (const TubePath& path : joining.paths) {
    EXPECT_NEAR(polyline_length(path.nodes), kLength, 3.0 * kRadius);
    EXPECT_GT(sagitta(smooth_samples(path.nodes, kRadius / 2.0, kRadius)), 0.12);  // a U, not a Z
  }
}

}  // namespace
}  // namespace tubebin::modeling
