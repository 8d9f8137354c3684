#include "modeling/input/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/lanes.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

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

/// Indices of every so many of the cloud's points.
std::vector<std::uint32_t> every(std::size_t stride, const FilteredCloud& cloud) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < cloud.points.size(); i += stride) indices.push_back(static_cast<std::uint32_t>(i));
  return indices;
}

}  // namespace

SurfaceNormals::SurfaceNormals(const FilteredCloud& cloud, const ViewProjection& projection, double radius)
    : cloud_(cloud), projection_(projection), radius_(radius), neighborhoods_(projection, cloud.points, radius) {}

TangentPlanes SurfaceNormals::planes_at(std::span<const std::uint32_t> indices) const {
  TangentPlanes planes{.normals = std::vector<cloud::Point>(indices.size(), cloud::Point::Zero()),
                       .middles = std::vector<cloud::Point>(indices.size(), cloud::Point::Zero())};
  std::vector<std::uint32_t> left(indices.size());  // positions in `indices`
  std::iota(left.begin(), left.end(), 0U);
  // Where the surface is seen at a flat angle, rows of points that are neighbours in the view lie far apart in space:
  // a wider ball about the same part of the view finds them.
  for (float wider = 1.0f; wider <= 4.0f; wider *= 2.0f) {
    for_ranges_in_parallel(left.size(), [&](std::size_t begin, std::size_t end) {
      Neighborhoods::Window window(neighborhoods_, radius_);
      std::array<Moments, kPlanes> moments;
      std::array<cloud::Point, kPlanes> to_viewpoint, found;
      for (std::size_t first = begin; first < end; first += kPlanes) {
        const std::size_t count = std::min(kPlanes, end - first);
        for (std::size_t k = 0; k < kPlanes; ++k) {
          const std::uint32_t i = indices[left[first + std::min(k, count - 1)]];
          moments[k] = window.moments_around(i, wider);
          to_viewpoint[k] = viewpoint_of(i, cloud_.viewpoints, projection_) - cloud_.points[i];
        }
        plane_normals(moments, to_viewpoint, found);
        for (std::size_t k = 0; k < count; ++k) {
          const std::uint32_t position = left[first + k];
          planes.normals[position] = found[k];
          planes.middles[position] = cloud_.points[indices[position]] + moments[k].mean().cast<float>();
        }
      }
    });
    std::erase_if(left, [&](std::uint32_t k) { return !planes.normals[k].isZero(); });
  }
  return planes;
}

std::vector<std::uint32_t> SurfaceNormals::around(std::uint32_t point, double reach) const {
  return Neighborhoods::Window(neighborhoods_, reach).points_around(point);
}

void add_normals(FilteredCloud& cloud, const ViewProjection& projection, double radius) {
  const SurfaceNormals surface(cloud, projection, normal_radius(cloud.spacing, radius));
  cloud.normals = surface.at(every(1, cloud));
}

FilteredCloud thinned(const FilteredCloud& cloud, double apart, const SurfaceNormals& normals) {
  const double wanted = std::round(std::pow(apart / cloud.spacing, 2));
  // Points in one place have no spacing.
  const double stride_max = static_cast<double>(std::max<std::size_t>(cloud.points.size(), 1));
  const auto stride = wanted >= 1.0 ? static_cast<std::size_t>(std::min(wanted, stride_max)) : std::size_t{1};
  const std::vector<std::uint32_t> selected = every(stride, cloud);
  const auto select = [&](const auto& all) {
    std::remove_cvref_t<decltype(all)> some;
    if (!all.empty())
      for (const std::uint32_t i : selected) some.push_back(all[i]);
    return some;
  };
  return {.source = select(cloud.source),
          .points = select(cloud.points),
          .normals = normals.at(selected),
          .spacing = cloud.spacing * std::sqrt(static_cast<double>(stride)),
          .viewpoints = select(cloud.viewpoints)};
}

}  // namespace tubebin::modeling
