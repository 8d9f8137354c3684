#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scan/random_scene.hpp"
#include "scan/same_points.hpp"
#include "scan/signed_distance.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {
namespace {

using testing::look_closely;
using testing::random_scene;
using testing::SphereTracer;

/// An empty bin, so wide that the image shows its floor alone, `distance` below the scanner.
scene::Scene floor_scene(double distance) {
  scene::Scene scene;
  scene.bin.length = scene.bin.width = 40.0;
  scene.scanner.position.z() = distance;
  scene.scanner.range_max = 20.0;
  scene.scanner.width = 240;
  scene.scanner.height = 200;
  scene.scanner.horizontal_fov_deg = 4.0;
  scene.scanner.region = scene::ScanRegion::full;
  return scene;
}

double depth_of(const scene::Scene& scene, const cloud::Point& point) {
  return (scene.scanner.world_from_scanner().inverse() * point.cast<double>()).z();
}

/// Depths minus those of the noise-free twin, of pixels that have both.
std::vector<double> depth_errors(const scene::Scene& scene, std::uint64_t seed) {
  const cloud::Cloud measured = scan(scene, seed).cloud, exact = scan_exactly_from_all(scene).cloud;
  std::vector<double> errors;
  for (std::size_t i = 0; i < exact.size(); ++i)
    if (cloud::is_finite(measured.points[i]) && cloud::is_finite(exact.points[i]))
      errors.push_back(depth_of(scene, measured.points[i]) - depth_of(scene, exact.points[i]));
  return errors;
}

double standard_deviation(const std::vector<double>& values) {
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

std::size_t finite_points(const cloud::Cloud& cloud) {
  return static_cast<std::size_t>(std::ranges::count_if(cloud.points, cloud::is_finite));
}

bool same_bytes(const cloud::Cloud& a, const cloud::Cloud& b) {
  return testing::same_points(a, b) && a.labels == b.labels && a.colors == b.colors;
}

scene::ScannerEffects all_effects() {
  scene::ScannerEffects effects;
  effects.reference_distance = 2.0;
  effects.range_noise = {.sigma = 3e-4, .incidence_gain = 0.05, .correlation_length = 2.0};
  effects.lateral_noise = 0.2;
  effects.quantization = 1e-4;
  effects.projector.enabled = true;
  effects.dropouts.signal_min = 0.1;
  effects.dropouts.signal_spread = 0.2;
  effects.dropouts.tube_glare_angle_deg = 1.0;
  effects.mixed_pixels.share = 0.5;
  effects.outliers.share = 0.01;
  effects.calibration = {.position = {1e-3, 0, 0}, .rotation_deg = {0, 0.1, 0}, .focal = 1e-3};
  return effects;
}

TEST(ScannerEffects, AllOffIsTheExactScanWhateverTheSeed) {
  const scene::Scene scene = random_scene(8, 1);
  EXPECT_FALSE(scene.scanner.effects.any());
  EXPECT_TRUE(same_bytes(scan(scene, 1).cloud, scan(scene, 2).cloud));
  scene::Scene noisy = scene;
  noisy.scanner.effects = all_effects();
  EXPECT_TRUE(same_bytes(scan_exactly_from_all(noisy).cloud, scan(scene).cloud));
}

/// With an effect too small to change a float the measuring path gives what the exact one does.
TEST(ScannerEffects, TheMeasuringPathIsTheExactOneInTheLimit) {
  scene::Scene scene = random_scene(8, 2);
  look_closely(scene.scanner, 240, 150);
  scene.scanner.effects.range_noise.sigma = 1e-15;
  const cloud::Cloud measured = scan(scene, 5).cloud, exact = scan_exactly_from_all(scene).cloud;
  ASSERT_EQ(measured.labels, exact.labels);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_EQ(cloud::is_finite(measured.points[i]), cloud::is_finite(exact.points[i]));
    if (cloud::is_finite(exact.points[i])) {
      ASSERT_LT((measured.points[i] - exact.points[i]).norm(), 1e-6F);
    }
  }
}

TEST(ScannerEffects, SeedDecidesAllAndRegionsAgree) {
  scene::Scene scene = random_scene(6, 3);
  look_closely(scene.scanner, 240, 150);
  scene.scanner.effects = all_effects();
  const Scan bin = scan(scene, 7);
  EXPECT_TRUE(same_bytes(bin.cloud, scan(scene, 7).cloud));
  EXPECT_FALSE(same_bytes(bin.cloud, scan(scene, 8).cloud));
  scene.scanner.region = scene::ScanRegion::full;
  const Scan full = scan(scene, 7);
  EXPECT_EQ(full.tube_pixels, bin.tube_pixels);
  for (int row = 0; row < bin.window.height; ++row) {
    for (int column = 0; column < bin.window.width; ++column) {
      const auto i = static_cast<std::size_t>(row * bin.window.width + column);
      const auto j = static_cast<std::size_t>((row + bin.window.y) * 240 + column + bin.window.x);
      ASSERT_EQ(bin.cloud.labels[i], full.cloud.labels[j]);
      ASSERT_TRUE(bin.cloud.points[i] == full.cloud.points[j] || !cloud::is_finite(bin.cloud.points[i]));
    }
  }
  std::vector<std::size_t> counts(7, 0);
  for (std::size_t i = 0; i < bin.cloud.size(); ++i)
    if (cloud::is_finite(bin.cloud.points[i])) ++counts[bin.cloud.labels[i]];
  for (std::size_t k = 1; k < counts.size(); ++k) EXPECT_EQ(counts[k], bin.tube_pixels[k - 1]);
}

TEST(ScannerEffects, RangeNoiseGrowsWithTheSquareOfTheDepth) {
  for (const double distance : {0.5, 1.0, 2.0, 4.0}) {
    scene::Scene scene = floor_scene(distance);
    scene.scanner.effects.range_noise.sigma = 1e-3;
    scene.scanner.effects.range_noise.incidence_gain = 0.05;  // of no effect head-on
    const double expected = 1e-3 * distance * distance;
    // 48000 samples estimate it to 0.33 percent (one standard deviation).
    EXPECT_NEAR(standard_deviation(depth_errors(scene, 11)), expected, 0.015 * expected) << distance << " m";
  }
}

TEST(ScannerEffects, RangeNoiseGrowsWithTheIncidenceAngle) {
  for (const double angle_deg : {30.0, 60.0, 75.0}) {
    scene::Scene scene = floor_scene(1.0);
    scene.scanner.horizontal_fov_deg = 0.2;
    scene.scanner.rotation_deg.y() = angle_deg;  // the axis meets the floor at this angle from its normal
    scene.scanner.effects.range_noise.sigma = 1e-4;
    scene.scanner.effects.range_noise.incidence_gain = 0.5;
    const double depth = 1.0 / std::cos(radians(angle_deg));
    const double ratio = angle_deg / (90.0 - angle_deg);
    const double expected = 1e-4 * depth * depth * (1.0 + 0.5 * ratio * ratio);
    EXPECT_NEAR(standard_deviation(depth_errors(scene, 12)), expected, 0.03 * expected) << angle_deg << " degrees";
  }
}

TEST(ScannerEffects, RangeNoiseIsCorrelatedBetweenNeighbours) {
  constexpr double kLength = 3.0;
  scene::Scene scene = floor_scene(1.0);
  scene.scanner.effects.range_noise.sigma = 1e-3;
  scene.scanner.effects.range_noise.correlation_length = kLength;
  const std::vector<double> errors = depth_errors(scene, 13);
  ASSERT_EQ(errors.size(), 240u * 200u);
  const double variance = standard_deviation(errors) * standard_deviation(errors);
  EXPECT_NEAR(variance, 1e-6, 0.1e-6);
  const auto correlation = [&](std::size_t right, std::size_t down) {
    double sum = 0.0;
    for (std::size_t row = 0; row + down < 200; ++row)
      for (std::size_t column = 0; column + right < 240; ++column)
        sum += errors[row * 240 + column] * errors[(row + down) * 240 + column + right];
    return sum / static_cast<double>((200 - down) * (240 - right)) / variance;
  };
  for (const std::size_t lag : {1u, 2u, 3u, 5u, 12u}) {
    const double expected = std::exp(-static_cast<double>(lag * lag) / (kLength * kLength));
    EXPECT_NEAR(correlation(lag, 0), expected, 0.05) << lag;
    EXPECT_NEAR(correlation(0, lag), expected, 0.05) << lag;
  }
  EXPECT_NEAR(correlation(2, 2), std::exp(-8.0 / 9.0), 0.05);
}

/// On a plane that the view meets at an angle, looking beside the pixel changes the depth by its slope.
TEST(ScannerEffects, LateralNoiseMovesWhereAPixelLooks) {
  scene::Scene scene = floor_scene(1.0);
  scene.scanner.horizontal_fov_deg = 1.0;
  scene.scanner.rotation_deg.y() = 45.0;
  scene.scanner.effects.lateral_noise = 0.5;
  const double depth = 1.0 / std::cos(radians(45.0));
  const double expected = 0.5 * depth / scene::Camera(scene.scanner).focal_length();  // times tan(45 degrees)
  EXPECT_NEAR(standard_deviation(depth_errors(scene, 14)), expected, 0.03 * expected);
}

TEST(ScannerEffects, QuantizationStepIsEvenInDisparity) {
  scene::Scene scene = random_scene(5, 4);
  look_closely(scene.scanner, 240, 150);
  scene.scanner.effects.reference_distance = 1.5;
  scene.scanner.effects.quantization = 1e-3;
  const cloud::Cloud cloud = scan(scene, 15).cloud;
  std::size_t checked = 0;
  for (const cloud::Point& point : cloud.points) {
    if (!cloud::is_finite(point)) continue;
    const double steps = 1.5 * 1.5 / (1e-3 * depth_of(scene, point));
    ASSERT_NEAR(steps, std::round(steps), 1e-3);
    ++checked;
  }
  EXPECT_GT(checked, 10000u);
  for (const double error : depth_errors(scene, 15)) ASSERT_LT(std::abs(error), 0.51e-3 * 2.05 * 2.05 / (1.5 * 1.5));
}

/// Lit by brute force: a sphere tracing scanner at the projector looks at every point.
TEST(ScannerEffects, ShadowIsWhereTheProjectorSeesSomethingElse) {
  scene::Scene scene = random_scene(8, 5);
  look_closely(scene.scanner, 160, 100);
  scene.scanner.rotation_deg = {3.0, -4.0, 20.0};
  scene::ProjectorOptions& projector = scene.scanner.effects.projector;
  projector = {.enabled = true, .position = {0.6, 0.1, 0.05}, .horizontal_fov_deg = 12.0, .vertical_fov_deg = 8.0};
  const cloud::Cloud lit = scan(scene, 16).cloud, exact = scan_exactly_from_all(scene).cloud;
  scene::Scene from_projector = scene;
  from_projector.scanner.position = scene.scanner.world_from_scanner() * projector.position;
  const Vec3 focus = scene.scanner.world_from_scanner() * Vec3(0, 0, projector.focus_distance);
  const Vec3 axis = (focus - from_projector.scanner.position).normalized();
  const SphereTracer tracer(from_projector);
  int in_shadow = 0, out_of_field = 0, bright = 0, wrong = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (!cloud::is_finite(exact.points[i])) continue;
    const Vec3 ray = exact.points[i].cast<double>() - from_projector.scanner.position;
    const double off_axis_deg = degrees(std::acos(ray.normalized().dot(axis)));
    // Beyond the field's corners for sure, or within its narrower half; in between its shape decides.
    const auto traced = tracer.trace(ray);
    const double miss = traced.found ? (traced.point - exact.points[i].cast<double>()).norm() : 1.0;
    if (off_axis_deg > 7.3) {
      ++out_of_field;
      wrong += cloud::is_finite(lit.points[i]);
    } else if (off_axis_deg < 3.9 && miss > 1e-2) {
      ++in_shadow;
      wrong += cloud::is_finite(lit.points[i]);
    } else if (off_axis_deg < 3.9 && miss < 1e-4) {
      ++bright;
      wrong += !cloud::is_finite(lit.points[i]);
    }
  }
  EXPECT_GT(in_shadow, 300);
  EXPECT_GT(out_of_field, 300);
  EXPECT_GT(bright, 1500);
  // Float32 points, and a tracer that stops short of grazed surfaces, leave a few on shadows' rims.
  EXPECT_LE(wrong, 3);
}

