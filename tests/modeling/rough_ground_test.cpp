/// Ground that is not flat, and what of it is taken for tube.
#include "modeling/fitting/rough_ground.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "modeling/built_surface.hpp"
#include "modeling/fitting/loose_points.hpp"
#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/fitting/vote_sheets.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kSpacing = 0.001;  // metres

/// Points of the surface z(x, y) over 0.24 x 0.24 m, as seen from above.
FilteredCloud ground(const std::function<double(double, double)>& height) {
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = kSpacing};
  for (double x = -0.12; x < 0.12; x += kSpacing)
    for (double y = -0.12; y < 0.12; y += kSpacing) {
      constexpr double kStep = 1e-5;
      const double slope_x = (height(x + kStep, y) - height(x - kStep, y)) / (2.0 * kStep);
      const double slope_y = (height(x, y + kStep) - height(x, y - kStep)) / (2.0 * kStep);
      cloud.points.push_back(Vec3(x, y, height(x, y)).cast<float>());
      cloud.normals.push_back(Vec3(-slope_x, -slope_y, 1.0).normalized().cast<float>());
    }
  cloud.source.resize(cloud.points.size());
  std::iota(cloud.source.begin(), cloud.source.end(), 0U);
  return cloud;
}

void append(FilteredCloud& cloud, const FilteredCloud& other) {
  cloud.points.insert(cloud.points.end(), other.points.begin(), other.points.end());
  cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  cloud.source.resize(cloud.points.size());
  std::iota(cloud.source.begin(), cloud.source.end(), 0U);
}

/// Waves a tenth as curved as a tube.
double cloth(double x, double y) { return -0.05 + 0.01 * std::sin(x / 0.03) * std::cos(y / 0.03); }

TEST(WithoutSheets, LeavesTubesAndTakesTheClothBelowThem) {
  FilteredCloud cloud = ground(cloth);
  const std::size_t on_cloth = cloud.points.size();
  append(cloud, upper_half_of({{-0.1, -0.02, 0.0}, {0.02, 0.03, 0.0}, {0.1, 0.03, 0.0}}));
  const FilteredCloud kept = without_sheets(cloud, kRadius);
  const auto of_cloth = std::ranges::count_if(kept.source, [&](std::uint32_t i) { return i < on_cloth; });
  // At its border the votes lie in a line.
  EXPECT_LT(static_cast<double>(of_cloth), 0.15 * static_cast<double>(on_cloth));
  EXPECT_EQ(kept.points.size() - static_cast<std::size_t>(of_cloth), cloud.points.size() - on_cloth);
  for (std::size_t k = 0; k < kept.source.size(); ++k) EXPECT_EQ(kept.points[k], cloud.points[kept.source[k]]);
}

TEST(WithoutSheets, LeavesWhatIsNarrow) {
  FilteredCloud strip = ground(cloth);
  std::erase_if(strip.points, [](const cloud::Point& p) { return std::abs(p.y()) > 2.0 * kRadius; });
  strip.normals.assign(strip.points.size(), cloud::Point::UnitZ());
  strip.source.resize(strip.points.size());
  EXPECT_EQ(without_sheets(strip, kRadius).points.size(), strip.points.size());
}

TEST(LoosePoints, AreAllThatNoSegmentHoldsWithinTheReach) {
  Random random(4);
  FilteredCloud cloud;
  for (int k = 0; k < 2000; ++k) {
    cloud.points.push_back(
        Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-0.1, 0.1)).cast<float>());
    cloud.normals.push_back(cloud::Point::UnitZ());
  }
  Segment held;
  for (std::uint32_t i = 0; i < 2000; i += 3) held.push_back(i);
  constexpr double kReach = 0.15;
  const LoosePoints loose(cloud, {held}, kReach);
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(-0.99, 0.4, 0.05), Vec3(0.3, -1.2, 0), Vec3(0.1501, 0.1499, 0)}) {
    std::size_t expected = 0, found = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      expected += i % 3 != 0 && (cloud.points[i].cast<double>() - place).norm() < kReach;
    loose.for_each_about(place, [&](const SurfacePoint& point) { found += (point.position - place).norm() < kReach; });
    EXPECT_EQ(found, expected) << place.transpose();
  }
}

