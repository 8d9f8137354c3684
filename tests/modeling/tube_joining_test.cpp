#include "modeling/joining/tube_joining.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

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
      pieces.push_back(straight(0.1 * double(i) - 0.3, -0.25, -0.25 + lengths[i]));
    return join_pieces(pieces, occlusion(), 0.0).tube_length;
  };
  EXPECT_DOUBLE_EQ(length_of({0.5, 0.5, 0.501, 0.502, 0.35}), 0.501);
  EXPECT_EQ(length_of({0.5, 0.5, 0.55, 0.6, 0.4, 0.35}), 0.0);  // two by chance
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

TEST(Occlusion, SeesTubesThatHangOverTheWall) {
  const scene::Scene scene = scene_of({tube_along({{0, 0, 0.22}, {0, 0.4, 0.22}})});
  const scan::Scan view = scan::scan(scene, 1);
  const OcclusionTest occlusion(input_of(view.cloud, scene.bin), {view.cloud.world_from_sensor, cloud::Point::Zero()},
                                0.001, kRadius);
  ASSERT_GT(0.3, scene.bin.width / 2.0 + scene.bin.wall_thickness);
  EXPECT_EQ(occlusion.around({0, 0.3, 0.22}, Vec3::UnitY()).surface, 1.0);
  EXPECT_EQ(occlusion.around({0.05, 0.3, 0.22}, Vec3::UnitY()).empty, 1.0);
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