TEST(ScannerEffects, DropOutsFollowTheSignal) {
  for (const double threshold : {0.2, 0.25, 0.3}) {
    scene::Scene scene = floor_scene(2.0);
    scene.scanner.effects.dropouts = {.signal_min = threshold, .signal_spread = 0.3, .bin_reflectivity = 0.9};
    // Head-on from two metres, reference one: signal 0.9 / 4. Lost where a normal is below log(threshold / signal) / 0.3.
    const double expected = 0.5 * std::erfc(-std::log(threshold / 0.225) / 0.3 / std::sqrt(2.0));
    const double lost = 1.0 - static_cast<double>(finite_points(scan(scene, 17).cloud)) / (240.0 * 200.0);
    EXPECT_NEAR(lost, expected, 0.01) << threshold;
  }
}

TEST(ScannerEffects, GrazingSurfacesDropOutSharplyWithoutSpread) {
  scene::Scene scene = floor_scene(1.0);
  scene.scanner.horizontal_fov_deg = 0.2;
  scene.scanner.effects.dropouts.signal_min = 0.1;
  for (const double angle_deg : {50.0, 58.0, 66.0, 74.0}) {
    scene.scanner.rotation_deg.y() = angle_deg;
    const double signal = std::pow(std::cos(radians(angle_deg)), 3);  // cosine, and the distance squared
    EXPECT_EQ(finite_points(scan(scene, 18).cloud) > 0, signal > 0.1) << angle_deg;
  }
}

