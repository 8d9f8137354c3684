#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "modeling/built_scene.hpp"
#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/input/bin_pose.hpp"
#include "modeling/input/flat_regions.hpp"
#include "modeling/picture.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

std::vector<FlatRegion> regions_of(const std::vector<cloud::Point>& points) {
  const SourceView view = view_from_origin(points);
  return find_flat_regions(FlatBlocks(view), view);
}

TEST(FlatRegions, FindsATiltedPlaneAndItsNoise) {
  const Vec3 normal = Vec3(0.2, -0.3, -1.0).normalized();
  const double offset = normal.z();  // through (0, 0, 1)
  const auto regions =
      regions_of(picture([&](double u, double v) { return offset / normal.dot(Vec3(u, v, 1.0)); }, 0.0002));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_GT(regions[0].plane.normal.dot(normal), 1.0 - 1e-6);
  EXPECT_NEAR(regions[0].plane.offset, offset, 1e-5);
  EXPECT_NEAR(regions[0].noise, 0.0002 * std::abs(normal.z()), 0.00002);
}

/// Scanners smooth: a pixel's noise is the mean over the 5 by 5 pixels about it.
std::vector<cloud::Point> floor_of_shared_noise(double sigma) {
  constexpr int kColumns = 404, kRows = 304;
  Random random(7);
  std::vector<double> white(static_cast<std::size_t>(kColumns * kRows));
  for (double& value : white) value = 5.0 * sigma * random.normal();
  const auto smoothed = [&](double u, double v) {
    const int column = static_cast<int>(std::lround(u / kStep)) + 200,
              row = static_cast<int>(std::lround(v / kStep)) + 150;
    double sum = 0.0;
    for (int r = row; r < row + 5; ++r)
      for (int c = column; c < column + 5; ++c) sum += white[static_cast<std::size_t>(r * kColumns + c)];
    return sum / 25.0;
  };
  return picture([&](double u, double v) { return 1.0 + smoothed(u, v); }, 0.0);
}

TEST(FlatRegions, NoiseThatNeighborsShareHidesNoFloor) {
  for (const double sigma : {0.4 * kStep, 0.8 * kStep, 1.2 * kStep}) {
    const std::vector<cloud::Point> points = floor_of_shared_noise(sigma);
    const auto regions = regions_of(points);
    ASSERT_EQ(regions.size(), 1u);
    EXPECT_NEAR(regions[0].plane.offset, -1.0, 1e-4);
    EXPECT_GT(regions[0].area, 0.9 * (400 * kStep) * (300 * kStep));
    const auto on_floor =
        std::ranges::count_if(points, [&](const cloud::Point& p) { return regions[0].holds(p.cast<double>(), 0.01); });
    EXPECT_GT(on_floor, 0.99 * static_cast<double>(points.size())) << sigma;
  }
}

/// Ripples that are far longer than a window of blocks: each window is flat, and the whole is by no means as flat.
TEST(FlatRegions, AFloorOfRipplesIsOne) {
  const auto regions = regions_of(
      picture([](double u, double v) { return 1.0 + 0.0004 * std::sin(u / 0.008) * std::sin(v / 0.008); }, 0.00005));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_NEAR(regions[0].plane.offset, -1.0, 1e-4);
  EXPECT_GT(regions[0].area, 0.9 * (400 * kStep) * (300 * kStep));
}

TEST(FlatRegions, AFloorInTwoPartsIsOneAndAStepIsNone) {
  const auto parts = regions_of(picture([](double u, double) { return std::abs(u) < 0.05 ? 0.9 : 1.0; }, 0.0001));
  ASSERT_EQ(parts.size(), 2u);  // the floor on both sides, and the top of what stands on it
  EXPECT_NEAR(parts[0].plane.offset, -1.0, 1e-4);
  EXPECT_NEAR(parts[0].half_extents[0], 0.2, 0.01);
  EXPECT_NEAR(parts[1].plane.offset, -0.9, 1e-4);
}

/// A floor of parallel cylinders: no part of it is flat, however thick they are.
TEST(FlatRegions, TubesOfThreeToFortySpacingsAreNotFlat) {
  for (const double radius : {0.003, 0.0125, 0.025, 0.04}) {
    const auto regions = regions_of(picture(
        [&](double u, double) {
          const double x = std::remainder(u, 2.0 * radius);
          return 1.0 - std::sqrt(std::max(radius * radius - x * x, 0.0));
        },
        0.0001));
    EXPECT_TRUE(regions.empty()) << radius << ": " << regions.size() << " regions";
  }
}

