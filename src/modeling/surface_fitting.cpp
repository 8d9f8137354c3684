#include "tubebin/modeling/surface_fitting.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "modeling/median.hpp"

namespace tubebin {
namespace {

/// Where a point stands relative to the polyline.
struct Foot {
  std::size_t cylinder = 0;
  double t = 0.0;               ///< 0 at the cylinder's start, 1 at its end
  double distance = 0.0;        ///< from the axis, metres
  Vec3 outward = Vec3::Zero();  ///< unit, from the axis to the point
  bool beyond = false;          ///< past the polyline's first or last node
};

/// A cylinder's axis, ready for the many points.
struct Axis {
  Vec3 start, along;
  double inverse_squared;  ///< 1 / length^2

  double place_of(const Vec3& p) const { return (p - start).dot(along) * inverse_squared; }
  double squared_distance(const Vec3& p) const {
    const Vec3 offset = p - start;
    const double t = std::clamp(offset.dot(along) * inverse_squared, 0.0, 1.0);
    return (offset - t * along).squaredNorm();
  }
};

std::vector<Axis> axes_of(const std::vector<Vec3>& nodes) {
  std::vector<Axis> axes;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 along = nodes[k + 1] - nodes[k];
    axes.push_back({nodes[k], along, 1.0 / std::max(along.squaredNorm(), 1e-18)});
  }
  return axes;
}

/// On the nearest of the cylinders [first, last).
Foot nearest_foot(const std::vector<Axis>& axes, const Vec3& p, std::size_t first, std::size_t last) {
  std::size_t best = first;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = first; k < last; ++k) {
    const double squared = axes[k].squared_distance(p);
    if (squared < nearest) nearest = squared, best = k;
  }
  const Axis& axis = axes[best];
  const double t = axis.place_of(p);
  Foot foot{.cylinder = best, .t = std::clamp(t, 0.0, 1.0)};
  foot.beyond = (best == 0 && t < 0.0) || (best + 1 == axes.size() && t > 1.0);
  foot.distance = std::sqrt(nearest);
  foot.outward = (p - axis.start - foot.t * axis.along) / std::max(foot.distance, 1e-12);
  return foot;
}

/// As the nodes move little from step to step, a point's foot stays on its cylinder or goes to one beside it.
Foot follow_foot(const std::vector<Axis>& axes, const Vec3& p, std::size_t cylinder) {
  return nearest_foot(axes, p, cylinder == 0 ? 0 : cylinder - 1, std::min(cylinder + 2, axes.size()));
}

/// Robust standard deviation of the residuals about zero: 1.4826 times their median size.
double robust_sigma(const std::vector<Foot>& feet, double radius) {
  std::vector<double> sizes;
  sizes.reserve(feet.size());
  for (const Foot& foot : feet)
    if (!foot.beyond) sizes.push_back(std::abs(foot.distance - radius));
  return sizes.empty() ? 0.0 : 1.4826 * median(sizes);
}

/// One damped Gauss-Newton step; returns the largest move of a node.
double step(std::vector<Vec3>& nodes, const std::vector<Foot>& feet, double radius, double cutoff) {
  const auto n = static_cast<Eigen::Index>(3 * nodes.size());
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  double total_weight = 0.0;
  for (const Foot& foot : feet) {
    const double residual = (foot.distance - radius) / cutoff;
    if (foot.beyond || std::abs(residual) >= 1.0) continue;
    const double tukey = (1.0 - residual * residual) * (1.0 - residual * residual);
    total_weight += tukey;
    // The distance's derivative is -(1 - t) outward by the start node and -t outward by the end node.
    const double a = 1.0 - foot.t, b = foot.t;
    const Eigen::Matrix3d outer = tukey * foot.outward * foot.outward.transpose();
    const auto i = static_cast<Eigen::Index>(3 * foot.cylinder);
    hessian.block<3, 3>(i, i) += a * a * outer;
    hessian.block<3, 3>(i, i + 3) += a * b * outer;
    hessian.block<3, 3>(i + 3, i + 3) += b * b * outer;
    const Vec3 pull = tukey * (foot.distance - radius) * foot.outward;
    gradient.segment<3>(i) += a * pull;
    gradient.segment<3>(i + 3) += b * pull;
  }
  // A thousandth of a node's share of the weight: nothing to what points determine, all where they determine nothing.
  hessian.diagonal().array() += 1e-3 * std::max(total_weight, 1.0) / static_cast<double>(nodes.size());
  const Eigen::VectorXd move = hessian.selfadjointView<Eigen::Upper>().ldlt().solve(gradient);
  double largest = 0.0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Vec3 delta = move.segment<3>(static_cast<Eigen::Index>(3 * k));
    nodes[k] += delta;
    largest = std::max(largest, delta.norm());
  }
  return largest;
}

}  // namespace