TEST(ScannerEffects, GlareIsADiscAroundTheMirrorDirection) {
  scene::Scene scene = floor_scene(2.0);
  scene.scanner.horizontal_fov_deg = 10.0;
  scene.scanner.effects.dropouts.bin_glare_angle_deg = 2.0;
  const std::size_t lost = 240u * 200u - finite_points(scan(scene, 19).cloud);
  const double radius = std::tan(radians(2.0)) * scene::Camera(scene.scanner).focal_length();  // pixels
  const double expected = std::numbers::pi * radius * radius;
  EXPECT_NEAR(static_cast<double>(lost), expected, 0.02 * expected);
}

/// A point at an edge lies between the surfaces that its footprint sees, and elsewhere on its surface.
TEST(ScannerEffects, MixedPixelsLieBetweenTheSurfacesOfTheirFootprint) {
  scene::Scene scene = random_scene(8, 6);
  look_closely(scene.scanner, 120, 76);
  scene.scanner.region = scene::ScanRegion::full;
  scene.scanner.effects.mixed_pixels = {.share = 1.0, .footprint = 1.0, .edge_step = 0.01};
  const cloud::Cloud mixed = scan(scene, 20).cloud, exact = scan_exactly_from_all(scene).cloud;
  const scene::Camera camera(scene.scanner);
  const SphereTracer tracer(scene);
  int between = 0, wrong = 0;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    if (!cloud::is_finite(mixed.points[i])) continue;
    if ((mixed.points[i] - exact.points[i]).norm() < 1e-5F) {
      wrong += mixed.labels[i] != exact.labels[i];
      continue;
    }
    ++between;
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
    std::size_t label_of_nearest = 0;
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(0.5, 0.5), {0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
      const auto traced = tracer.trace(
          camera.direction_in_world(static_cast<double>(i % 120) + at.x(), static_cast<double>(i / 120) + at.y()));
      if (!traced.found) continue;
      const double depth = scene.scanner.position.z() - traced.point.z();
      if (depth < nearest) label_of_nearest = traced.label;
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
    const double depth = depth_of(scene, mixed.points[i]);
    wrong += !(farthest - nearest > 0.0099 && depth > nearest && depth < farthest);
    wrong += mixed.labels[i] != label_of_nearest;
  }
  EXPECT_GT(between, 200);
  EXPECT_EQ(wrong, 0);
}

