#include "modeling/steep_ends.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

#include "modeling/input/point_sample.hpp"
#include "modeling/path_ends.hpp"

namespace tubebin::modeling {
namespace {

/// Radii: the length of a step, and the distance from the tip within which its points are.
constexpr double kStep = 4.0, kNear = 5.0;
/// Of the angle between a tube's axis and the ray. Points in the air behind an edge are steeper; less steep sides have normals.
constexpr double kLeastSine = 0.04, kMostSine = 0.75;
constexpr std::size_t kFewPoints = 10;
constexpr int kMostSteps = 100;

/// From a tube's end on.
struct Cylinder {
  Vec3 start, axis;  ///< axis: leads to the far end
  double radius;

  double along(const Vec3& point) const { return (point - start).dot(axis) / axis.norm(); }
  double off(const Vec3& point) const { return (point - start).cross(axis.normalized()).norm(); }

  /// Turns the axis so that the points near its side lie on it: Gauss-Newton with Tukey's weights, the start held fast.
  void fit(std::span<const Vec3> points) {
    for (const double band : {0.8, 0.8, 0.5, 0.35, 0.25, 0.15}) {
      Eigen::Matrix3d hessian = 1e-3 * Eigen::Matrix3d::Identity();
      Vec3 pull = Vec3::Zero();
      for (const Vec3& point : points) {
        const double t = along(point) / axis.norm();
        const Vec3 out = point - start - t * axis;
        const double excess = out.norm() - radius, part = excess / (band * radius), left = 1.0 - part * part;
        if (t < 0.0 || t > 1.0 || left <= 0.0) continue;
        const Vec3 slope = t * out.normalized();
        hessian += left * left * slope * slope.transpose();
        pull += left * left * excess * slope;
      }
      axis = (axis + hessian.ldlt().solve(pull)).normalized() * axis.norm();
    }
  }
};

/// Looks for the sides of steep tubes of one radius.
class SteepSides {
 public:
  SteepSides(double radius, double spacing, const OcclusionTest& scan)
      : radius_(radius), spacing_(spacing), occlusion_(scan.with_radius(radius)) {}

  /// The cylinder that goes on from the tip and reaches farthest: from one end to the other, metres; zero where none is seen.
  /// `outward`: along the tube so far, unit. `points`: about the tip.
  Vec3 next(const Vec3& tip, const Vec3& outward, const Vec3& viewpoint, std::span<const Vec3> points) const {
    constexpr double kSharpest = -0.2;  // cosine of 102 degrees, of a tube that turns
    const Vec3 ray = (viewpoint - tip).normalized();
    Vec3 farthest = Vec3::Zero();
    for (const Vec3& direction : {outward, Vec3(outward + ray), Vec3(outward - ray), ray, Vec3(-ray)}) {
      Cylinder cylinder{.start = tip, .axis = kStep * radius_ * direction.normalized(), .radius = radius_};
      cylinder.fit(points);
      const Vec3 forward = cylinder.axis.normalized();
      const double sine = forward.cross(ray).norm();
      if (sine < kLeastSine || sine > kMostSine || forward.dot(outward) < kSharpest) continue;
      const double reach = reach_of(cylinder, spacing_ / sine, points);
      if (reach > std::max(radius_, farthest.norm()) && is_seen(cylinder, reach)) farthest = reach * forward;
    }
    return farthest;
  }

 private:
  /// How far points lie on its side without a gap, metres; 0 where they are few or more than a side has, or where others lie
  /// about its side. `row`: metres between points along it.
  double reach_of(const Cylinder& cylinder, double row, std::span<const Vec3> points) const {
    constexpr double kOnSide = 0.15, kAround = 1.5;  // radii
    std::vector<double> on_side, elsewhere;
    for (const Vec3& point : points) {
      const double along = cylinder.along(point), off = cylinder.off(point);
      if (along < 0.0 || along > cylinder.axis.norm() || off > kAround * radius_) continue;
      (std::abs(off - radius_) < kOnSide * radius_ ? on_side : elsewhere).push_back(along);
    }
    std::ranges::sort(on_side);
    double reach = 0.0, count = 0.0;
    for (const double along : on_side) {
      if (along > reach + 2.0 * row) break;
      reach = along, ++count;
    }
    // The flat end is at the farthest place of the side.
    const auto others = static_cast<double>(
        std::ranges::count_if(elsewhere, [&](double along) { return along < reach - kOnSide * radius_; }));
    const double full = 2.0 * radius_ * reach / (spacing_ * row);
    const bool is_side = count >= std::max(0.4 * full, double{kFewPoints}) && count < 3.0 * full;
    return is_side && others < count / 4.0 ? reach : 0.0;
  }

  /// Whether the scan shows a surface on most of its sides, and hardly sees through.
  bool is_seen(const Cylinder& cylinder, double reach) const {
    const Vec3 forward = cylinder.axis.normalized();
    double surface = 0.0, empty = 0.0, places = 0.0;
    for (double along = 0.5 * radius_; along < reach; along += radius_, ++places) {
      const StretchEvidence sides = occlusion_.sides(cylinder.start + along * forward, forward);
      surface += sides.surface, empty += sides.empty;
    }
    return surface > 0.6 * places && empty < 0.1 * places;
  }

  double radius_, spacing_;
  OcclusionTest occlusion_;
};

}  // namespace

bool reach_steep_ends(std::vector<TubeModel>& tubes, const FilteredCloud& cloud,
                      const std::vector<cloud::Label>& labels, const ViewProjection& projection,
                      const OcclusionTest& scan) {
  const Segment unlabeled = points_without_label(labels);
  const Segment first =
      about_ends(tubes, cloud.points, unlabeled, [](const TubeModel& tube) { return kNear * tube.radius; });
  bool any = false;
  for (TubeModel& tube : tubes) {
    const SteepSides sides(tube.radius, cloud.spacing, scan);
    for (TubePath& path : tube.paths)
      for (int end = 0; end < 2 && path.nodes.size() > 1; ++end) {
        turn_about(path);
        Segment beyond = near(path.nodes.back(), kNear * tube.radius, cloud.points, first);
        if (beyond.size() < kFewPoints) continue;
        const Vec3 viewpoint = viewpoint_of(cloud, beyond, projection);
        Vec3 outward = (path.nodes.back() - path.nodes[path.nodes.size() - 2]).normalized();
        for (int step = 0; step < kMostSteps; ++step) {
          const Vec3 next = sides.next(path.nodes.back(), outward, viewpoint, positions_at(cloud.points, beyond));
          if (next.isZero()) break;
          path.nodes.push_back(path.nodes.back() + next);
          path.bridged.push_back(false);
          any = true;
          outward = next.normalized();
          beyond = near(path.nodes.back(), kNear * tube.radius, cloud.points, unlabeled);
        }
      }
  }
  return any;
}

}  // namespace tubebin::modeling
