#include "modeling/input/open_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/golden_spiral.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/parallel.hpp"
#include "tubebin/modeling/scan_view.hpp"

namespace tubebin::modeling {
namespace {

/// Where coordinates lie but for the outermost hundredth at each end.
struct Span {
  float low, high;

  explicit Span(std::vector<float> coordinates) {
    const auto at = [&](double share) {
      const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(coordinates.size() - 1));
      std::ranges::nth_element(coordinates, coordinates.begin() + k);
      return coordinates[static_cast<std::size_t>(k)];
    };
    low = at(0.01), high = at(0.99);
  }
  float length() const { return high - low; }
  bool holds(float coordinate) const { return coordinate >= low && coordinate <= high; }
};

ViewProjection::Images images_from(const Vec3& viewpoint, std::span<const Vec3> points) {
  const ViewProjection projection(Pose(Eigen::Translation3d(viewpoint)), middle_of(points).cast<float>());
  ViewProjection::Images images;
  for (const Vec3& point : points) {
    const ViewProjection::Image image = projection(point.cast<float>());
    images.u.push_back(image.u), images.v.push_back(image.v), images.range.push_back(image.range);
  }
  return images;
}

/// Leaves at most `count` of the viewpoints: those from which the fewest points are hidden, the best first.
void keep_most_open(std::vector<Vec3>& viewpoints, std::span<const Vec3> points, double widths, std::size_t count) {
  const std::vector<double> hidden =
      map_in_parallel(viewpoints.size(), [&](std::size_t k) { return hidden_share(points, viewpoints[k], widths); });
  std::vector<std::size_t> order(viewpoints.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return hidden[k]; });
  order.resize(std::min(order.size(), count));
  std::vector<Vec3> kept;
  for (const std::size_t k : order) kept.push_back(viewpoints[k]);
  viewpoints = std::move(kept);
}

}  // namespace

double hidden_share(std::span<const Vec3> points, const Vec3& viewpoint, double widths) {
  constexpr float kPointsOfCell = 4.0f;
  if (points.empty()) return 0.0;
  const ViewProjection::Images images = images_from(viewpoint, points);
  const Span u(images.u), v(images.v);
  const auto count = static_cast<float>(points.size());
  const float cell = std::max({std::sqrt(kPointsOfCell * u.length() * v.length() / count), u.length() / count,
                               v.length() / count, std::numeric_limits<float>::min()});
  const auto columns = static_cast<std::size_t>(u.length() / cell) + 1;
  const auto rows = static_cast<std::size_t>(v.length() / cell) + 1;
  const auto cell_of = [&](std::size_t i) {
    return static_cast<std::size_t>((images.v[i] - v.low) / cell) * columns +
           static_cast<std::size_t>((images.u[i] - u.low) / cell);
  };
  std::vector<float> nearest(columns * rows, std::numeric_limits<float>::infinity());
  std::vector<std::size_t> looked_at;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!u.holds(images.u[i]) || !v.holds(images.v[i])) continue;
    looked_at.push_back(i);
    float& range = nearest[cell_of(i)];
    range = std::min(range, images.range[i]);
  }
  const float farthest = 1.0f + static_cast<float>(widths) * cell;  // in ranges of the nearest point
  const auto hidden =
      std::ranges::count_if(looked_at, [&](std::size_t i) { return images.range[i] > farthest * nearest[cell_of(i)]; });
  return looked_at.empty() ? 0.0 : static_cast<double>(hidden) / static_cast<double>(looked_at.size());
}

Vec3 most_open_viewpoint(std::span<const Vec3> points, const Vec3& behind) {
  // Four degrees apart: into a full bin, tubes hide each other from a little aside.
  constexpr std::size_t kDirections = 512;
  constexpr double kWidths = 4.0;  // a surface that leans is not as deep
  // What hides little, such as tubes on a table, shows among many points only.
  constexpr std::size_t kCoarse = 8000, kShortlist = 64;
  const Vec3 middle = middle_of(points);
  double squares = 0.0;
  for (const Vec3& point : points) squares += (point - middle).squaredNorm();
  const double spread = std::sqrt(squares / static_cast<double>(points.size()));
  std::vector<Vec3> viewpoints;
  for (const Vec3& direction : golden_spiral(kDirections, -1.0))
    if (behind.isZero() || direction.dot(behind) < 0.0)
      for (const double distance : {2.5, 4.0, 8.0, 100.0})  // of whole cells, bins, parts of them; by parallel rays
        viewpoints.push_back(middle + distance * spread * direction);
  keep_most_open(viewpoints, some_of(points, kCoarse), kWidths, kShortlist);
  keep_most_open(viewpoints, points, kWidths, 1);
  return viewpoints.front();
}

}  // namespace tubebin::modeling
