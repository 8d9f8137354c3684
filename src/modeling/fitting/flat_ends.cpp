#include "modeling/fitting/flat_ends.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "modeling/labeling.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kParallel = 0.94;  // the cosine of 20 degrees

struct FlatEnd {
  Vec3 center = Vec3::Zero();
  Vec3 outward = Vec3::Zero();  ///< unit
};

/// Points that no piece explains, in order of x.
class UnexplainedPoints {
 public:
  explicit UnexplainedPoints(const FilteredCloud& cloud) : spacing_(cloud.spacing) {
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      points_.push_back({cloud.points[i].cast<double>(), cloud.normals[i].cast<double>()});
    std::ranges::stable_sort(points_, {}, x_of);
  }

  double spacing() const { return spacing_; }
  std::vector<SurfacePoint> near(const Vec3& place, double reach) const {
    std::vector<SurfacePoint> found;
    for (auto point = std::ranges::lower_bound(points_, place.x() - reach, {}, x_of);
         point != points_.end() && point->position.x() <= place.x() + reach; ++point)
      if ((point->position - place).squaredNorm() < reach * reach) found.push_back(*point);
    return found;
  }

 private:
  static double x_of(const SurfacePoint& point) { return point.position.x(); }

  double spacing_;
  std::vector<SurfacePoint> points_;
};

/// The plane that most of the points near the end lie on, if it looks like a tube's flat end.
std::optional<FlatEnd> find_flat_end(const Vec3& tip, const Vec3& outward, const UnexplainedPoints& unexplained,
                                     double radius) {
  std::vector<SurfacePoint> near = unexplained.near(tip, 2.5 * radius);
  std::erase_if(near, [&](const SurfacePoint& point) { return point.normal.dot(outward) <= 0.5; });
  // A tenth of the disc, at the density of points seen straight on, is enough to tell a plane.
  const double least = std::max(points_of_flat_end(radius, unexplained.spacing()) / 10.0, 5.0);
  if (static_cast<double>(near.size()) < least) return std::nullopt;

  FlatEnd end{.center = tip, .outward = outward};
  Vec3 mean = Vec3::Zero();
  for (const auto& [point, normal] : near) mean += normal;
  end.outward = mean.normalized();
  std::vector<Vec3> on_plane;
  for (int round = 0; round < 3; ++round) {
    on_plane.clear();
    mean.setZero();
    for (const auto& [point, normal] : near)
      if (normal.dot(end.outward) > kParallel) {
        on_plane.push_back(point);
        mean += normal;
      }
    if (static_cast<double>(on_plane.size()) < least) return std::nullopt;
    end.outward = mean.normalized();
  }
  Vec3 center = Vec3::Zero();
  for (const Vec3& p : on_plane) center += p / static_cast<double>(on_plane.size());
  for (const Vec3& p : on_plane)
    if ((p - center).norm() > 1.5 * radius || std::abs((p - center).dot(end.outward)) > 0.3 * radius)
      return std::nullopt;
  end.center = center;
  return end;
}

/// Polylines that end in the flat end: the last cylinder made longer or shorter, straight from one of the last nodes,
/// or with a joint where the flat end's axis passes nearest to the cylinder before. Only nodes near the end may go or
/// move.
std::vector<std::vector<Vec3>> possible_courses(const std::vector<Vec3>& nodes, const FlatEnd& end, double radius) {
  std::vector<std::vector<Vec3>> courses;
  const Vec3 last = (nodes.back() - nodes[nodes.size() - 2]).normalized();
  if (last.dot(end.outward) > 0.64) {
    courses.push_back(nodes);
    courses.back().back() += (end.center - nodes.back()).dot(end.outward) / last.dot(end.outward) * last;
  }
  const auto is_near = [&](std::size_t k) { return (nodes[k] - nodes.back()).norm() < 3.0 * radius; };
  const std::size_t first = nodes.size() > 4 ? nodes.size() - 4 : 1;
  for (std::size_t keep = first; keep <= nodes.size(); ++keep) {
    std::vector<Vec3> course(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(keep));
    const Vec3 straight = end.center - course.back();
    if ((keep == nodes.size() || is_near(keep)) && straight.norm() > radius &&
        straight.normalized().dot(end.outward) > 0.64) {
      courses.push_back(course);
      courses.back().push_back(end.center);
    }
    if (keep < 2 || !is_near(keep - 1)) continue;
    // The nearest points of two lines: Eberly 2000.
    const Vec3 u = (course[keep - 1] - course[keep - 2]).normalized(), v = -end.outward;
    const Vec3 w = course[keep - 1] - end.center;
    const double b = u.dot(v), d = u.dot(w), e = v.dot(w), slope = 1.0 - b * b;
    if (slope < 1e-3) continue;
    const double back = (e - b * d) / slope;
    if (back < radius || back > 8.0 * radius) continue;
    const Vec3 joint = end.center + back * v;
    if ((joint - course[keep - 2]).dot(u) < 0.0) continue;
    course.back() = joint;
    course.push_back(end.center);
    courses.push_back(std::move(course));
  }
  return courses;
}