TEST(ScannerEffects, OutliersAreAsManyAndAsFarAsAsked) {
  scene::Scene scene = floor_scene(1.0);
  scene.scanner.effects.outliers = {.share = 0.1, .spread = 0.05};
  std::vector<double> off;
  for (const double error : depth_errors(scene, 21))
    if (std::abs(error) > 1e-6) off.push_back(error);
  EXPECT_NEAR(static_cast<double>(off.size()), 4800.0, 4.0 * std::sqrt(48000.0 * 0.1 * 0.9));
  EXPECT_NEAR(standard_deviation(off), 0.05 / std::sqrt(3.0), 0.001);
  for (const double error : off) ASSERT_LE(std::abs(error), 0.05 + 1e-6);
}

TEST(ScannerEffects, CalibrationErrorIsOneAffineMapOfTheExactCloud) {
  scene::Scene scene = random_scene(5, 7);
  look_closely(scene.scanner, 120, 76);
  scene.scanner.effects.calibration = {.position = {0.002, -0.001, 0.003}, .rotation_deg = {0, 0, 0.5}, .focal = 0.01};
  const cloud::Cloud off = scan(scene, 22).cloud, exact = scan_exactly_from_all(scene).cloud;
  const Pose world_from_scanner = scene.scanner.world_from_scanner();
  const double c = std::cos(radians(0.5)), s = std::sin(radians(0.5));
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (!cloud::is_finite(exact.points[i])) continue;
    const Vec3 p = world_from_scanner.inverse() * exact.points[i].cast<double>();
    const double x = p.x() / 1.01, y = p.y() / 1.01;
    const Vec3 expected(c * x - s * y + 0.002, s * x + c * y - 0.001, p.z() + 0.003);
    ASSERT_LT((world_from_scanner * expected - off.points[i].cast<double>()).norm(), 2e-6);
  }
}

}  // namespace
}  // namespace tubebin::scan
