#include "modeling/joining/tube_joining.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "modeling/lid_scene.hpp"

namespace tubebin::modeling {
namespace {

class TubeJoining : public LidScene {
 protected:
  std::vector<double> joined_lengths(const std::vector<TubePiece>& pieces) const {
    std::vector<double> lengths;
    for (const TubePath& path : join_pieces(pieces, occlusion(), 0.0).paths)
      lengths.push_back(polyline_length(path.nodes));
    std::sort(lengths.begin(), lengths.end());
    return lengths;
  }

  /// Of the join of two pieces, the first one's last end with the second one's first.
  double cost_of_inner_ends(const std::vector<TubePiece>& pieces, const std::vector<PieceEnd>& ends) const {
    for (const PossibleJoin& join : find_possible_joins(pieces, ends, occlusion(), 1.0, 100.0))
      if (join.end_a == 1 && join.end_b == 2) return join.cost;
    return 100.0;
  }
};

TEST_F(TubeJoining, BitsOfSurfaceTellNoCommonLength) {
  const auto lengths = joined_lengths(
      {straight(0, -0.25, -0.01), straight(0, 0.01, 0.25), straight(0.3, 0.3, 0.32), straight(-0.3, 0.3, 0.32)});
  ASSERT_EQ(lengths.size(), 1u);  // bits are no tubes either
  EXPECT_NEAR(lengths.front(), 0.5, 1e-9);
}

TEST_F(TubeJoining, ALengthIsCommonWhereMostTubesHaveIt) {
  const auto length_of = [&](const std::vector<double>& lengths) {
    std::vector<TubePiece> pieces;
    for (std::size_t i = 0; i < lengths.size(); ++i)
      pieces.push_back(straight(0.05 * double(i) - 0.3, -0.25, -0.25 + lengths[i]));
    const std::vector<double> common = join_pieces(pieces, occlusion(), 0.0).lengths;
    return common.size() == 1 ? common.front() : 0.0;
  };
  EXPECT_DOUBLE_EQ(length_of({0.5, 0.5, 0.501, 0.502, 0.35}), 0.501);
  EXPECT_EQ(length_of({0.5, 0.5, 0.55, 0.6, 0.4, 0.35}), 0.0);  // two by chance
  // In a crowded pile, most of what is seen are parts.
  EXPECT_NEAR(length_of({0.5, 0.501, 0.502, 0.5, 0.499, 0.2, 0.24, 0.28, 0.33, 0.37, 0.41, 0.45}), 0.5, 0.002);
  // And points in the air, which scanners make at edges, seem to be many short ones.
  std::vector<double> lengths = {0.5, 0.501, 0.502, 0.5};
  for (int i = 0; i < 30; ++i) lengths.push_back(0.015 + 0.0003 * i);
  EXPECT_NEAR(length_of(lengths), 0.5, 0.002);
}

TEST_F(TubeJoining, AnEndThatIsDrawnOutPreventsNoClearJoin) {
  const auto lengths = joined_lengths(
      {straight(0, -0.25, -0.01), straight(0, 0.01, 0.283), straight(0.3, -0.25, 0.25), straight(-0.3, -0.25, 0.25)});
  ASSERT_EQ(lengths.size(), 3u);
  EXPECT_NEAR(lengths.back(), 0.533, 1e-9);
}

TEST_F(TubeJoining, AnEndIsFreeWhereItsBridgeLeads) {
  const auto cost = [&](double y, double free, bool is_of_fragment) {
    const std::vector<TubePiece> pieces = {straight(y, -0.25, -0.01), straight(y, 0.01, 0.25)};
    std::vector<PieceEnd> ends = find_piece_ends(pieces, occlusion(), 0.5);
    ends[1].seen_free = free;  // as where the tube bends at its end
    ends[1].is_of_fragment = is_of_fragment;
    return cost_of_inner_ends(pieces, ends);
  };
  EXPECT_EQ(cost(0.0, 1.0, false), cost(0.0, 0.0, false));  // under the lid
  EXPECT_GT(cost(0.0, 1.0, true), cost(0.0, 0.0, true) + 1.0);
  EXPECT_GT(cost(0.3, 1.0, false), cost(0.3, 0.0, false) + 1.0);  // in the open
}

TEST_F(TubeJoining, EndsThatPassEachOtherAreOneTubes) {
  const auto cost = [&](double y, double overlap) {
    const std::vector<TubePiece> pieces = {straight(0, -0.25, overlap / 2), straight(y, -overlap / 2, 0.25)};
    std::vector<PieceEnd> ends = find_piece_ends(pieces, occlusion(), 0.5);
    for (PieceEnd& end : ends) end.is_on_side = false;  // as where tubes don't branch
    return cost_of_inner_ends(pieces, ends);
  };
  EXPECT_LT(cost(0.0, 1.2 * kRadius), -5.0);
  EXPECT_GT(cost(2.0 * kRadius, 1.2 * kRadius), 0.0);  // side by side
}

TEST_F(TubeJoining, AJoinWithoutAnAlternativeIsSure) {
  const auto joined = join_pieces({straight(0, -0.25, -0.01), straight(0, 0.01, 0.25)}, occlusion(), 0.0).paths;
  ASSERT_EQ(joined.size(), 1u);
  ASSERT_EQ(joined[0].bridge_odds.size(), 1u);
  EXPECT_GT(joined[0].bridge_odds[0], 5.0);
  EXPECT_EQ(joined[0].whole_odds, joined[0].bridge_odds[0]);  // to be taken apart is all that it could be
}

/// Three tubes, nearly in one place, that bend by anything out of sight where they cross: each in two pieces, tube k's are 2 k and
/// 2 k + 1.
std::vector<TubePiece> crossing_tubes(Random& random) {
  std::vector<TubePiece> pieces;
  for (int tube = 0; tube < 3; ++tube) {
    const Vec3 middle(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), -0.015 * tube);
    double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    for (int half = 0; half < 2; ++half) {
      const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
      TubePiece& piece =
          pieces.emplace_back(TubePiece{.nodes = {middle + 0.03 * outward}, .radius = kRadius, .points = {}});
      for (int node = 0; node < 4; ++node) {
        piece.nodes.push_back(piece.nodes.back() + 0.05 * Vec3(std::cos(angle), std::sin(angle), 0.0));
        angle += 0.3 * random.normal();
      }
      angle = std::atan2(-outward.y(), -outward.x()) + 1.2 * random.normal();
    }
  }
  return pieces;
}

TEST_F(TubeJoining, WrongJoinsAreLessSureThanRightOnes) {
  Random random(7);
  const OcclusionTest scan = occlusion();
  std::vector<double> right, wrong;
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<TubePiece> pieces = crossing_tubes(random);
    const auto tube_of = [&](const Vec3& node) {
      return std::ranges::min_element(pieces, {}, [&](const auto& p) { return distance_to_polyline(node, p.nodes); }) -
             pieces.begin();
    };
    for (const TubePath& path : join_pieces(pieces, scan, 0.0).paths)
      for (std::size_t k = 0, bridge = 0; k < path.bridged.size(); ++k)
        if (path.bridged[k])
          (tube_of(path.nodes[k]) / 2 == tube_of(path.nodes[k + 1]) / 2 ? right : wrong)
              .push_back(path.bridge_odds.at(bridge++));
  }
  const auto mean = [](const std::vector<double>& odds) {
    return std::accumulate(odds.begin(), odds.end(), 0.0) / static_cast<double>(odds.size());
  };
  ASSERT_GT(wrong.size(), 10u);
  EXPECT_GT(right.size(), wrong.size());
  EXPECT_GT(mean(right), 2.0 * mean(wrong));
}