SurfaceFit fit_surface(std::vector<Vec3>& nodes, std::span<const SurfacePoint> points, double radius) {
  constexpr int kMostSteps = 12;
  const double enough = 1e-3 * radius;  // a hundredth of what a scanner resolves of such a tube
  std::vector<Foot> feet(points.size());
  double sigma = 0.0;
  for (int i = 0;; ++i) {
    const std::vector<Axis> axes = axes_of(nodes);
    for (std::size_t k = 0; k < points.size(); ++k)
      feet[k] = i == 0 ? nearest_foot(axes, points[k].position, 0, axes.size())
                       : follow_foot(axes, points[k].position, feet[k].cylinder);
    sigma = robust_sigma(feet, radius);
    // Tukey's constant for 95 % efficiency; never so narrow that float rounding decides, never wider than half the
    // radius, beyond which a point is not on this surface.
    const double cutoff = std::clamp(4.685 * sigma, 1e-3 * radius, 0.5 * radius);
    if (i == kMostSteps || step(nodes, feet, radius, cutoff) < enough) break;
  }
  std::size_t inliers = 0;
  const double band = std::max(3.0 * sigma, 1e-3 * radius);
  for (const Foot& foot : feet)
    if (std::abs(foot.distance - radius) <= band) ++inliers;
  return {.sigma = sigma, .inliers = points.empty() ? 0.0 : double(inliers) / double(points.size())};
}

namespace {

/// The cylinder from a tube's last node on, while it is being fitted: `tip` is where it leads.
struct NextCylinder {
  Vec3 start;
  Vec3 tip;
  double radius;

  /// Whether the point lies on the side, within `band` of the surface, its normal within 30 degrees of straight out.
  bool supports(const SurfacePoint& point, double band, double& along) const {
    const Vec3 axis = tip - start;
    const double length = axis.norm();
    const Vec3 offset = point.position - start;
    along = offset.dot(axis) / length;
    if (along < 0.0 || along > length) return false;
    const Vec3 out = offset - along / length * axis;
    const double distance = out.norm();
    return std::abs(distance - radius) < band && point.normal.dot(out) > 0.87 * distance;
  }

  bool is_on_side(const SurfacePoint& point, double band, double& along) const {
    const Vec3 axis = (tip - start).normalized();
    const Vec3 offset = point.position - start;
    along = offset.dot(axis);
    const Vec3 out = offset - along * axis;
    const double distance = out.norm();
    return along >= 0.0 && along <= (tip - start).norm() && std::abs(distance - radius) < band &&
           point.normal.dot(out) > 0.5 * distance;
  }

  /// Gauss-Newton on the tip alone, the start held fast.
  void fit(const std::vector<SurfacePoint>& points) {
    // The band narrows from what a bend of 45 degrees can put a point off to what the normals' noise leaves.
    for (const double band : {0.5, 0.5, 0.35, 0.25, 0.15, 0.15}) {
      Eigen::Matrix3d hessian = 1e-3 * Eigen::Matrix3d::Identity();
      Vec3 gradient = Vec3::Zero();
      const Vec3 axis = tip - start;
      for (const SurfacePoint& point : points) {
        const double t = (point.position - start).dot(axis) / axis.squaredNorm();
        if (t < 0.0 || t > 1.0) continue;
        const Vec3 out = point.position - start - t * axis;
        const double distance = out.norm();
        const double residual = (distance - radius) / (band * radius);
        if (std::abs(residual) >= 1.0 || point.normal.dot(out) < 0.85 * distance) continue;
        const double tukey = (1.0 - residual * residual) * (1.0 - residual * residual);
        const Vec3 outward = out / distance;
        hessian += tukey * t * t * outward * outward.transpose();
        gradient += tukey * t * (distance - radius) * outward;
      }
      const double length = axis.norm();
      tip = start + (axis + hessian.ldlt().solve(gradient)).normalized() * length;
    }
  }
};

}  // namespace

namespace {

/// How far points on the cylinder's side reach without a gap of three rows, and how many they are.
struct Support {
  double reach = 0.0;
  std::size_t points = 0;

