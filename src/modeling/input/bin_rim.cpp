#include "modeling/input/bin_rim.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::modeling {
namespace {

/// Walls that lean outward put their rim as far out again.
constexpr double kFarthestOut = 2.0 * kThickestWall;

/// A point at the walls' height, and how far out from the inner floor, metres.
struct HighPoint {
  std::uint32_t index = 0;
  double outside = 0.0;
};

std::vector<HighPoint> points_at_height(const BinFound& bin, std::span<const cloud::Point> points,
                                        std::span<const std::uint32_t> indices, double tolerance) {
  const Pose bin_from_world = bin.world_from_bin.inverse();
  const Eigen::Array2d inner(bin.length / 2.0, bin.width / 2.0);
  std::vector<HighPoint> high;
  for (const std::uint32_t i : indices) {
    const Vec3 p = bin_from_world * points[i].cast<double>();
    const double outside = (p.head<2>().array().abs() - inner).maxCoeff();
    if (std::abs(p.z() - bin.height) < tolerance && outside > -tolerance && outside < kFarthestOut)
      high.push_back({.index = i, .outside = outside});
  }
  return high;
}

/// How far out, metres.
struct Band {
  double inner = 0.0, outer = 0.0;
};

/// Where rings about the bin, a spacing wide, have as many points as surround it by a third.
Band rim_band(const BinFound& bin, std::span<const HighPoint> high, double spacing) {
  const double enough = 2.0 * (bin.length + bin.width) / spacing / 3.0;
  const auto surrounds = [&](double out) {
    const auto in_ring = [&](const HighPoint& p) { return p.outside >= out && p.outside < out + spacing; };
    return static_cast<double>(std::ranges::count_if(high, in_ring)) >= enough;
  };
  Band band;
  while (band.inner < kFarthestOut && !surrounds(band.inner)) band.inner += spacing;
  band.outer = band.inner;
  while (band.outer < kFarthestOut && surrounds(band.outer)) band.outer += spacing;
  return band;
}

}  // namespace

std::vector<std::uint32_t> points_on_rim(const BinFound& bin, std::span<const cloud::Point> points,
                                         std::span<const std::uint32_t> indices, double tolerance, double spacing) {
  const std::vector<HighPoint> high = points_at_height(bin, points, indices, tolerance);
  const auto [inner, outer] = rim_band(bin, high, spacing);
  std::vector<std::uint32_t> on_rim;
  for (const HighPoint& p : high)
    if (p.outside > inner - tolerance && p.outside < outer) on_rim.push_back(p.index);
  return on_rim;
}

}  // namespace tubebin::modeling
