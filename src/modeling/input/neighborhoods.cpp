#include "modeling/input/neighborhoods.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lanes.hpp"
#include "modeling/parallel.hpp"

// The sums over neighbours are the most of the modeler's arithmetic, hence TUBEBIN_WIDE.

namespace tubebin::modeling {
namespace {

/// Eight neighbours at a time without a branch; the arrays' padding, and what follows a run, is masked out.
TUBEBIN_WIDE void add_runs(const PointArrays& points, std::span<const std::pair<std::uint32_t, std::uint32_t>> runs,
                           const cloud::Point& center, float squared_radius, Moments& moments) {
  const Lanes zero = {};
  const Mask lane = {0, 1, 2, 3, 4, 5, 6, 7};
  const Lanes center_x = zero + center.x(), center_y = zero + center.y(), center_z = zero + center.z();
  Mask count = {};
  Lanes x = zero, y = zero, z = zero, xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero;
  for (const auto& [first, last] : runs)
    for (std::uint32_t k = first; k < last; k += kLanes) {
      Lanes dx, dy, dz;
      load(dx, &points.x[k]), load(dy, &points.y[k]), load(dz, &points.z[k]);
      dx -= center_x, dy -= center_y, dz -= center_z;
      const Mask near = (dx * dx + dy * dy + dz * dz <= squared_radius) & (lane < static_cast<std::int32_t>(last - k));
      const Lanes wx = (Lanes)((Mask)dx & near), wy = (Lanes)((Mask)dy & near), wz = (Lanes)((Mask)dz & near);
      count -= near;  // true is -1
      x += wx, y += wy, z += wz;
      xx += wx * dx, xy += wx * dy, xz += wx * dz, yy += wy * dy, yz += wy * dz, zz += wz * dz;
    }
  for (std::uint32_t k = 0; k < kLanes; ++k) moments.count += static_cast<float>(count[k]);
  moments.x += sum_of(x), moments.y += sum_of(y), moments.z += sum_of(z);
  moments.xx += sum_of(xx), moments.xy += sum_of(xy), moments.xz += sum_of(xz);
  moments.yy += sum_of(yy), moments.yz += sum_of(yz), moments.zz += sum_of(zz);
}

PointArrays arrays_of(std::span<const cloud::Point> points, const std::vector<std::uint32_t>& order) {
  PointArrays arrays;
  for (auto* coordinates : {&arrays.x, &arrays.y, &arrays.z}) coordinates->resize(order.size() + kLanes, 0.0f);
  for (std::size_t k = 0; k < order.size(); ++k) {
    arrays.x[k] = points[order[k]].x();
    arrays.y[k] = points[order[k]].y();
    arrays.z[k] = points[order[k]].z();
  }
  return arrays;
}

float nearest_range(const ViewProjection& projection, std::span<const cloud::Point> points) {
  float squared = std::numeric_limits<float>::infinity();
  for (const cloud::Point& point : points) squared = std::min(squared, (point - projection.viewpoint()).squaredNorm());
  return std::sqrt(squared);
}

/// Beyond the widest grid there are no cells; and a ratio that is not finite reaches all of them.
int reach_of(float cells) {
  constexpr float kReachMax = 1 << 24;
  return cells < kReachMax ? static_cast<int>(std::ceil(cells)) : static_cast<int>(kReachMax);
}

/// Half the radius, as seen at the nearest range: the disc covers most of the 5 x 5 cells searched there, and fewer of them
/// farther away.
float cell_for(double radius, const ViewProjection& projection, std::span<const cloud::Point> points) {
  const auto metres = static_cast<float>(radius);
  return 0.5f * metres / std::max(nearest_range(projection, points), metres);
}

}  // namespace

Eigen::Matrix3d Moments::covariance() const {
  Eigen::Matrix3d products;
  products << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return products / double(count) - mean() * mean().transpose();
}

Neighborhoods::Neighborhoods(const ViewProjection& projection, std::span<const cloud::Point> points, double radius)
    : points_(points),
      cell_(cell_for(radius, projection, points)),
      grid_(projection, points, cell_),
      sorted_(arrays_of(points, grid_.order())) {}

Moments Neighborhoods::Window::moments_around(std::size_t i, float wider) {
  return moments_about(all_.points_[i], i, wider);
}

Moments Neighborhoods::Window::moments_about(const cloud::Point& place, std::size_t i, float wider) {
  look_at(i);
  Moments moments;
  add_runs(all_.sorted_, runs_, place, wider * wider * radius_ * radius_, moments);
  return moments;
}

std::vector<std::uint32_t> Neighborhoods::Window::points_around(std::size_t i) {
  look_at(i);
  std::vector<std::uint32_t> near;
  for (const auto& [first, last] : runs_)
    for (std::uint32_t k = first; k < last; ++k)
      if (const std::uint32_t j = all_.order()[k];
          (all_.points_[j] - all_.points_[i]).squaredNorm() <= radius_ * radius_)
        near.push_back(j);
  return near;
}

void Neighborhoods::Window::look_at(std::size_t i) {
  const ViewProjection::Image image = all_.grid_.image(i);
  // A radian is 1 + (u^2 + v^2) / 4 units of the stereographic plane.
  const float units =
      radius_ / std::max(image.range, radius_) * (1.0f + 0.25f * (image.u * image.u + image.v * image.v));
  const Place place{all_.grid_.row(i), all_.grid_.column(i), reach_of(units / all_.cell_)};
  if (place == place_) return;
  place_ = place;
  const auto [middle_row, column, reach] = place;
  runs_.clear();
  for (int row = middle_row - reach; row <= middle_row + reach; ++row)
    if (const auto run = all_.grid_.range(row, column - reach, column + reach); run.first < run.second)
      runs_.push_back(run);
}

std::vector<int> count_neighbors(const ViewProjection& projection, std::span<const cloud::Point> points,
                                 double radius) {
  std::vector<int> counts(points.size(), 0);
  const Neighborhoods neighborhoods(projection, points, radius);
  for_ranges_in_parallel(points.size(), [&](std::size_t first, std::size_t last) {
    Neighborhoods::Window window(neighborhoods, radius);
    for (const std::uint32_t i : std::span(neighborhoods.order()).subspan(first, last - first))
      counts[i] = static_cast<int>(window.moments_around(i).count);
  });
  return counts;
}

std::vector<bool> lie_alone(const ViewProjection& projection, std::span<const cloud::Point> points, double spacing) {
  // Within three spacings lie some 28 points of a surface, half of them at its edges.
  constexpr int kLeast = 9;
  std::vector<bool> alone;
  for (const int count : count_neighbors(projection, points, 3.0 * spacing)) alone.push_back(count < kLeast);
  return alone;
}

}  // namespace tubebin::modeling