/// A strip of a cylinder's surface, or of its tangent plane, of this half width.
FilteredCloud strip(double radius, double half_width, bool is_flat, double noise) {
  Random random(3);
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = 0.0015};
  for (double along = 0.0; along < 0.1; along += 0.0015)
    for (double across = -half_width; across <= half_width; across += 0.0015) {
      const double height = is_flat ? radius : std::sqrt(radius * radius - across * across);
      cloud.points.push_back(Vec3(along, across, height + noise * random.normal()).cast<float>());
      cloud.normals.push_back(Vec3(0, is_flat ? 0.0 : across, height).normalized().cast<float>());
    }
  return cloud;
}

PieceEvidence evidence_of(const FilteredCloud& cloud, double radius) {
  TubePiece piece{.nodes = {Vec3(-0.001, 0, 0), Vec3(0.101, 0, 0)}, .radius = radius, .points = {}};
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i) piece.points.push_back(i);
  const ModelingInput input{
      .points = cloud.points, .world_from_sensor = Pose(Eigen::Translation3d(0.05, 0.0, 1.0)), .bin = {}};
  const OcclusionTest occlusion(input, ViewProjection(input.world_from_sensor, cloud::Point(0.05f, 0, 0)),
                                cloud.spacing, radius);
  return examine_piece(piece, cloud, occlusion);
}

TEST(PieceEvidence, TellsASideFromAStripOfAPlane) {
  for (const double noise : {0.0001, 0.0003}) {
    const PieceEvidence side = evidence_of(strip(0.0125, 0.006, false, noise), 0.0125);
    EXPECT_NEAR(side.curvature, 1.0, 4.0 * side.curvature_error + 0.02);
    EXPECT_LT(side.curvature_error, 0.1);
    EXPECT_NEAR(side.sigma, noise, 0.2 * noise + 0.00002);
    const PieceEvidence flat = evidence_of(strip(0.0125, 0.006, true, noise), 0.0125);
    EXPECT_NEAR(flat.curvature, 0.0, 4.0 * flat.curvature_error + 0.15);  // to second order in the angle
    EXPECT_FALSE(is_tube(flat, 0.0125, noise));
  }
}

TEST(PieceEvidence, IsNoRougherThanTheNoise) {
  constexpr double kNoise = 0.0006;
  EXPECT_TRUE(is_tube(evidence_of(strip(0.0125, 0.011, false, kNoise), 0.0125), 0.0125, kNoise));
  EXPECT_FALSE(is_tube(evidence_of(strip(0.0125, 0.011, false, 5.0 * kNoise), 0.0125), 0.0125, kNoise));
}

TEST(PieceEvidence, KnowsARadiusFromAnother) {
  const PieceEvidence thicker = evidence_of(strip(0.016, 0.009, false, 0.0001), 0.0125);
  EXPECT_NEAR(thicker.curvature, 0.0125 / 0.016, 0.1);
  EXPECT_FALSE(is_tube(thicker, 0.0125, 0.0001));
}

TEST(Surroundings, PointsThatLieAloneMakeTheOthersSeemNoFartherApart) {
  const scene::Scene scene = scene_of({tube_along({{-0.15, -0.05, kRadius}, {0.15, -0.05, kRadius}}),
                                       tube_along({{-0.15, 0.05, kRadius}, {0.15, 0.05, kRadius}})});
  cloud::Cloud cloud = scan::scan(scene).cloud;
  const auto model = [&] {
    ModelingInput input;
    input.points = cloud.points;
    input.world_from_sensor = cloud.world_from_sensor;
    return model_tubes(input, known_radius());
  };
  const double spacing = model().spacing;
  Random random(3);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.labels[i] == 0 && random.uniform(0.0, 1.0) < 0.03)
      cloud.points[i].z() += static_cast<float>(random.uniform(0.01, 0.05));
  const ModelingResult result = model();
  EXPECT_LT(result.spacing, 1.2 * spacing);
  EXPECT_EQ(result.tubes.size(), 2u);
}