std::size_t count_explained(const std::vector<Vec3>& nodes, const std::vector<Vec3>& points, double radius) {
  const std::size_t first = nodes.size() > 5 ? nodes.size() - 5 : 0;
  const TubeSurface surface{std::span(nodes).subspan(first), radius};
  const std::vector<double> distances = distances_to_surface(surface, points);
  return static_cast<std::size_t>(
      std::count_if(distances.begin(), distances.end(), [&](double d) { return std::abs(d) < radius / 20.0; }));
}

void fit_last_end(TubePiece& piece, const FilteredCloud& cloud, const UnexplainedPoints& unexplained) {
  const double radius = piece.radius;
  const Vec3 tip = piece.nodes.back();
  const auto end = find_flat_end(tip, (tip - piece.nodes[piece.nodes.size() - 2]).normalized(), unexplained, radius);
  if (!end) return;
  std::vector<Vec3> near;
  const double reach = 5.0 * radius;
  for (const std::uint32_t i : piece.points)
    if (const Vec3 p = cloud.points[i].cast<double>(); (p - tip).norm() < reach) near.push_back(p);
  for (const auto& [point, normal] : unexplained.near(tip, reach)) near.push_back(point);

  std::size_t most = count_explained(piece.nodes, near, radius);
  for (auto& course : possible_courses(piece.nodes, *end, radius)) {
    const std::size_t count = count_explained(course, near, radius);
    if (count <= most) continue;
    most = count;
    piece.nodes = std::move(course);
  }
}

/// The surface whose normals are parallel to the one that most are parallel to.
std::vector<SurfacePoint> mostly_parallel(std::span<const SurfacePoint> surface) {
  constexpr std::size_t kTries = 32;
  std::vector<SurfacePoint> most;
  for (std::size_t i = 0; i < surface.size(); i += surface.size() / kTries + 1) {
    std::vector<SurfacePoint> parallel;
    std::ranges::copy_if(surface, std::back_inserter(parallel),
                         [&](const SurfacePoint& other) { return other.normal.dot(surface[i].normal) > kParallel; });
    if (parallel.size() > most.size()) most = std::move(parallel);
  }
  return most;
}

/// Of an even spread of points: the width of a rectangle that is spread as far, across its longer side.
double width_of(std::span<const SurfacePoint> surface, const Vec3& center) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [point, normal] : surface) covariance += (point - center) * (point - center).transpose();
  covariance /= static_cast<double>(surface.size());
  return std::sqrt(12.0 * Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[1]);
}

}  // namespace

std::vector<Vec3> axis_of_flat_end(std::span<const SurfacePoint> surface, double radius) {
  const std::vector<SurfacePoint> plane = mostly_parallel(surface);
  if (2 * plane.size() < surface.size()) return {};
  Vec3 center = Vec3::Zero(), outward = Vec3::Zero();
  for (const auto& [point, normal] : plane) center += point, outward += normal;
  center /= static_cast<double>(plane.size());
  // A side with such normals is a strip 2 r sin 20 degrees = 0.7 r wide.
  if (width_of(plane, center) < radius) return {};
  outward.normalize();
  double depth = radius;
  for (const auto& [point, normal] : surface) depth = std::max(depth, (center - point).dot(outward));
  return {center - depth * outward, center};
}

void fit_flat_ends(std::vector<TubePiece>& pieces, const FilteredCloud& cloud, const FilteredCloud& unexplained) {
  if (unexplained.points.empty()) return;
  const UnexplainedPoints points(unexplained);
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t k) {
    for (int end = 0; end < 2; ++end) {
      fit_last_end(pieces[k], cloud, points);
      std::ranges::reverse(pieces[k].nodes);
    }
  });
}

}  // namespace tubebin::modeling
