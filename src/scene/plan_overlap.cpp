#include "scene/plan_overlap.hpp"

#include <array>
#include <cmath>

namespace tubebin::scene {
namespace {

using Vec2 = Eigen::Vector2d;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A point of each solid; their difference in plan view is a point of the solids' Minkowski difference.
struct Corner {
  Vec3 in_first;
  Vec3 in_second;

  Vec2 difference() const { return (in_second - in_first).head<2>(); }
  double height() const { return in_second.z() - in_first.z(); }
};

struct Edge {
  Corner a;
  Corner b;

  /// The parameter of the point next to the origin, from 0 at a to 1 at b.
  double nearest() const {
    const Vec2 along = b.difference() - a.difference();
    const double squared = along.squaredNorm();
    return squared > 0.0 ? std::clamp(-a.difference().dot(along) / squared, 0.0, 1.0) : 0.0;
  }
  Vec2 at(double t) const { return (1.0 - t) * a.difference() + t * b.difference(); }
  double height(double t) const { return (1.0 - t) * a.height() + t * b.height(); }
};

/// Height over the origin if the triangle holds it.
std::optional<double> height_in(const Edge& edge, const Corner& corner) {
  const Vec2 a = edge.a.difference(), b = edge.b.difference(), c = corner.difference();
  const double weight_a = cross(b, c), weight_b = cross(c, a), weight_c = cross(a, b);
  const double sum = weight_a + weight_b + weight_c;
  if (sum == 0.0 || weight_a * sum < 0.0 || weight_b * sum < 0.0 || weight_c * sum < 0.0) return std::nullopt;
  return (weight_a * edge.a.height() + weight_b * edge.b.height() + weight_c * corner.height()) / sum;
}

}  // namespace

Vec3 ConvexSolid::farthest(const Vec2& direction) const {
  const Vec3 d = Vec3(direction.x(), direction.y(), 0.0).normalized();
  const auto farthest_at = [&](int end) -> Vec3 {
    if (!flat_[end]) return ends_[end] + radius_ * d;
    const Vec3 across = d - d.dot(axis_) * axis_;
    const double length = across.norm();
    return length > 0.0 ? Vec3(ends_[end] + radius_ / length * across) : ends_[end];
  };
  const Vec3 a = farthest_at(0), b = farthest_at(1);
  return a.dot(d) >= b.dot(d) ? a : b;
}

Eigen::AlignedBox3d ConvexSolid::bounds() const {
  const Vec3 reach = Vec3::Constant(radius_);
  return {ends_[0].cwiseMin(ends_[1]) - reach, ends_[0].cwiseMax(ends_[1]) + reach};
}

// Gilbert, Johnson and Keerthi 1988 in two dimensions: the plan views overlap where their Minkowski difference holds
// the origin. Corners of it are added in the direction of the origin until three of them enclose it or one proves that
// none can.
std::optional<double> height_above(const ConvexSolid& first, const ConvexSolid& second) {
  constexpr int kIterations = 64;
  constexpr double kAtOrigin = 1e-12;  // metres
  const auto corner = [&](const Vec2& direction) {
    return Corner{first.farthest(-direction), second.farthest(direction)};
  };
  const Vec2 apart = (first.middle() - second.middle()).head<2>();
  const Corner start = corner(apart.norm() > kAtOrigin ? apart : Vec2(Vec2::UnitX()));
  Edge edge{start, start};
  for (int i = 0; i < kIterations; ++i) {
    const double t = edge.nearest();
    const Vec2 nearest = edge.at(t);
    if (nearest.norm() < kAtOrigin) return edge.height(t);
    const Corner next = corner(-nearest);
    if (next.difference().dot(nearest) > 0.0) return std::nullopt;
    if (const auto height = height_in(edge, next)) return height;
    const Edge with_a{edge.a, next}, with_b{next, edge.b};
    edge = with_a.at(with_a.nearest()).squaredNorm() < with_b.at(with_b.nearest()).squaredNorm() ? with_a : with_b;
  }
  return std::nullopt;  // they touch to within rounding
}

}  // namespace tubebin::scene
