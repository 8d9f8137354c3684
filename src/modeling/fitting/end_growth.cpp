#include "modeling/fitting/end_growth.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/lanes.hpp"

namespace tubebin::modeling {
namespace {

/// Points about a tube's last node, where they are from it, for many at a time.
class PointsAboutEnd {
 public:
  void clear() { count_ = 0, blocks_.clear(); }
  void add(const cloud::Point& offset, const cloud::Point& normal) {
    // What fills the last block lies on every cylinder's axis, and so on no side.
    if (count_ % kLanes == 0) blocks_.push_back({});
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      blocks_.back().offset[axis][count_ % kLanes] = offset[axis];
      blocks_.back().normal[axis][count_ % kLanes] = normal[axis];
    }
    ++count_;
  }

  std::size_t count() const { return count_; }
  Vec3 offset(std::size_t i) const { return at(blocks_[i / kLanes].offset, i % kLanes); }
  Vec3 normal(std::size_t i) const { return at(blocks_[i / kLanes].normal, i % kLanes); }

  /// The Gauss-Newton sums of the robust (Tukey) squared distances to the side of a cylinder from the node along
  /// `axis`, by its far end: the Hessian's xx xy xz yy yz zz and the gradient's x y z. Points `band` metres off do not
  /// count; neither do those whose normal stands more than 32 degrees off straight out.
  TUBEBIN_WIDE void sum_up(const cloud::Point& axis, float radius, float band, std::array<float, 9>& sums) const {
    const Lanes zero = {};
    const Lanes axis_x = zero + axis.x(), axis_y = zero + axis.y(), axis_z = zero + axis.z();
    const float inverse_squared = 1.0f / axis.squaredNorm(), inverse_band = 1.0f / band;
    std::array<Lanes, 9> lanes = {};
    for (const Block& block : blocks_) {
      Lanes x, y, z, normal_x, normal_y, normal_z;
      load(x, block.offset[0]), load(y, block.offset[1]), load(z, block.offset[2]);
      load(normal_x, block.normal[0]), load(normal_y, block.normal[1]), load(normal_z, block.normal[2]);
      const Lanes t = (x * axis_x + y * axis_y + z * axis_z) * inverse_squared;
      x -= t * axis_x, y -= t * axis_y, z -= t * axis_z;
      Lanes distance = x * x + y * y + z * z;
      take_root(distance);
      const Lanes residual = (distance - radius) * inverse_band, left = 1.0f - residual * residual;
      const Lanes outward = x * normal_x + y * normal_y + z * normal_z;
      const Mask counts = (t >= 0.0f) & (t <= 1.0f) & (left > 0.0f) & (outward >= 0.85f * distance);
      const Lanes lever = left * left * t / distance;  // Tukey's weight times the distance's derivative's size
      const Lanes weight = (Lanes)((Mask)(lever * t / distance) & counts);
      const Lanes pull = (Lanes)((Mask)(lever * (distance - radius)) & counts);
      const Lanes weight_x = weight * x, weight_y = weight * y;
      lanes[0] += weight_x * x, lanes[1] += weight_x * y, lanes[2] += weight_x * z;
      lanes[3] += weight_y * y, lanes[4] += weight_y * z, lanes[5] += weight * z * z;
      lanes[6] += pull * x, lanes[7] += pull * y, lanes[8] += pull * z;
    }
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = sum_of(lanes[k]);
  }

 private:
  struct Block {
    float offset[3][kLanes], normal[3][kLanes];
  };
  static Vec3 at(const float (&coordinates)[3][kLanes], std::size_t lane) {
    return cloud::Point(coordinates[0][lane], coordinates[1][lane], coordinates[2][lane]).cast<double>();
  }

  std::vector<Block> blocks_;
  std::size_t count_ = 0;
};

/// The cylinder from a tube's last node on, while it is being fitted: `axis` leads to its far end.
struct NextCylinder {
  Vec3 axis;
  double radius;

  /// Whether the point lies on the side, within `band` of the surface, its normal's cosine with straight out at least
  /// `upright`; and where along the axis, metres.
  bool supports(const Vec3& offset, const Vec3& normal, double band, double upright, double& along) const {
    const double length = axis.norm();
    along = offset.dot(axis) / length;
    if (along < 0.0 || along > length) return false;
    const Vec3 out = offset - along / length * axis;
    const double distance = out.norm();
    return std::abs(distance - radius) < band && normal.dot(out) > upright * distance;
  }