TEST(Occlusion, SeesTubesThatHangOverTheWall) {
  const scene::Scene scene = scene_of({tube_along({{0, 0, 0.22}, {0, 0.4, 0.22}})});
  const scan::Scan view = scan::scan(scene, 1);
  const OcclusionTest occlusion(input_of(view.cloud, scene.bin), {view.cloud.world_from_sensor, cloud::Point::Zero()},
                                0.001, kRadius);
  ASSERT_GT(0.3, scene.bin.width / 2.0 + scene.bin.wall_thickness);
  EXPECT_EQ(occlusion.around({0, 0.3, 0.22}, Vec3::UnitY()).surface, 1.0);
  EXPECT_EQ(occlusion.around({0.05, 0.3, 0.22}, Vec3::UnitY()).empty, 1.0);
}

/// A tube that points nearly at the scanner: places 0.4 radii beside its centreline look as those on it do, though the surface
/// there is 1.5 radii nearer or farther along the ray. Those three radii beside it are seen to be empty.
TEST(Occlusion, AllowsForThePlaceOfTubesThatPointAtTheScanner) {
  const Vec3 from(0, 0, 0.05), along = Vec3(std::sin(radians(15.0)), 0, std::cos(radians(15.0)));
  const scene::Scene scene = scene_of({tube_along({from, from + 0.3 * along})});
  const scan::Scan view = scan::scan(scene, 1);
  const OcclusionTest occlusion(input_of(view.cloud, scene.bin), {view.cloud.world_from_sensor, cloud::Point::Zero()},
                                0.001, kRadius);
  const Vec3 center = from + 0.15 * along, across = Vec3::UnitY().cross(along);
  for (const double radii : {-0.4, 0.0, 0.4})
    EXPECT_EQ(occlusion.around(center + radii * kRadius * across, along).empty, 0.0) << radii;
  for (const double radii : {-3.0, 3.0})
    EXPECT_EQ(occlusion.around(center + radii * kRadius * Vec3::UnitY(), along).empty, 1.0) << radii;
}

