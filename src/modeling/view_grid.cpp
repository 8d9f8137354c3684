#include "tubebin/modeling/view_grid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace tubebin {
namespace {

/// No grid takes more memory than this many cells need, however far apart its points lie.
constexpr double kMostCells = 1 << 24;

struct Extent {
  float u_min = std::numeric_limits<float>::infinity(), v_min = u_min;
  float u_max = -u_min, v_max = -u_min;

  void add(const ViewProjection::Image& image) {
    u_min = std::min(u_min, image.u);
    v_min = std::min(v_min, image.v);
    u_max = std::max(u_max, image.u);
    v_max = std::max(v_max, image.v);
  }
  double area() const { return double(u_max - u_min) * double(v_max - v_min); }
};

/// Sums that make up the covariance of the neighbours about the point itself.
struct Moments {
  using Lanes = Eigen::Array<float, 8, 1>;
  Lanes count = Lanes::Zero(), x = count, y = count, z = count;
  Lanes xx = count, xy = count, xz = count, yy = count, yz = count, zz = count;

  float points() const { return count.sum(); }
  Eigen::Matrix3f covariance() const {
    const Point sum(x.sum(), y.sum(), z.sum());
    Eigen::Matrix3f products;
    products << xx.sum(), xy.sum(), xz.sum(),  //
        xy.sum(), yy.sum(), yz.sum(),          //
        xz.sum(), yz.sum(), zz.sum();
    return products - sum * sum.transpose() / points();
  }
};

/// Coordinates in grid order, one array each, so that a row of cells is one run of memory.
struct SortedPoints {
  std::vector<float> x, y, z;

  SortedPoints(std::span<const Point> points, const std::vector<std::uint32_t>& order) {
    x.reserve(order.size());
    y.reserve(order.size());
    z.reserve(order.size());
    for (const std::uint32_t i : order) {
      x.push_back(points[i].x());
      y.push_back(points[i].y());
      z.push_back(points[i].z());
    }
    for (auto* coordinates : {&x, &y, &z}) coordinates->resize(order.size() + 8, 0.0f);
  }

  void add(Moments& m, const Point& center, float squared_radius, std::uint32_t first, std::uint32_t last) const {
    // Eight at a time without a branch; the arrays' padding, and what follows a run, is masked out.
    using Eight = Eigen::Array<float, 8, 1>;
    static const Eight kLanes = Eight::LinSpaced(0.0f, 7.0f);
    for (std::uint32_t k = first; k < last; k += 8) {
      const Eight dx = Eight::Map(&x[k]) - center.x(), dy = Eight::Map(&y[k]) - center.y(),
                  dz = Eight::Map(&z[k]) - center.z();
      const Eight squared = dx * dx + dy * dy + dz * dz;
      const Eight w = (squared <= squared_radius && kLanes < static_cast<float>(last - k)).template cast<float>();
      const Eight wx = w * dx, wy = w * dy, wz = w * dz;
      m.count += w, m.x += wx, m.y += wy, m.z += wz;
      m.xx += wx * dx, m.xy += wx * dy, m.xz += wx * dz, m.yy += wy * dy, m.yz += wy * dz, m.zz += wz * dz;
    }
  }
};

/// The plane's normal; zero where the neighbours are too few, or too much in a line, to span one.
Point plane_normal(const Moments& moments, const Point& to_viewpoint) {
  if (moments.points() < 5.0f) return Point::Zero();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(moments.covariance());
  if (solver.eigenvalues()(1) < 0.05f * solver.eigenvalues()(2)) return Point::Zero();
  const Point normal = solver.eigenvectors().col(0);
  if (!normal.allFinite()) return Point::Zero();
  return normal.dot(to_viewpoint) < 0.0f ? Point(-normal) : normal;
}

}  // namespace