  /// Where along the axis those points are.
  std::vector<double> supporting(const PointsAboutEnd& points, double band, double upright) const {
    std::vector<double> places;
    double along = 0.0;
    for (std::size_t i = 0; i < points.count(); ++i)
      if (supports(points.offset(i), points.normal(i), band, upright, along)) places.push_back(along);
    return places;
  }

  /// Gauss-Newton on the far end alone, the node held fast.
  void fit(const PointsAboutEnd& points) {
    // The band narrows from what a bend of 45 degrees can put a point off to what the normals' noise leaves.
    for (const double band : {0.5, 0.5, 0.35, 0.25, 0.15, 0.15}) {
      std::array<float, 9> s;
      points.sum_up(axis.cast<float>(), static_cast<float>(radius), static_cast<float>(band * radius), s);
      Eigen::Matrix3f hessian;
      hessian << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
      hessian += 1e-3f * Eigen::Matrix3f::Identity();
      const Vec3 move = hessian.cast<double>().ldlt().solve(Vec3(s[6], s[7], s[8]));
      axis = (axis + move).normalized() * axis.norm();
    }
  }
};

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

/// The points about a place that moves on by steps shorter than a radius, gathered anew where it has moved far.
class PointsAbout {
 public:
  PointsAbout(const FilteredCloud& cloud, std::span<const std::uint32_t> own, const LoosePoints& loose, double radius)
      : cloud_(cloud), own_(own), loose_(loose), radius_(radius) {}

  /// At least those within two radii.
  const std::vector<SurfacePoint>& near(const Vec3& place) {
    if (!((place - gathered_about_).norm() <= 4.0 * radius_)) {
      gathered_about_ = place;
      gathered_.clear();
      const double squared_reach = kGrowthReach * kGrowthReach * radius_ * radius_;
      for (const std::uint32_t i : own_) {
        const Vec3 position = cloud_.points[i].cast<double>();
        if ((position - place).squaredNorm() < squared_reach)
          gathered_.push_back({position, cloud_.normals[i].cast<double>()});
      }
      const auto owned = std::ssize(gathered_);
      loose_.for_each_about(place, [&](const SurfacePoint& point) {
        if ((point.position - place).squaredNorm() < squared_reach) gathered_.push_back(point);
      });
      // Sums of floats depend on the order, which must not depend on where strips begin.
      std::ranges::stable_sort(gathered_.begin() + owned, gathered_.end(), {},
                               [](const SurfacePoint& point) { return point.position.x(); });
    }
    return gathered_;
  }

 private:
  const FilteredCloud& cloud_;
  std::span<const std::uint32_t> own_;
  const LoosePoints& loose_;
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

void grow_end(std::vector<Vec3>& nodes, const FilteredCloud& cloud, std::span<const std::uint32_t> own,
              const LoosePoints& loose, double radius, const Vec3& viewpoint) {
  constexpr int kMostSteps = 1000;
  const double spacing = cloud.spacing;
  PointsAbout points(cloud, own, loose, radius);
  PointsAboutEnd close;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 direction = (nodes.back() - nodes[nodes.size() - 2]).normalized();
    close.clear();
    for (const SurfacePoint& point : points.near(nodes.back())) {
      const Vec3 offset = point.position - nodes.back();
      if (offset.squaredNorm() < 3.0 * radius * radius && offset.dot(direction) > -0.7 * radius)
        close.add(offset.cast<float>(), point.normal.cast<float>());
    }
    NextCylinder next{.axis = radius * direction, .radius = radius};
    next.fit(close);
    const Vec3 forward = next.axis.normalized();
    // Rows of points lie the farther apart along the tube the more it points at the scanner.
    const double sine = forward.cross((viewpoint - nodes.back()).normalized()).norm();
    const double row = spacing / std::max(sine, 3.0 * spacing / radius);
    const Support sure(next.supporting(close, 0.15 * radius, 0.87), row);
    const bool sharp = forward.dot(direction) < kSharpTurn;  // within a radius: no tube, but another one
    if (!sharp && !meets_itself(nodes, nodes.back() + sure.reach * forward, radius) &&
        sure.enough(0.15, radius, spacing, row)) {
      nodes.push_back(nodes.back() + sure.reach * forward);
      continue;
    }
    // Near a flat end's rim the normals lean toward the end's: there the places alone have to do.
    next.axis = radius * direction;
    const Support rim(next.supporting(close, 0.05 * radius, 0.5), row);
    if (rim.enough(0.15, radius, spacing, row)) nodes.back() += rim.reach * direction;
    break;
  }
  // The last row stands for half the way to the next, which is not there.
  nodes.back() += spacing / 2.0 * (nodes.back() - nodes[nodes.size() - 2]).normalized();
}

}  // namespace tubebin::modeling