TEST(LoosePoints, AreNoneWithoutACloudOrFarAway) {
  std::size_t found = 0;
  LoosePoints().for_each_about(Vec3(0.1, 0.2, 0.3), [&](const SurfacePoint&) { ++found; });
  FilteredCloud cloud;
  cloud.points.push_back(cloud::Point::Zero());
  cloud.normals.push_back(cloud::Point::UnitZ());
  LoosePoints(cloud, {}, 1e-3).for_each_about(Vec3(0.0, 1e30, 0.0), [&](const SurfacePoint&) { ++found; });
  EXPECT_EQ(found, 0u);
}

OcclusionTest occlusion_of(const FilteredCloud& cloud) {
  const ModelingInput input{
      .points = cloud.points, .world_from_sensor = make_pose(Quat(0, 1, 0, 0), {0, 0, 1}), .bin = {}};
  return {input, view_from_above(), kSpacing, kRadius};
}

/// Of a piece along the x axis at the top of such ground, to so far across.
PieceEvidence evidence_on(const std::function<double(double)>& height, double half_width) {
  const FilteredCloud cloud = ground([&](double, double y) { return height(y); });
  TubePiece piece{.nodes = {{-0.09, 0, 0}, {0.09, 0, 0}}, .radius = kRadius, .points = {}};
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i)
    if (std::abs(cloud.points[i].y()) < half_width) piece.points.push_back(i);
  return examine_piece(piece, cloud, occlusion_of(cloud));
}

double round(double y) { return std::sqrt(std::max(kRadius * kRadius - y * y, 0.0)); }

TEST(Outline, OfATubeOnATableIsAnEdge) {
  const PieceEvidence tube = evidence_on([](double y) { return std::abs(y) < kRadius ? round(y) : -kRadius; }, kRadius);
  EXPECT_GT(tube.outline.edge, 0.95);
  EXPECT_LT(tube.outline.flat, 0.05);
  EXPECT_FALSE(goes_on_beside(tube.outline));
}

/// A ripple as curved at its crest as a tube.
TEST(Outline, OfARippleIsNone) {
  constexpr double kWave = 0.3 * kRadius;
  const PieceEvidence ripple =
      evidence_on([](double y) { return kRadius - kWave * kWave / kRadius * (1.0 - std::cos(y / kWave)); }, kWave);
  EXPECT_LT(ripple.outline.edge, 0.05);
  EXPECT_GT(ripple.outline.flat, 0.95);
  EXPECT_TRUE(goes_on_beside(ripple.outline));
}

/// Others in a row hide both sides, and nothing of the flanks.
TEST(Outline, OfATubeInARowIsUnknown) {
  const PieceEvidence tube = evidence_on([](double y) { return round(std::remainder(y, 2.0 * kRadius)); }, kRadius);
  EXPECT_LT(tube.outline.edge, 0.05);
  EXPECT_LT(tube.outline.flat, 0.05);
  EXPECT_FALSE(goes_on_beside(tube.outline));
}

/// Of `count` points, all on one.
VoteCurve curve_of(std::size_t count) {
  return {.points = Segment(count, 0), .surface = {}, .votes = {}, .samples = {}};
}