  Support(std::vector<double> along, double row) {
    std::sort(along.begin(), along.end());
    for (const double a : along) {
      if (a > reach + 3.0 * row) break;
      reach = a;
      ++points;
    }
  }
  /// Whether at least this part of a fully visible side is there.
  bool enough(double part, double radius, double spacing, double row) const {
    return reach >= spacing && static_cast<double>(points) >= part * 2.0 * radius * reach / (spacing * row);
  }
};

/// The points about a place that moves on by steps shorter than a radius, gathered anew where it has moved far. The
/// loose ones stand in order of x.
class PointsAbout {
 public:
  PointsAbout(std::span<const SurfacePoint> own, std::span<const SurfacePoint> loose, double radius)
      : own_(own), loose_(loose), radius_(radius) {}

  /// At least those within two radii.
  const std::vector<SurfacePoint>& near(const Vec3& place) {
    if (!((place - gathered_about_).norm() <= 4.0 * radius_)) {
      gathered_about_ = place;
      gathered_.clear();
      for (const auto& points : {own_, loose_about(place)})
        for (const SurfacePoint& point : points)
          if ((point.position - place).squaredNorm() < kReach * kReach * radius_ * radius_) gathered_.push_back(point);
    }
    return gathered_;
  }

 private:
  static constexpr double kReach = 6.0;  ///< radii

  std::span<const SurfacePoint> loose_about(const Vec3& place) const {
    const auto x_of = [](const SurfacePoint& point) { return point.position.x(); };
    const auto first = std::ranges::lower_bound(loose_, place.x() - kReach * radius_, {}, x_of);
    const auto last = std::ranges::upper_bound(first, loose_.end(), place.x() + kReach * radius_, {}, x_of);
    return {first, last};
  }

  std::span<const SurfacePoint> own_, loose_;
  double radius_;
  Vec3 gathered_about_ = Vec3::Constant(std::numeric_limits<double>::infinity());
  std::vector<SurfacePoint> gathered_;
};

/// Whether a new node would lie where the tube has been: within a radius of what is two radii back along it.
bool meets_itself(const std::vector<Vec3>& nodes, const Vec3& next, double radius) {
  double back = (next - nodes.back()).norm();
  for (std::size_t i = nodes.size(); i-- > 1;) {
    if (back > 2.0 * radius && (next - nodes[i]).norm() < radius) return true;
    const Vec3 axis = nodes[i - 1] - nodes[i];
    const double t = std::clamp((next - nodes[i]).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    if (back + t * axis.norm() > 2.0 * radius && (next - nodes[i] - t * axis).norm() < radius) return true;
    back += axis.norm();
  }
  return false;
}

}  // namespace

void grow_end(std::vector<Vec3>& nodes, std::span<const SurfacePoint> own, std::span<const SurfacePoint> loose,
              double radius, double spacing, const Vec3& viewpoint) {
  constexpr int kMostSteps = 1000;
  PointsAbout points(own, loose, radius);
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 direction = (nodes.back() - nodes[nodes.size() - 2]).normalized();
    NextCylinder next{.start = nodes.back(), .tip = nodes.back() + radius * direction, .radius = radius};
    std::vector<SurfacePoint> close;
    for (const SurfacePoint& point : points.near(next.start)) {
      const Vec3 offset = point.position - next.start;
      if (offset.squaredNorm() < 3.0 * radius * radius && offset.dot(direction) > -0.7 * radius) close.push_back(point);
    }
    next.fit(close);
    const Vec3 forward = (next.tip - next.start).normalized();
    // Rows of points lie the farther apart along the tube the more it points at the scanner.
    const double sine = forward.cross((viewpoint - next.start).normalized()).norm();
    const double row = spacing / std::max(sine, 3.0 * spacing / radius);
    std::vector<double> on_side, near_side;
    double at = 0.0;
    for (const SurfacePoint& point : close)
      if (next.supports(point, 0.15 * radius, at)) on_side.push_back(at);
    const Support sure(std::move(on_side), row);
    const bool sharp = forward.dot(direction) < 0.64;  // 50 degrees within a radius: no tube, but another one
    if (!sharp && !meets_itself(nodes, next.start + sure.reach * forward, radius) &&
        sure.enough(0.15, radius, spacing, row)) {
      nodes.push_back(next.start + sure.reach * forward);
      continue;
    }
    // Near a flat end's rim the normals lean toward the end's: there the places alone have to do.
    next.tip = next.start + radius * direction;
    for (const SurfacePoint& point : close)
      if (next.is_on_side(point, 0.05 * radius, at)) near_side.push_back(at);
    const Support rim(std::move(near_side), row);
    if (rim.enough(0.15, radius, spacing, row)) nodes.back() += rim.reach * direction;
    break;
  }
  // The last row stands for half the way to the next, which is not there.
  nodes.back() += spacing / 2.0 * (nodes.back() - nodes[nodes.size() - 2]).normalized();
}

}  // namespace tubebin
