#include "modeling/fitting/radius_refining.hpp"

#include <gtest/gtest.h>

#include "modeling/built_surface.hpp"
#include "modeling/fitting/centerline_pieces.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/fitting/piece_evidence.hpp"

namespace tubebin::modeling {
namespace {

/// The upper half of a tube of kRadius, straight and so many radii long, and what is tested on it.
struct Halftube {
  FilteredCloud cloud;
  ModelingInput input;
  ViewProjection view = view_from_above();

  explicit Halftube(double length)
      : cloud(upper_half_of({Vec3(-0.5 * length * kRadius, 0, 0), Vec3(0.5 * length * kRadius, 0, 0)})) {
    input.points = cloud.points;
    input.world_from_sensor = make_pose(Quat(0, 1, 0, 0), {0, 0, 1});
  }
  OcclusionTest occlusion(double radius) const { return {input, view, cloud.spacing, radius}; }
  double along_curves(double guess) const {
    const auto curves = find_curves(cloud, segment_by_votes(cloud, guess), guess).curves;
    return radius_along(curves, cloud, guess, view, occlusion(guess));
  }
};

TEST(RefinedRadius, IsTheTubesFromGuessesOfATenth) {
  const Halftube tube(20.0);
  for (const double guess : {0.9 * kRadius, kRadius, 1.1 * kRadius}) {
    EXPECT_NEAR(refined_radius(tube.cloud, guess, tube.view, tube.occlusion(guess)), kRadius, 0.01 * kRadius);
    EXPECT_NEAR(tube.along_curves(guess), kRadius, 0.01 * kRadius);
  }
}

TEST(RefinedRadius, IsNoneWhereNothingIsRound) {
  FilteredCloud flat = Halftube(20.0).cloud;
  for (cloud::Point& point : flat.points) point.z() = 0.0f;
  flat.normals.assign(flat.points.size(), cloud::Point::UnitZ());
  const Halftube tube(20.0);
  EXPECT_EQ(refined_radius(flat, kRadius, tube.view, tube.occlusion(kRadius)), 0.0);
}

TEST(RefinedRadius, AlongCurvesIsOfLongPiecesAlone) {
  EXPECT_EQ(Halftube(0.6 * kShort).along_curves(kRadius), 0.0);
  EXPECT_GT(Halftube(1.4 * kShort).along_curves(kRadius), 0.0);
}

}  // namespace
}  // namespace tubebin::modeling