/// Of a floor seen from 2 m above, a square of 0.1 m is not measured. Then the sensor is rotated, and the picture fills no
/// rectangle; then a slit leads from the square to the borders; then only a cross is measured, as of tubes alone.
TEST(Occlusion, AGapInAPictureMayHideATubeAndOneBetweenTubesAloneDoesNot) {
  std::vector<cloud::Point> floor;
  add_sheet({0, 0, 0}, 0.3, floor);
  std::erase_if(floor, [](const cloud::Point& point) { return point.head<2>().cwiseAbs().maxCoeff() < 0.05f; });
  std::vector<cloud::Point> cut = floor, cross = floor;
  std::erase_if(cut, [](const cloud::Point& point) { return std::abs(point.x()) < 0.01f; });
  std::erase_if(cross, [](const cloud::Point& point) { return point.head<2>().cwiseAbs().minCoeff() > 0.06f; });
  const auto empty_in_gap = [](const std::vector<cloud::Point>& points, double rotation) {
    const Pose world_from_sensor =
        make_pose(Quat(Eigen::AngleAxisd(rotation, Vec3::UnitZ())) * Quat(0, 1, 0, 0), {0, 0, 2});
    const ModelingInput input{.points = points, .world_from_sensor = world_from_sensor, .bin = std::nullopt};
    return OcclusionTest(input, {world_from_sensor, cloud::Point::Zero()}, kSheetSpacing, kRadius)
        .around({0, 0, kRadius}, Vec3::UnitX())
        .empty;
  };
  for (const double rotation : {0.0, 0.6}) {
    EXPECT_EQ(empty_in_gap(floor, rotation), 0.0);
    EXPECT_EQ(empty_in_gap(cut, rotation), 1.0);
    EXPECT_EQ(empty_in_gap(cross, rotation), 1.0);
  }
}

TEST(Occlusion, LeavesOutWhatIsNotFiniteInAnyCoordinate) {
  std::vector<cloud::Point> points;
  add_sheet({0, 0, 0}, 0.1, points);
  for (int axis = 0; axis < 3; ++axis) {
    cloud::Point point = cloud::Point::Zero();
    point[axis] = std::numeric_limits<float>::quiet_NaN();
    points.push_back(point);
  }
  const Pose world_from_sensor = make_pose(Quat(0, 1, 0, 0), {0, 0, 2});
  const ModelingInput input{.points = points, .world_from_sensor = world_from_sensor, .bin = std::nullopt};
  const OcclusionTest occlusion(input, {world_from_sensor, cloud::Point::Zero()}, kSheetSpacing, kRadius);
  EXPECT_EQ(occlusion.around({0, 0, -kRadius}, Vec3::UnitX()).surface, 1.0);
}

}  // namespace
}  // namespace tubebin::modeling
