#include "modeling/input/view_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "modeling/median.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

struct Extent {
  float u_min = std::numeric_limits<float>::infinity(), v_min = u_min;
  float u_max = -u_min, v_max = -u_min;

  explicit Extent(const ViewProjection::Images& images) {
    for (const float u : images.u) u_min = std::min(u_min, u), u_max = std::max(u_max, u);
    for (const float v : images.v) v_min = std::min(v_min, v), v_max = std::max(v_max, v);
  }
  double area() const { return double(u_max - u_min) * double(v_max - v_min); }
  double smallest_cell() const { return modeling::smallest_cell(u_max - u_min, v_max - v_min); }
};

/// How many cells of this size hold a point.
std::ptrdiff_t count_occupied(const ViewProjection::Images& images, const Extent& extent, float cell) {
  const int columns = static_cast<int>((extent.u_max - extent.u_min) / cell) + 1;
  const int rows = static_cast<int>((extent.v_max - extent.v_min) / cell) + 1;
  std::vector<char> is_occupied(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  const float per_cell = 1.0f / cell;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int column = std::min(static_cast<int>((images.u[i] - extent.u_min) * per_cell), columns - 1);
    const int row = std::min(static_cast<int>((images.v[i] - extent.v_min) * per_cell), rows - 1);
    is_occupied[static_cast<std::size_t>(row * columns + column)] = 1;
  }
  return std::ranges::count(is_occupied, 1);
}

}  // namespace

double smallest_cell(double width, double height) {
  constexpr double kMostCells = 1 << 24;
  constexpr double kMostCellsInARow = 1 << 20;  // of points on a line, whose area is 0
  return std::max(std::sqrt(width * height / kMostCells), std::max(width, height) / kMostCellsInARow);
}

ViewGrid::ViewGrid(ViewProjection::Images images, std::span<const cloud::Point> points, float cell)
    : images_(std::move(images)) {
  if (points.empty()) {
    starts_.assign(2, 0);
    return;
  }
  const Extent extent(images_);
  cell = std::max(cell, static_cast<float>(extent.smallest_cell()));
  columns_ = static_cast<std::uint32_t>((extent.u_max - extent.u_min) / cell) + 1;
  rows_ = static_cast<std::uint32_t>((extent.v_max - extent.v_min) / cell) + 1;

  cells_.resize(points.size());
  for_ranges_in_parallel(points.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto column = static_cast<std::uint32_t>((images_.u[i] - extent.u_min) / cell);
      const auto row = static_cast<std::uint32_t>((images_.v[i] - extent.v_min) / cell);
      cells_[i] = std::min(row, rows_ - 1) * columns_ + std::min(column, columns_ - 1);
    }
  });
  starts_.assign(std::size_t{columns_} * rows_ + 1, 0);
  for (const std::uint32_t c : cells_) ++starts_[c + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());

  order_.resize(points.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i) order_[next[cells_[i]]++] = i;
  const auto is_before = [&](std::uint32_t a, std::uint32_t b) {
    const cloud::Point& p = points[a];
    const cloud::Point& q = points[b];
    return std::tuple(p.x(), p.y(), p.z(), a) < std::tuple(q.x(), q.y(), q.z(), b);
  };
  for_ranges_in_parallel(starts_.size() - 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c)
      if (starts_[c + 1] - starts_[c] > 1)
        std::sort(order_.begin() + starts_[c], order_.begin() + starts_[c + 1], is_before);
  });
}

std::pair<std::uint32_t, std::uint32_t> ViewGrid::range(int row, int first_column, int last_column) const {
  if (row < 0 || row >= static_cast<int>(rows_)) return {0, 0};
  first_column = std::max(first_column, 0);
  last_column = std::min(last_column, static_cast<int>(columns_) - 1);
  if (first_column > last_column) return {0, 0};
  const std::size_t base = static_cast<std::size_t>(row) * columns_;
  return {starts_[base + static_cast<std::size_t>(first_column)],
          starts_[base + static_cast<std::size_t>(last_column) + 1]};
}

PointSpacing estimate_spacing(const ViewProjection::Images& images) {
  if (images.size() == 0) return {};
  const Extent extent(images);

  // With about four points a cell few cells of a surface are empty by chance (e^-4 = 2 %), and the cells that a
  // surface covers only partly are still a small part of all.
  constexpr double kPointsPerCell = 4.0;
  const auto count = static_cast<double>(images.size());
  double cell = std::sqrt(std::max(extent.area(), 1e-12) * kPointsPerCell / count);
  double area = extent.area();
  for (int round = 0; round < 3; ++round) {
    cell = std::max(cell, extent.smallest_cell());
    area = static_cast<double>(count_occupied(images, extent, static_cast<float>(cell))) * cell * cell;
    cell = std::sqrt(area * kPointsPerCell / count);
  }
  constexpr std::size_t kSample = 1 << 16;
  std::vector<float> ranges;
  for (std::size_t i = 0; i < images.size(); i += images.size() / kSample + 1) ranges.push_back(images.range[i]);
  const double angle = std::sqrt(area / count);
  return {.angle = angle, .metres = double(median(ranges)) * angle};
}

}  // namespace tubebin::modeling