TEST(RoughGround, IsWhatHasManyPointsMostOfThemOnNoTubesCurve) {
  const std::vector<VoteCurve> curves = {curve_of(20'000), curve_of(10'000), curve_of(15'000)};
  EXPECT_TRUE(is_rough(curves, {true, false, true}, 60'000));
  EXPECT_FALSE(is_rough(curves, {true, false, false}, 60'000));
  EXPECT_FALSE(is_rough(curves, {true, false, true}, 45'000));  // as few as a pile of rods has
  EXPECT_TRUE(is_rough({}, {}, 60'000));
}

/// A ripple of the ground along the x axis, and a tube on it that lies across.
TEST(RoughGround, LosesItsCurvesAndKeepsThoseOfTubes) {
  constexpr double kWave = 0.3 * kRadius, kTubeAt = 0.05;
  const FilteredCloud cloud = ground([](double x, double y) {
    const double ripple = kWave * kWave / kRadius * (std::cos(y / kWave) - 1.0);
    return std::abs(x - kTubeAt) < kRadius ? kRadius + round(x - kTubeAt) : ripple;
  });
  const auto along = [](const Vec3& from, const Vec3& to) {
    VoteCurve curve = curve_of(1);
    for (double t = 0.0; t < 1.0; t += 0.05) curve.samples.push_back(from + t * (to - from));
    return curve;
  };
  std::vector<VoteCurve> curves = {along({-0.1, 0, -kRadius}, {0.02, 0, -kRadius}),
                                   along({kTubeAt, -0.1, kRadius}, {kTubeAt, 0.1, kRadius})};
  const std::vector<char> is_ground = find_ground(curves, kRadius, occlusion_of(cloud));
  EXPECT_EQ(is_ground, (std::vector<char>{true, false}));
  drop_ground(curves, is_ground);
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_NEAR(curves[0].samples.front().x(), kTubeAt, 1e-12);
}

/// What a scanner at the origin measures that looks along z: two tubes that cross a metre away, the lower one of such a radius,
/// over crumpled ground.
struct TubesOnCrumpledGround {
  static constexpr int kColumns = 640, kRows = 480;
  static constexpr double kPixel = 0.0009;  // radians

  std::vector<cloud::Point> points;
  std::vector<int> labels;

  explicit TubesOnCrumpledGround(double lower_radius) {
    constexpr double kUpperAxis = 0.95, kApart = 0.001;
    const double lower_axis = kUpperAxis + kRadius + lower_radius + kApart;
    Random random(5);
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        const double u = (column - kColumns / 2) * kPixel, v = (row - kRows / 2) * kPixel;
        const double upper = depth_of_tube(v, kUpperAxis, kRadius), lower = depth_of_tube(u, lower_axis, lower_radius);
        const double rough = ground_below(u, v);
        const bool on_upper = upper < rough && std::abs(u) < 0.15, on_lower = lower < rough && std::abs(v) < 0.14;
        labels.push_back(on_upper ? 1 : on_lower ? 2 : 0);
        const double depth = on_upper ? upper : on_lower ? lower : rough;
        points.push_back((Vec3(u, v, 1.0) * (depth + 0.0001 * random.normal())).cast<float>());
      }
  }

  /// Of a ray at this angle across a tube whose axis is so far away; infinite beside it.
  static double depth_of_tube(double across, double axis, double radius) {
    const double a = 1.0 + across * across, root = axis * axis - a * (axis * axis - radius * radius);
    return root > 0.0 ? (axis - std::sqrt(root)) / a : std::numeric_limits<double>::infinity();
  }
  /// Crumpled: folds in many directions, five to sixteen centimetres apart, as curved as tubes here and there.
  static double ground_below(double u, double v) {
    constexpr int kFolds = 12;
    double height = 0.0;
    for (int k = 0; k < kFolds; ++k) {
      const double turns = 20.0 + 40.0 * k / (kFolds - 1);  // radians a metre
      const double along = u * std::cos(2.4 * k) + v * std::sin(2.4 * k);
      height += 0.58 / turns * (std::abs(std::sin(turns * along + 1.7 * k * k)) - 2.0 / std::numbers::pi);
    }
    return 1.0 - height;
  }
};

class TubesOfTwoRadii : public ::testing::TestWithParam<double> {};

TEST_P(TubesOfTwoRadii, AreFoundOnCrumpledGroundWhichIsNoTube) {
  const double second = GetParam();
  const TubesOnCrumpledGround scene(second);
  ModelingInput input;
  input.points = scene.points;
  const ModelingResult result = model_tubes(input, {});
  ASSERT_EQ(result.tubes.size(), 2u);
  for (const double radius : {kRadius, second})
    EXPECT_TRUE(std::ranges::any_of(result.radii, [&](double found) { return std::abs(found / radius - 1.0) < 0.03; }))
        << radius;
  std::size_t right = 0, wrong = 0;
  for (std::size_t k = 0; k < result.source.size(); ++k) {
    if (result.labels[k] == 0) continue;
    (scene.labels[result.source[k]] > 0 ? right : wrong) += 1;
  }
  const auto on_tubes = std::ranges::count_if(scene.labels, [](int label) { return label > 0; });
  EXPECT_GT(static_cast<double>(right), 0.99 * static_cast<double>(on_tubes));
  EXPECT_LT(static_cast<double>(wrong), 0.01 * static_cast<double>(on_tubes));
}

TEST(CrumpledGround, ByItselfShowsNoTube) {
  const TubesOnCrumpledGround scene(kRadius);
  std::vector<cloud::Point> ground;
  for (std::size_t k = 0; k < scene.points.size(); ++k)
    if (scene.labels[k] == 0) ground.push_back(scene.points[k]);
  ModelingInput input;
  input.points = ground;
  const ModelingResult result = model_tubes(input, {});
  EXPECT_TRUE(result.tubes.empty());
  EXPECT_FALSE(result.found.doubts.empty());
}

INSTANTIATE_TEST_SUITE_P(CrumpledGround, TubesOfTwoRadii, ::testing::Values(kRadius, 0.6 * kRadius));

}  // namespace
}  // namespace tubebin::modeling
