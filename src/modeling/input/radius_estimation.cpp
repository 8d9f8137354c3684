#include "modeling/input/radius_estimation.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "modeling/input/point_sample.hpp"
#include "modeling/parallel.hpp"
#include "modeling/sphere_fit.hpp"

namespace tubebin::modeling {
namespace {

/// Principal curvatures at a point, 1 / metres, ascending, and the direction of the least one.
struct Curvatures {
  double least = 0.0, most = 0.0;
  Vec3 axis = Vec3::Zero();
};

/// The symmetric 2 x 2 map from tangent offsets to changes of the normal `n`, by least squares over the point's neighbours within
/// four spacings, about fifty of them; where points lie far closer together than elsewhere, of some. Zeros where there are too few to
/// tell, or so many that it is no surface of points so far apart.
Curvatures curvatures_at(std::uint32_t point, const cloud::Point& n, const cloud::Point& middle,
                         const FilteredCloud& cloud, const SurfaceNormals& surface) {
  constexpr std::size_t kEnough = 200, kMost = 2000;
  const std::vector<std::uint32_t> all = surface.around(point, 4.0 * cloud.spacing);
  if (all.size() > kMost) return {};
  const std::vector<std::uint32_t> neighbors = some_of<std::uint32_t>(all, kEnough);
  const auto [normals, middles] = surface.planes_at(neighbors);
  const cloud::Point u = n.unitOrthogonal();
  const cloud::Point v = n.cross(u);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero(), turn = Eigen::Matrix2d::Zero();
  int count = 0;
  for (std::size_t k = 0; k < neighbors.size(); ++k) {
    if (normals[k].dot(n) <= 0.5f) continue;
    const cloud::Point q = middles[k] - middle, m = normals[k] - n;
    const Eigen::Vector2d offset(double(q.dot(u)), double(q.dot(v))), change(double(m.dot(u)), double(m.dot(v)));
    scatter += offset * offset.transpose();
    turn += change * offset.transpose();
    ++count;
  }
  if (count < 6 || scatter.determinant() <= 0.0) return {};
  const Eigen::Matrix2d shape = turn * scatter.inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal(0.5 * (shape + shape.transpose()));
  const Eigen::Vector2d least = principal.eigenvectors().col(0);
  return {.least = principal.eigenvalues()(0),
          .most = principal.eigenvalues()(1),
          .axis = least.x() * u.cast<double>() + least.y() * v.cast<double>()};
}

/// A radius and how much it counts: 1 / variance.
struct MeasuredRadius {
  double radius = 0.0, weight = 0.0;
};

/// Of the circle about the origin, more or less, that the points lie on.
MeasuredRadius fit_circle(const std::vector<Eigen::Vector2d>& points, double radius) {
  const FittedSphere<2> circle = fit_sphere<2>(points, {.center = Eigen::Vector2d::Zero(), .radius = radius});
  return {circle.radius, 1.0 / std::max(circle.radius_variance, 1e-18)};
}

/// Of the cylinders that are at least `least_length` long, metres.
std::vector<MeasuredRadius> measure_radii(const std::vector<TubePiece>& pieces, const std::vector<cloud::Point>& points,
                                          double radius, double least_length) {
  std::vector<MeasuredRadius> radii;
  for (const TubePiece& piece : pieces)
    for (std::size_t k = 0; k + 1 < piece.nodes.size(); ++k) {
      const Vec3 start = piece.nodes[k], along = piece.nodes[k + 1] - start;
      const double length = along.norm();
      if (length < least_length) continue;
      const Vec3 axis = along / length, u = axis.unitOrthogonal(), v = axis.cross(u);
      std::vector<Eigen::Vector2d> across;
      for (const std::uint32_t i : piece.points) {
        const Vec3 offset = points[i].cast<double>() - start;
        const double t = offset.dot(axis);
        const Eigen::Vector2d p(offset.dot(u), offset.dot(v));
        if (t >= 0.0 && t <= length && std::abs(p.norm() - radius) < radius / 4.0) across.push_back(p);
      }
      if (across.size() >= 30) radii.push_back(fit_circle(across, radius));
    }
  return radii;
}

/// The radius that as much weight lies below as above.
double weighted_median(std::vector<MeasuredRadius> radii) {
  std::sort(radii.begin(), radii.end(), [](const auto& a, const auto& b) { return a.radius < b.radius; });
  double half = 0.0;
  for (const MeasuredRadius& r : radii) half += r.weight / 2.0;
  std::size_t k = 0;
  for (double below = radii[0].weight; below < half; below += radii[k].weight) ++k;
  return radii[k].radius;
}

}  // namespace

CurvedPlaces find_curved_places(const FilteredCloud& cloud, const SurfaceNormals& surface, std::size_t count) {
  std::vector<std::uint32_t> looked_at;
  for (std::size_t i = 0; i < cloud.points.size(); i += cloud.points.size() / count + 1)
    looked_at.push_back(static_cast<std::uint32_t>(i));
  const TangentPlanes planes = surface.planes_at(looked_at);
  const std::vector<Curvatures> curvatures = map_in_parallel(looked_at.size(), [&](std::size_t k) {
    return planes.normals[k].isZero()
               ? Curvatures{}
               : curvatures_at(looked_at[k], planes.normals[k], planes.middles[k], cloud, surface);
  });
  CurvedPlaces places{.tubular = {}, .round = {}, .looked_at = looked_at.size()};
  for (std::size_t k = 0; k < looked_at.size(); ++k) {
    const auto& [least, most, axis] = curvatures[k];
    const Vec3 middle = planes.middles[k].cast<double>(), normal = planes.normals[k].cast<double>();
    if (most > 0.0 && std::abs(least) < 0.3 * most)
      places.tubular.push_back({.radius = 1.0 / most, .center = middle - normal / most, .axis = axis});
    if (least < 0.0 && std::abs(most) < -0.3 * least) ++places.hollow;
    if (least > 0.6 * most) {
      const double radius = 2.0 / (least + most);
      places.round.push_back({.center = middle - radius * normal, .radius = radius});
    }
  }
  return places;
}

bool is_tried(double radius, const std::vector<double>& tried) {
  return std::ranges::any_of(tried, [&](double other) { return std::abs(std::log(radius / other)) < 0.15; });
}

CommonRadius commonest_radius(const std::vector<TubularPlace>& places, const std::vector<double>& tried) {
  std::vector<double> radii;
  for (const TubularPlace& place : places)
    if (!is_tried(place.radius, tried)) radii.push_back(place.radius);
  std::ranges::sort(radii);
  CommonRadius common;
  for (std::size_t first = 0, last = 0; first < radii.size(); ++first) {
    while (last < radii.size() && radii[last] < 1.5 * radii[first]) ++last;
    if (last - first <= common.places) continue;
    common = {.radius = radii[first + (last - first) / 2], .places = last - first};
  }
  return common;
}

double refine_radius(const std::vector<TubePiece>& pieces, const std::vector<cloud::Point>& points, double radius) {
  std::vector<MeasuredRadius> radii = measure_radii(pieces, points, radius, 2.0 * radius);
  // Of rings and narrow bends, which have none so long.
  if (radii.empty()) radii = measure_radii(pieces, points, radius, radius);
  return radii.empty() ? radius : weighted_median(std::move(radii));
}

}  // namespace tubebin::modeling
