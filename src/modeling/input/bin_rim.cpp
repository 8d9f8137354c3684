#include "modeling/input/bin_rim.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tubebin::modeling {
namespace {

/// Walls that lean outward put their rim as far out again.
constexpr double kFarthestOut = 2.0 * kThickestWall;

/// How much higher or lower than the bin one of its walls may be, metres.
constexpr double kUneven = 0.005;

/// A point above or on the bin's walls, in metres: its height, and how far out from the inner floor it is.
struct HighPoint {
  std::uint32_t index = 0;
  double height = 0.0, outside = 0.0;
};

/// Those near the upper side of each wall.
std::array<std::vector<HighPoint>, 4> points_by_wall(const BinFound& bin, std::span<const cloud::Point> points,
                                                     std::span<const std::uint32_t> indices, double tolerance) {
  const Pose bin_from_world = bin.world_from_bin.inverse();
  const Eigen::Array2d inner(bin.length / 2.0, bin.width / 2.0);
  std::array<std::vector<HighPoint>, 4> walls;
  for (const std::uint32_t i : indices) {
    const Vec3 p = bin_from_world * points[i].cast<double>();
    Eigen::Index axis = 0;
    const double outside = (p.head<2>().array().abs() - inner).maxCoeff(&axis);
    if (std::abs(p.z() - bin.height) < kUneven + tolerance && outside > -tolerance && outside < kFarthestOut)
      walls[static_cast<std::size_t>(axis) * 2 + (p[axis] > 0.0)].push_back({i, p.z(), outside});
  }
  return walls;
}

/// Keeps the points at the height that most of the wall's lie at: the bin's, but for an uneven wall.
void keep_commonest_height(std::vector<HighPoint>& wall, double of_bin, double tolerance) {
  std::ranges::sort(wall, {}, &HighPoint::height);
  std::ptrdiff_t best = 0, most = 0;
  for (std::ptrdiff_t first = 0, end = 0; first < std::ssize(wall); ++first) {
    const auto at = [&](std::ptrdiff_t k) { return wall[static_cast<std::size_t>(k)].height; };
    while (end < std::ssize(wall) && at(end) < at(first) + 2.0 * tolerance) ++end;
    if (end - first > most) most = end - first, best = first;
  }
  const double commonest = wall.empty() ? of_bin : wall[static_cast<std::size_t>(best + most / 2)].height;
  const double height = std::abs(commonest - of_bin) < tolerance ? of_bin : commonest;
  std::erase_if(wall, [&](const HighPoint& p) { return std::abs(p.height - height) >= tolerance; });
}

std::vector<HighPoint> points_at_height(const BinFound& bin, std::span<const cloud::Point> points,
                                        std::span<const std::uint32_t> indices, double tolerance) {
  std::vector<HighPoint> high;
  for (std::vector<HighPoint>& wall : points_by_wall(bin, points, indices, tolerance)) {
    keep_commonest_height(wall, bin.height, tolerance);
    high.insert(high.end(), wall.begin(), wall.end());
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
  std::ranges::sort(on_rim);
  return on_rim;
}

}  // namespace tubebin::modeling
