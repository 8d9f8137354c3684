#include "modeling/input/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/lanes.hpp"
#include "modeling/input/view_grid.hpp"
#include "modeling/parallel.hpp"

// The sums over neighbours are the most of the modeler's arithmetic, hence TUBEBIN_WIDE.

namespace tubebin::modeling {
namespace {

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

  SortedPoints(std::span<const cloud::Point> points, const std::vector<std::uint32_t>& order) {
    for (auto* coordinates : {&x, &y, &z}) coordinates->resize(order.size() + kLanes, 0.0f);
    for (std::size_t k = 0; k < order.size(); ++k) {
      x[k] = points[order[k]].x();
      y[k] = points[order[k]].y();
      z[k] = points[order[k]].z();
    }
  }
};

/// Eight neighbours at a time without a branch; the arrays' padding, and what follows a run, is masked out.
TUBEBIN_WIDE void add_runs(const SortedPoints& points, std::span<const Run> runs, const cloud::Point& center,
                           float squared_radius, Moments& moments) {
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

/// The points' neighbours in space, found in the scanner's view.
class Neighborhoods {
 public:
  Neighborhoods(const ViewProjection& projection, std::span<const cloud::Point> points, double radius)
      : points_(points),
        radius_(static_cast<float>(radius)),
        cell_(0.5f * radius_ / std::max(nearest_range(projection, points), radius_)),
        grid_(projection, points, cell_),
        sorted_(points, grid_.order()) {}

  /// In which one point's neighbours are mostly the next one's.
  const std::vector<std::uint32_t>& order() const { return grid_.order(); }

  /// A part of the view, and the points in it.
  class Window {
   public:
    explicit Window(const Neighborhoods& all) : all_(all) {}

    /// Of the points within the radius, `wider` times, of point i, in the part of the view that the radius covers. The next point
    /// is mostly in the same one.
    Moments around(std::size_t i, float wider) {
      look_at(i);
      Moments moments;
      add_runs(all_.sorted_, runs_, all_.points_[i], wider * wider * all_.radius_ * all_.radius_, moments);
      return moments;
    }

   private:
    void look_at(std::size_t i) {
      const ViewProjection::Image image = all_.grid_.image(i);
      // A radian is 1 + (u^2 + v^2) / 4 units of the stereographic plane.
      const float units =
          all_.radius_ / std::max(image.range, all_.radius_) * (1.0f + 0.25f * (image.u * image.u + image.v * image.v));
      const Place place{all_.grid_.row(i), all_.grid_.column(i), reach_of(units / all_.cell_)};
      if (place == place_) return;
      place_ = place;
      const auto [middle_row, column, reach] = place;
      runs_.clear();
      for (int row = middle_row - reach; row <= middle_row + reach; ++row)
        if (const Run run = all_.grid_.range(row, column - reach, column + reach); run.first < run.second)
          runs_.push_back(run);
    }

    struct Place {
      int row = 0, column = 0, reach = -1;
      bool operator==(const Place&) const = default;
    };

    const Neighborhoods& all_;
    Place place_;            ///< of the point last looked at
    std::vector<Run> runs_;  ///< of the points in it
  };

 private:
  static float nearest_range(const ViewProjection& projection, std::span<const cloud::Point> points) {
    float squared = std::numeric_limits<float>::infinity();
    for (const cloud::Point& point : points)
      squared = std::min(squared, (point - projection.viewpoint()).squaredNorm());
    return std::sqrt(squared);
  }

  /// Beyond the widest grid there are no cells; and a ratio that is not finite reaches all of them.
  static int reach_of(float cells) {
    constexpr float kReachMax = 1 << 24;
    return cells < kReachMax ? static_cast<int>(std::ceil(cells)) : static_cast<int>(kReachMax);
  }

  std::span<const cloud::Point> points_;
  float radius_;
  /// Half the radius, as seen at the nearest range: the disc covers most of the 5 x 5 cells searched there, and fewer
  /// of them farther away.
  float cell_;
  ViewGrid grid_;
  SortedPoints sorted_;
};

/// So many planes at a time.
constexpr std::size_t kPlanes = 4;
using Doubles = double __attribute__((vector_size(kPlanes * sizeof(double))));
using DoublesMask = std::int64_t __attribute__((vector_size(kPlanes * sizeof(double))));

void gather(const std::array<Moments, kPlanes>& moments, float Moments::*quantity, Doubles& lanes) {
  for (std::size_t k = 0; k < kPlanes; ++k) lanes[k] = double(moments[k].*quantity);
}

/// The directions across the planes through neighbours: the eigenvector of their covariance's smallest eigenvalue,
/// which is the largest one's of its adjugate: power iteration from its longest column. With neighbours that scatter a
/// third as far across the plane as along it, what five powers leave of the others is 9^-5.
/// Zero where the neighbours are too few, or too much in a line, to span a plane.
TUBEBIN_WIDE void plane_normals(const std::array<Moments, kPlanes>& moments,
                                const std::array<cloud::Point, kPlanes>& to_viewpoint,
                                std::array<cloud::Point, kPlanes>& normals) {
  Doubles n, x, y, z, xx, xy, xz, yy, yz, zz;
  gather(moments, &Moments::count, n), gather(moments, &Moments::x, x), gather(moments, &Moments::y, y);
  gather(moments, &Moments::z, z), gather(moments, &Moments::xx, xx), gather(moments, &Moments::xy, xy);
  gather(moments, &Moments::xz, xz), gather(moments, &Moments::yy, yy), gather(moments, &Moments::yz, yz);
  gather(moments, &Moments::zz, zz);
  xx -= x * x / n, xy -= x * y / n, xz -= x * z / n, yy -= y * y / n, yz -= y * z / n, zz -= z * z / n;
  Doubles a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;  // the adjugate's rows: a b c,
  Doubles d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;  // b d e, c e f
  // Its trace is the sum of the eigenvalues' products of two: with a, b and next to nothing, a b. A line of neighbours
  // has b < 0.05 a, and so a b / (a + b)^2 below 0.05 / 1.05^2.
  const Doubles trace = xx + yy + zz, adjugate_trace = a + d + f;
  const DoublesMask is_plane = (n >= 5.0) & (adjugate_trace > 0.05 / (1.05 * 1.05) * trace * trace);
  const Doubles scale = 1.0 / adjugate_trace;
  a *= scale, b *= scale, c *= scale, d *= scale, e *= scale, f *= scale;
  const DoublesMask second = d > a;
  x = second ? b : a, y = second ? d : b, z = second ? e : c;
  const DoublesMask third = f > (second ? d : a);
  x = third ? c : x, y = third ? e : y, z = third ? f : z;
  for (int power = 0; power < 4; ++power) {
    const Doubles x_next = a * x + b * y + c * z, y_next = b * x + d * y + e * z;
    z = c * x + e * y + f * z, x = x_next, y = y_next;
  }
  for (std::size_t k = 0; k < kPlanes; ++k) {
    if (!is_plane[k]) {
      normals[k] = cloud::Point::Zero();
      continue;
    }
    const cloud::Point normal = Vec3(x[k], y[k], z[k]).normalized().cast<float>();
    normals[k] = normal.dot(to_viewpoint[k]) < 0.0f ? cloud::Point(-normal) : normal;
  }
}

}  // namespace

std::vector<cloud::Point> estimate_normals(const ViewProjection& projection, std::span<const cloud::Point> points,
                                           double radius, std::size_t stride,
                                           std::span<const cloud::Point> viewpoints) {
  std::vector<cloud::Point> normals((points.size() + stride - 1) / stride, cloud::Point::Zero());
  if (points.empty()) return normals;
  const Neighborhoods neighborhoods(projection, points, radius);
  std::vector<std::uint32_t> left = neighborhoods.order();
  std::erase_if(left, [&](std::uint32_t i) { return i % stride != 0; });
  // Where the surface is seen at a flat angle, rows of points that are neighbours in the view lie far apart in space:
  // a wider ball about the same part of the view finds them.
  for (float wider = 1.0f; wider <= 4.0f; wider *= 2.0f) {
    for_ranges_in_parallel(left.size(), [&](std::size_t begin, std::size_t end) {
      Neighborhoods::Window window(neighborhoods);
      std::array<Moments, kPlanes> moments;
      std::array<cloud::Point, kPlanes> to_viewpoint, found;
      for (std::size_t first = begin; first < end; first += kPlanes) {
        const std::size_t count = std::min(kPlanes, end - first);
        for (std::size_t k = 0; k < kPlanes; ++k) {
          const std::uint32_t i = left[first + std::min(k, count - 1)];
          moments[k] = window.around(i, wider);
          to_viewpoint[k] = viewpoint_of(i, viewpoints, projection) - points[i];
        }
        plane_normals(moments, to_viewpoint, found);
        for (std::size_t k = 0; k < count; ++k) normals[left[first + k] / stride] = found[k];
      }
    });
    std::erase_if(left, [&](std::uint32_t i) { return !normals[i / stride].isZero(); });
  }
  return normals;
}

std::vector<int> count_neighbors(const ViewProjection& projection, std::span<const cloud::Point> points,
                                 double radius) {
  std::vector<int> counts(points.size(), 0);
  const Neighborhoods neighborhoods(projection, points, radius);
  for_ranges_in_parallel(points.size(), [&](std::size_t first, std::size_t last) {
    Neighborhoods::Window window(neighborhoods);
    for (const std::uint32_t i : std::span(neighborhoods.order()).subspan(first, last - first))
      counts[i] = static_cast<int>(window.around(i, 1.0f).count);
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
