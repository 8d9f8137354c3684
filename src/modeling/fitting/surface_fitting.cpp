#include "modeling/fitting/surface_fitting.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "modeling/median.hpp"

namespace tubebin::modeling {
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

/// A node's part of the normal equations, which tie each node to the next alone.
struct NodeEquation {
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d with_next = Eigen::Matrix3d::Zero();
  Vec3 pull = Vec3::Zero();
};

/// By elimination from the first node to the last and back (block Thomas algorithm), in time that grows with their number.
std::vector<Vec3> solve(std::vector<NodeEquation> equations) {
  std::vector<Vec3> moves(equations.size());
  std::vector<Eigen::LDLT<Eigen::Matrix3d>> factors;
  for (std::size_t k = 0; k < equations.size(); ++k) {
    if (k > 0) {
      const NodeEquation& before = equations[k - 1];
      equations[k].own -= before.with_next.transpose() * factors.back().solve(before.with_next);
      equations[k].pull -= before.with_next.transpose() * factors.back().solve(before.pull);
    }
    factors.emplace_back(equations[k].own);
  }
  for (std::size_t k = equations.size(); k-- > 0;) {
    const bool is_last = k + 1 == equations.size();
    moves[k] =
        factors[k].solve(is_last ? equations[k].pull : Vec3(equations[k].pull - equations[k].with_next * moves[k + 1]));
  }
  return moves;
}

/// One damped Gauss-Newton step; returns the largest move of a node.
double step(std::vector<Vec3>& nodes, const std::vector<Foot>& feet, double radius, double cutoff) {
  std::vector<NodeEquation> equations(nodes.size());
  double total_weight = 0.0;
  for (const Foot& foot : feet) {
    const double residual = (foot.distance - radius) / cutoff;
    if (foot.beyond || std::abs(residual) >= 1.0) continue;
    const double tukey = (1.0 - residual * residual) * (1.0 - residual * residual);
    total_weight += tukey;
    // The distance's derivative is -(1 - t) outward by the start node and -t outward by the end node.
    const double a = 1.0 - foot.t, b = foot.t;
    const Eigen::Matrix3d outer = tukey * foot.outward * foot.outward.transpose();
    const Vec3 pull = tukey * (foot.distance - radius) * foot.outward;
    NodeEquation &start = equations[foot.cylinder], &end = equations[foot.cylinder + 1];
    start.own += a * a * outer;
    start.with_next += a * b * outer;
    end.own += b * b * outer;
    start.pull += a * pull;
    end.pull += b * pull;
  }
  // A thousandth of a node's share of the weight: nothing to what points determine, all where they determine nothing.
  const double damping = 1e-3 * std::max(total_weight, 1.0) / static_cast<double>(nodes.size());
  for (NodeEquation& equation : equations) equation.own.diagonal().array() += damping;
  const std::vector<Vec3> moves = solve(std::move(equations));
  double largest = 0.0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    nodes[k] += moves[k];
    largest = std::max(largest, moves[k].norm());
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

}  // namespace tubebin::modeling
