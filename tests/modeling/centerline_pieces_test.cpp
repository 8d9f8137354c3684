#include "modeling/fitting/centerline_pieces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "modeling/built_surface.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/input/normals.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

/// A tube over another one, whose middle it hides, scanned.
struct Bridge {
  std::vector<Vec3> lower = {{-0.2, 0, kRadius}, {0.2, 0.02, kRadius}},
                    upper = {{0, -0.15, 3 * kRadius}, {0.03, 0, 3 * kRadius}, {0, 0.15, 3 * kRadius}};
  cloud::Cloud scanned = scan::scan(scene_of({tube_along(lower), tube_along(upper)})).cloud;
  ModelingInput input = input_of(scanned, scene::Bin{});
  ViewProjection view = view_of(input);
  FilteredCloud cloud = filter(input, view, crop_bin(input, {}), {}, 1);

  Bridge() { add_normals(cloud, view, kRadius); }

  /// Whether each piece lies on a tube and each tube but what is hidden of it is in a piece.
  void expect_found(const std::vector<TubePiece>& pieces) const {
    ASSERT_EQ(pieces.size(), 3u);
    std::vector<double> lengths;
    for (const TubePiece& piece : pieces) {
      const bool is_upper = distance_to_polyline(piece.nodes.front(), upper) < kRadius;
      for (const Vec3& node : piece.nodes)
        EXPECT_LT(distance_to_polyline(node, is_upper ? upper : lower), 0.15 * kRadius);
      EXPECT_LT(is_upper ? distance_between(piece.nodes, upper) : 0.0, 0.15 * kRadius);
      lengths.push_back(piece.length());
    }
    std::ranges::sort(lengths);
    const double hidden = polyline_length(lower) - lengths[0] - lengths[1];
    EXPECT_GT(hidden, kRadius);
    EXPECT_LT(hidden, 3.0 * kRadius);
  }
};

std::vector<TubePiece> pieces_of(
    const Bridge& scene, const std::vector<Segment>& segments,
    const std::function<void(std::vector<VoteCurve>&)>& leave_out = [](const auto&) {}) {
  return find_centerline_pieces(scene.cloud, find_curves(scene.cloud, segments, kRadius), scene.view, kRadius,
                                leave_out);
}

TEST(CenterlinePieces, AreTheTubesBetweenOcclusions) {
  const Bridge scene;
  scene.expect_found(pieces_of(scene, segment_by_votes(scene.cloud, kRadius)));
}

TEST(CenterlinePieces, TheSecondRoundFindsWhatTheFirstWasNotGiven) {
  const Bridge scene;
  std::vector<Segment> segments = segment_by_votes(scene.cloud, kRadius);
  const auto is_upper = [&](const Segment& segment) { return scene.cloud.points[segment[0]].z() > 2.1f * kRadius; };
  ASSERT_EQ(std::erase_if(segments, is_upper), 1u);
  const std::vector<TubePiece> pieces = pieces_of(scene, segments);
  scene.expect_found(pieces);
  std::vector<int> holders(scene.cloud.points.size(), 0);  // the second round numbers the points anew
  for (const TubePiece& piece : pieces)
    for (const std::uint32_t i : piece.points) {
      ++holders[i];
      EXPECT_LT(distance_to_polyline(scene.cloud.points[i].cast<double>(), piece.nodes), 1.5 * kRadius);
    }
  EXPECT_LE(*std::ranges::max_element(holders), 1);
}

TEST(CenterlinePieces, TheSecondRoundLeavesOutWhatItIsAskedTo) {
  const Bridge scene;
  std::size_t curves = 0;
  const std::vector<TubePiece> pieces = pieces_of(scene, {}, [&](std::vector<VoteCurve>& further) {
    curves = further.size();
    further.clear();
  });
  EXPECT_GE(curves, 3u);
  EXPECT_TRUE(pieces.empty());
}

}  // namespace
}  // namespace tubebin::modeling