ViewGrid::ViewGrid(const ViewProjection& projection, std::span<const Point> points, float cell) {
  std::vector<ViewProjection::Image> images;
  images.reserve(points.size());
  Extent extent;
  for (const Point& point : points) extent.add(images.emplace_back(projection(point)));
  if (points.empty()) {
    starts_.assign(2, 0);
    return;
  }
  cell = std::max(cell, static_cast<float>(std::sqrt(extent.area() / kMostCells)));
  columns_ = static_cast<std::uint32_t>((extent.u_max - extent.u_min) / cell) + 1;
  rows_ = static_cast<std::uint32_t>((extent.v_max - extent.v_min) / cell) + 1;

  starts_.assign(std::size_t{columns_} * rows_ + 1, 0);
  cells_.reserve(points.size());
  for (const auto& image : images) {
    const auto column = static_cast<std::uint32_t>((image.u - extent.u_min) / cell);
    const auto row = static_cast<std::uint32_t>((image.v - extent.v_min) / cell);
    cells_.push_back(std::min(row, rows_ - 1) * columns_ + std::min(column, columns_ - 1));
    if (starts_[cells_.back() + 1]++ == 0) ++occupied_cells_;
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());

  order_.resize(points.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i) order_[next[cells_[i]]++] = i;
  for (std::size_t c = 0; c + 1 < starts_.size(); ++c)
    if (starts_[c + 1] - starts_[c] > 1)
      std::sort(order_.begin() + starts_[c], order_.begin() + starts_[c + 1], [&](std::uint32_t a, std::uint32_t b) {
        const Point& p = points[a];
        const Point& q = points[b];
        return std::tuple(p.x(), p.y(), p.z(), a) < std::tuple(q.x(), q.y(), q.z(), b);
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

double estimate_spacing(const ViewProjection& projection, std::span<const Point> points) {
  if (points.empty()) return 0.0;
  Extent extent;
  std::vector<float> ranges;
  ranges.reserve(points.size());
  for (const Point& point : points) {
    const auto image = projection(point);
    extent.add(image);
    ranges.push_back(image.range);
  }
  std::nth_element(ranges.begin(), ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2), ranges.end());
  const double range = ranges[ranges.size() / 2];

  // With about four points a cell few cells of a surface are empty by chance (e^-4 = 2 %), and the cells that a
  // surface covers only partly are still a small part of all.
  constexpr double kPointsPerCell = 4.0;
  const auto count = static_cast<double>(points.size());
  double cell = std::sqrt(std::max(extent.area(), 1e-12) * kPointsPerCell / count);
  double area = extent.area();
  for (int round = 0; round < 3; ++round) {
    const ViewGrid grid(projection, points, static_cast<float>(cell));
    area = static_cast<double>(grid.occupied_cells()) * cell * cell;
    cell = std::sqrt(area * kPointsPerCell / count);
  }
  return range * std::sqrt(area / count);
}

namespace {

/// Calls visit(i, center, sum) for every point, where sum(wider) gathers the moments of the points within `radius`,
/// `wider` times, of it.
template <typename Visit>
void for_each_neighborhood(const ViewProjection& projection, std::span<const Point> points, double radius,
                           const Visit& visit) {
  float nearest = std::numeric_limits<float>::infinity();
  for (const Point& point : points) nearest = std::min(nearest, (point - projection.viewpoint()).norm());
  // Cells of half the radius, as seen at the nearest range: the disc covers most of the 5 x 5 cells searched there,
  // and fewer of them farther away.
  const auto r = static_cast<float>(radius);
  const float cell = 0.5f * r / std::max(nearest, r);
  const ViewGrid grid(projection, points, cell);
  const SortedPoints sorted(points, grid.order());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto image = projection(points[i]);
    // A radian is 1 + (u^2 + v^2) / 4 units of the stereographic plane.
    const float units = r / std::max(image.range, r) * (1.0f + 0.25f * (image.u * image.u + image.v * image.v));
    visit(i, [&](float wider) {
      const int reach = static_cast<int>(std::ceil(units / cell));
      Moments moments;
      for (int row = grid.row(i) - reach; row <= grid.row(i) + reach; ++row) {
        const auto [first, last] = grid.range(row, grid.column(i) - reach, grid.column(i) + reach);
        sorted.add(moments, points[i], wider * wider * r * r, first, last);
      }
      return moments;
    });
  }
}

}  // namespace

std::vector<Point> estimate_normals(const ViewProjection& projection, std::span<const Point> points, double radius) {
  std::vector<Point> normals(points.size(), Point::Zero());
  // Where the surface is seen at a flat angle, rows of points that are neighbours in the view lie far apart in space:
  // a wider ball about the same part of the view finds them.
  for_each_neighborhood(projection, points, radius, [&](std::size_t i, const auto& sum) {
    const Point to_viewpoint = projection.viewpoint() - points[i];
    for (float wider = 1.0f; wider <= 4.0f && normals[i].isZero(); wider *= 2.0f)
      normals[i] = plane_normal(sum(wider), to_viewpoint);
  });
  return normals;
}

std::vector<int> count_neighbors(const ViewProjection& projection, std::span<const Point> points, double radius) {
  std::vector<int> counts(points.size(), 0);
  for_each_neighborhood(projection, points, radius,
                        [&](std::size_t i, const auto& sum) { counts[i] = static_cast<int>(sum(1.0f).points()); });
  return counts;
}

}  // namespace tubebin
