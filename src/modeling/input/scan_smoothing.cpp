#include "modeling/input/scan_smoothing.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "modeling/input/neighborhoods.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

/// Spacings. Thin tubes side by side are 0.2 off planes of three by three points.
constexpr double kNoisy = 0.3;

/// Metres, standard deviation of points about planes of three by three points, within which even thin tubes are nearly flat; of
/// more points where noise is as wide as these.
double noise_of(const SourceView& view) {
  constexpr double kLeast = 0.75, kMost = 3.0;  // of four points
  for (double wider = kLeast;; wider *= 2.0) {
    const double noise = FlatBlocks(view, wider).roughness();
    if (noise < 0.7 * wider * view.spacing.metres || wider >= kMost) return noise;
  }
}

/// How far along the ray, from the place that the moments are about, their plane of least squares along the ray lies, metres; 0
/// where the neighbours are too few, or too much in a line, to tell.
double plane_on_ray(const Moments& moments, const Vec3& ray) {
  if (moments.count < 5.0f) return 0.0;
  Eigen::Matrix3d from_world;
  from_world.row(0) = ray.unitOrthogonal();
  from_world.row(1) = ray.cross(ray.unitOrthogonal());
  from_world.row(2) = ray;
  const Vec3 mean = from_world * moments.mean();
  const Eigen::Matrix3d covariance = from_world * moments.covariance() * from_world.transpose();
  const Eigen::Matrix2d across = covariance.topLeftCorner<2, 2>();
  if (across.determinant() < 0.02 * across.trace() * across.trace()) return 0.0;
  const Eigen::Vector2d slope = across.inverse() * covariance.topRightCorner<2, 1>();
  return mean.z() - slope.dot(mean.head<2>());
}

/// The view's points, each moved along its ray to the plane through those within `radius` metres.
std::vector<cloud::Point> smoothed_points(const SourceView& view, double radius) {
  constexpr int kTurns = 2;  // about a place before the surface, a ball takes in more of what lies before it as well
  std::vector<cloud::Point> points = view.points;
  const Neighborhoods neighborhoods(view.projection, view.points, radius);
  for_ranges_in_parallel(points.size(), [&](std::size_t first, std::size_t last) {
    Neighborhoods::Window window(neighborhoods, radius);
    for (const std::uint32_t k : std::span(neighborhoods.order()).subspan(first, last - first)) {
      const Vec3 ray = (points[k] - view.projection.viewpoint()).cast<double>().normalized();
      for (int turn = 0; turn < kTurns; ++turn)
        points[k] += (plane_on_ray(window.moments_about(points[k], k), ray) * ray).cast<float>();
    }
  });
  return points;
}

}  // namespace

bool is_noisy(const SourceView& view, const FlatBlocks& blocks) {
  // Most scans are smooth, and do not take the time of other blocks.
  const double limit = kNoisy * view.spacing.metres;
  return blocks.roughness() > limit && noise_of(view) > limit;
}

SmoothedScan smoothed_scan(const ModelingInput& input, const ViewProjection& first) {
  SmoothedScan scan{.points = {input.points.begin(), input.points.end()}};
  std::vector<std::vector<std::uint32_t>> seen_by(1 + input.world_from_further_sensors.size());
  for (std::uint32_t i = 0; i < input.points.size(); ++i)
    if (cloud::is_finite(input.points[i])) seen_by.at(input.sources.empty() ? 0 : input.sources[i]).push_back(i);
  for (const std::vector<std::uint32_t>& indices : seen_by) {
    if (indices.empty()) continue;
    const SourceView view = views_of(input, first, indices).front();
    const double noise = noise_of(view), spacing = view.spacing.metres;
    if (noise <= kNoisy * spacing) continue;
    // Some 20 points make the noise a quarter; 450 are as many as time allows.
    const auto points = smoothed_points(view, std::clamp(3.0 * noise, 2.5 * spacing, 12.0 * spacing));
    for (std::size_t k = 0; k < indices.size(); ++k) scan.points[indices[k]] = points[k];
    scan.noise = std::max(scan.noise, noise);
  }
  return scan;
}

}  // namespace tubebin::modeling