TEST(Surroundings, APlaceThatManyPixelsShareWasNotMeasured) {
  const cloud::Cloud seen = scan::scan(scene_of({tube_along({{-0.15, -0.05, kRadius}, {0.15, 0.05, kRadius}})})).cloud;
  const auto labels_with = [&](const cloud::Point& unmeasured) {
    std::vector<cloud::Point> points = seen.points;
    for (std::size_t i = 0; i < points.size(); i += 8) points[i] = unmeasured;
    ModelingOptions options = known_radius();
    options.label_all = true;
    const ModelingResult result =
        model_tubes({.points = points, .world_from_sensor = seen.world_from_sensor, .bin = {}}, options);
    EXPECT_EQ(result.tubes.size(), 1u);
    return result.all_labels;
  };
  const auto expected = labels_with(cloud::Point::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(labels_with(cloud::Point::Zero()), expected);
  EXPECT_EQ(labels_with({0.0f, 0.0f, -1000.0f}), expected);
  EXPECT_EQ(labels_with({0.1f, 0.02f, 0.3f}), expected);
}

/// Round ribs half as thick as the tubes, of which the floor covers the lower part.
TEST(Surroundings, RibsOfAFloorAreNoTubes) {
  constexpr double kRib = kRadius / 2.0;
  std::vector<scene::PlacedTube> all;
  for (const double y : {-0.09, 0.01, 0.11}) {
    all.push_back(tube_along({{-0.2, y, kRib / 2.0}, {0.2, y, kRib / 2.0}}));
    all.back().tube.radius = kRib;
  }
  const auto radii = [&] {
    const cloud::Cloud cloud = scan::scan(scene_of(all)).cloud;
    return model_tubes({.points = cloud.points, .world_from_sensor = cloud.world_from_sensor, .bin = {}}, {}).radii;
  };
  EXPECT_TRUE(radii().empty());
  const double high = 1.5 * kRib + kRadius;
  all.push_back(tube_along({{-0.1, -0.12, high}, {-0.05, 0.12, high}}));
  all.push_back(tube_along({{0.1, -0.12, high}, {0.05, 0.12, high}}));
  const std::vector<double> found = radii();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found.front(), kRadius, 0.0001);
}

/// Floor and two walls of a bin that stands elsewhere than it is said to.
TEST(BinPose, IsRefinedByFloorAndWalls) {
  ModelingInput input;
  input.bin.emplace();
  Pose truth = Pose::Identity();
  truth.linear() = Eigen::AngleAxisd(0.017, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  truth.translation() = Vec3(0.010, -0.006, 0.004);
  const auto region = [&](const Vec3& normal, const Vec3& center, double half_u, double half_v) {
    FlatRegion flat;
    flat.plane.normal = truth.linear() * normal;
    flat.center = truth * center;
    flat.plane.offset = flat.plane.normal.dot(flat.center);
    flat.axes[0] = truth.linear() * normal.unitOrthogonal();
    flat.axes[1] = flat.plane.normal.cross(flat.axes[0]);
    flat.half_extents[0] = half_u, flat.half_extents[1] = half_v;
    return flat;
  };
  const double x = input.bin->length / 2.0, y = input.bin->width / 2.0;
  std::vector<FlatRegion> regions = {region(Vec3::UnitZ(), Vec3(0, 0, 0), 0.15, 0.15),
                                     region(Vec3::UnitX(), Vec3(-x, 0, 0.1), 0.05, 0.05),
                                     region(-Vec3::UnitY(), Vec3(0, y, 0.1), 0.05, 0.05)};
  const auto pose = refined_bin_pose(input, regions);
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT((pose->translation() - truth.translation()).norm(), 1e-5);
  EXPECT_LT((pose->linear() - truth.linear()).norm(), 1e-4);

  // Without the wall's region, its points put the bin there as well; not those of something that lies before it.
  const std::vector<FlatRegion> without = {regions[0], regions[2]};
  std::vector<cloud::Point> points;
  for (const bool is_wall : {true, false}) {
    points.clear();
    for (double along = -0.1; along < 0.1; along += 0.002)
      for (double up = 0.02; up < 0.15; up += 0.01)
        points.push_back((truth * Vec3(is_wall ? -x : -x + 0.01 * std::cos(100.0 * along), along, up)).cast<float>());
    input.points = points;
    const auto by_layer = refined_bin_pose(input, without);
    ASSERT_TRUE(by_layer.has_value());
    const double off = (by_layer->translation() - truth.translation()).norm();
    if (is_wall) EXPECT_LT(off, 1e-3);
    else EXPECT_GT(off, 5e-3);
  }
  for (FlatRegion& moved : regions)
    moved.center += Vec3(1, 0, 1), moved.plane.offset = moved.plane.normal.dot(moved.center);
  EXPECT_FALSE(refined_bin_pose(input, regions).has_value());  // that is another bin
}

}  // namespace
}  // namespace tubebin::modeling
