#include "modeling/input/scan_smoothing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "modeling/built_scene.hpp"
#include "modeling/input/flat_regions.hpp"
#include "modeling/picture.hpp"

namespace tubebin::modeling {
namespace {

SmoothedScan smooth_picture(const std::vector<cloud::Point>& points) {
  const ModelingInput input{.points = points, .world_from_sensor = Pose::Identity(), .bin = {}};
  return smoothed_scan(input, ViewProjection(Pose::Identity(), cloud::Point(0, 0, 1)));
}

bool is_noisy_picture(const std::vector<cloud::Point>& points) {
  const SourceView view = view_from_origin(points);
  return is_noisy(view, FlatBlocks(view));
}

/// Mean and root mean square of `off` over the points that are not within 20 pixels of the picture's edge.
struct Deviation {
  double mean = 0.0, rms = 0.0;

  Deviation(const std::vector<cloud::Point>& points, const std::function<double(const Vec3&)>& off) {
    double count = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t row = i / 400, column = i % 400;
      if (row < 20 || row >= 280 || column < 20 || column >= 380) continue;
      const double value = off(points[i].cast<double>());
      mean += value, rms += value * value, count += 1.0;
    }
    mean /= count, rms = std::sqrt(rms / count);
  }
};

double tilted(double u, double) { return 1.0 / (1.0 - 0.5 * u); }
double off_tilted(const Vec3& p) { return p.z() - 0.5 * p.x() - 1.0; }

class Noise : public ::testing::TestWithParam<double> {};  // spacings

/// Within a ball of 2.5 spacings lie some 20 points, whose mean has a quarter of the noise.
TEST_P(Noise, OfAPlaneIsAQuarterAfterwards) {
  const double noise = GetParam() * kStep;
  const std::vector<cloud::Point> points = picture(tilted, noise);
  EXPECT_TRUE(is_noisy_picture(points));
  const SmoothedScan smoothed = smooth_picture(points);
  const Deviation before(points, off_tilted), after(smoothed.points, off_tilted);
  EXPECT_LT(after.rms, 0.4 * before.rms);
  EXPECT_NEAR(after.mean, 0.0, 0.02 * noise);
  EXPECT_NEAR(smoothed.noise, noise * std::sqrt(0.8), 0.1 * noise);  // across the plane
  EXPECT_FALSE(is_noisy_picture(smoothed.points));
}

INSTANTIATE_TEST_SUITE_P(InSpacings, Noise, ::testing::Values(0.4, 0.8, 2.0));

/// A plane through an arc of half-width w is w^2 / 8 r too flat at its middle: 2.5 spacings of a radius of 12.5, half a percent.
TEST(ScanSmoothing, KeepsATubesRadius) {
  constexpr double kTube = 0.0125;
  const auto points = picture(
      [](double, double v) {
        // The ray (u, v, 1) z meets the cylinder about the line y = 0, z = 1.
        const double a = 1.0 + v * v, root = 1.0 - a * (1.0 - kTube * kTube);
        return root > 0.0 ? (1.0 - std::sqrt(root)) / a : std::numeric_limits<double>::quiet_NaN();
      },
      0.0005);
  double radius = 0.0, count = 0.0;
  for (const cloud::Point& p : smooth_picture(points).points) {
    if (!cloud::is_finite(p) || std::abs(p.y()) > 0.5 * kTube) continue;
    radius += std::hypot(double(p.y()), double(p.z()) - 1.0), count += 1.0;
  }
  EXPECT_NEAR(radius / count, kTube, 0.01 * kTube);
}

TEST(ScanSmoothing, LeavesNoPointInTheAirAtAStep) {
  const double noise = 0.0006;
  const auto depth = [](double u, double) { return u < 0.0 ? 0.98 : 1.0; };
  for (const cloud::Point& p : smooth_picture(picture(depth, noise)).points)
    EXPECT_LT(std::abs(double(p.z()) - depth(p.x(), p.y())), 5.0 * noise);
}

TEST(ScanSmoothing, LeavesAScanOfLittleNoiseAsItIs) {
  const std::vector<cloud::Point> points = picture(tilted, 0.1 * kStep);
  EXPECT_FALSE(is_noisy_picture(points));
  EXPECT_EQ(smooth_picture(points).points, points);
}

TEST(ScanSmoothing, LeavesWhatIsAloneOrNotMeasured) {
  std::vector<cloud::Point> points = picture(tilted, 0.8 * kStep);
  const cloud::Point alone = 0.5f * points[60'200];
  points[60'200] = alone;
  points[100] = cloud::Point::Constant(std::numeric_limits<float>::quiet_NaN());
  const SmoothedScan smoothed = smooth_picture(points);
  EXPECT_EQ(smoothed.points[60'200], alone);
  EXPECT_FALSE(cloud::is_finite(smoothed.points[100]));
  EXPECT_TRUE(std::isfinite(smoothed.noise));
  EXPECT_TRUE(smooth_picture({}).points.empty());
}

/// The second scanner stands beside the first and has no noise.
TEST(ScanSmoothing, MovesThePointsOfANoisyScannerAlone) {
  std::vector<cloud::Point> points = picture(tilted, 0.8 * kStep);
  const std::size_t first = points.size();
  const Pose beside(Eigen::Translation3d(0.3, 0.0, 0.0));
  for (const cloud::Point& p : picture([](double, double) { return 1.0; }, 0.0))
    points.push_back((beside * p.cast<double>()).cast<float>());
  std::vector<std::uint32_t> sources(points.size(), 1);
  std::fill_n(sources.begin(), first, 0U);
  ModelingInput input{.points = points, .world_from_sensor = Pose::Identity(), .bin = {}};
  input.sources = sources;
  input.world_from_further_sensors = {beside};
  const SmoothedScan smoothed = smoothed_scan(input, ViewProjection(Pose::Identity(), cloud::Point(0, 0, 1)));
  for (std::size_t i = first; i < points.size(); ++i) ASSERT_EQ(smoothed.points[i], points[i]);
  EXPECT_LT(Deviation({smoothed.points.begin(), smoothed.points.begin() + std::ptrdiff_t(first)}, off_tilted).rms,
            0.4 * 0.8 * kStep);
}

TEST(ScanSmoothing, ShowsAFloorWhoseNoiseIsAsWideAsTheSpacing) {
  const auto points = smooth_picture(picture([](double, double) { return 1.0; }, 0.8 * kStep)).points;
  const SourceView view = view_from_origin(points);
  const auto regions = find_flat_regions(FlatBlocks(view), view);
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_NEAR(regions[0].plane.offset, -1.0, 1e-4);
  EXPECT_GT(regions[0].area, 0.9 * (400 * kStep) * (300 * kStep));
}

/// Its points lie 1.5 mm apart.
TEST(NoisyScene, IsModelledWithTheBinAndWithout) {
  constexpr double kNoise = 0.001;
  const scene::Scene scene = one_over_three();
  cloud::Cloud cloud = scan::scan(scene).cloud;
  add_range_noise(cloud, kNoise, 5);
  ModelingInput input = input_of(cloud, scene.bin);
  for (const bool tells_bin : {true, false}) {
    if (!tells_bin) input.bin.reset();
    const ModelingResult result = model_tubes(input, {});
    ASSERT_EQ(result.tubes.size(), scene.tubes.size());
    for (const scene::PlacedTube& tube : scene.tubes) {
      const auto off = [&](const TubeModel& model) { return farthest_node(model, tube); };
      EXPECT_LT(std::ranges::min(result.tubes | std::views::transform(off)), 0.6 * kRadius)
          << "bin told: " << tells_bin;
    }
    if (tells_bin) {
      EXPECT_GE(micro_recall_of(result, cloud), 0.97);
    }
    EXPECT_NEAR(result.radius, kRadius, 0.02 * kRadius);
    EXPECT_NEAR(result.noise, kNoise, 0.3 * kNoise);
    EXPECT_NE(describe_found(result).find("mm smoothed"), std::string::npos);
  }
}

}  // namespace
}  // namespace tubebin::modeling
