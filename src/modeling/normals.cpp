#include "tubebin/modeling/normals.hpp"

#include <cmath>
#include <limits>

#include "tubebin/core/wide.hpp"
#include "tubebin/modeling/view_grid.hpp"

// The sums over neighbours are the most of the modeler's arithmetic, hence TUBEBIN_WIDE.

namespace tubebin {
namespace {

constexpr std::uint32_t kLanes = 8;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
using Mask = std::int32_t __attribute__((vector_size(kLanes * sizeof(float))));

float sum_of(const Lanes& v) { return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7])); }

/// Sums over neighbours q of a point p, of d = q - p.
struct Moments {
  float count = 0.0f, x = 0.0f, y = 0.0f, z = 0.0f;
  float xx = 0.0f, xy = 0.0f, xz = 0.0f, yy = 0.0f, yz = 0.0f, zz = 0.0f;
};

/// Positions [first, last) in the arrays below.
using Run = std::pair<std::uint32_t, std::uint32_t>;

/// Coordinates in grid order, one array each, so that a row of cells is one run of memory.
struct SortedPoints {
  std::vector<float> x, y, z;

  SortedPoints(std::span<const Point> points, const std::vector<std::uint32_t>& order) {
    for (auto* coordinates : {&x, &y, &z}) coordinates->resize(order.size() + kLanes, 0.0f);
    for (std::size_t k = 0; k < order.size(); ++k) {
      x[k] = points[order[k]].x();
      y[k] = points[order[k]].y();
      z[k] = points[order[k]].z();
    }
  }
};

/// Eight neighbours at a time without a branch; the arrays' padding, and what follows a run, is masked out.
TUBEBIN_WIDE void add_runs(const SortedPoints& points, std::span<const Run> runs, const Point& center,
                           float squared_radius, Moments& moments) {
  const Lanes zero = {};
  const Mask lane = {0, 1, 2, 3, 4, 5, 6, 7};
  const Lanes center_x = zero + center.x(), center_y = zero + center.y(), center_z = zero + center.z();
  Mask count = {};
  Lanes x = zero, y = zero, z = zero, xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero;
  for (const auto& [first, last] : runs)
    for (std::uint32_t k = first; k < last; k += kLanes) {
      Lanes dx, dy, dz;
      __builtin_memcpy(&dx, &points.x[k], sizeof dx);
      __builtin_memcpy(&dy, &points.y[k], sizeof dy);
      __builtin_memcpy(&dz, &points.z[k], sizeof dz);
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

/// Calls visit(i, sum) for every point, where sum(wider) gathers the moments of the points within `radius`, `wider`
/// times, of it.
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
  std::vector<Run> runs;
  for (const std::uint32_t i : grid.order()) {
    const auto image = projection(points[i]);
    // A radian is 1 + (u^2 + v^2) / 4 units of the stereographic plane.
    const float units = r / std::max(image.range, r) * (1.0f + 0.25f * (image.u * image.u + image.v * image.v));
    const int reach = static_cast<int>(std::ceil(units / cell));
    const int middle_row = grid.row(i), column = grid.column(i);
    runs.clear();
    for (int row = middle_row - reach; row <= middle_row + reach; ++row)
      if (const Run run = grid.range(row, column - reach, column + reach); run.first < run.second) runs.push_back(run);
    visit(i, [&](float wider) {
      Moments moments;
      add_runs(sorted, runs, points[i], wider * wider * r * r, moments);
      return moments;
    });
  }
}

/// The direction across the plane through the neighbours: the eigenvector of their covariance's smallest eigenvalue,
/// which is the largest one's of its adjugate: power iteration from its longest column. With neighbours that scatter a
/// third as far across the plane as along it, what five powers leave of the others is 9^-5.
/// Zero where the neighbours are too few, or too much in a line, to span a plane.
Point plane_normal(const Moments& m, const Point& to_viewpoint) {
  if (m.count < 5.0f) return Point::Zero();
  const double xx = m.xx - m.x * m.x / m.count, xy = m.xy - m.x * m.y / m.count, xz = m.xz - m.x * m.z / m.count;
  const double yy = m.yy - m.y * m.y / m.count, yz = m.yz - m.y * m.z / m.count, zz = m.zz - m.z * m.z / m.count;
  Eigen::Matrix3d adjugate;
  adjugate << yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,  //
      xz * yz - xy * zz, xx * zz - xz * xz, xy * xz - xx * yz,          //
      xy * yz - xz * yy, xy * xz - xx * yz, xx * yy - xy * xy;
  // Its trace is the sum of the eigenvalues' products of two: with a, b and next to nothing, a b. A line of neighbours
  // has b < 0.05 a, and so a b / (a + b)^2 below 0.05 / 1.05^2.
  const double trace = xx + yy + zz;
  if (!(adjugate.trace() > 0.05 / (1.05 * 1.05) * trace * trace)) return Point::Zero();
  Eigen::Index column = 0;
  adjugate.diagonal().maxCoeff(&column);
  Vec3 direction = adjugate.col(column).normalized();
  adjugate /= adjugate.trace();
  for (int power = 0; power < 4; ++power) direction = adjugate * direction;
  const Point normal = direction.normalized().cast<float>();
  return normal.dot(to_viewpoint) < 0.0f ? Point(-normal) : normal;
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
                        [&](std::size_t i, const auto& sum) { counts[i] = static_cast<int>(sum(1.0f).count); });
  return counts;
}

}  // namespace tubebin
