#include "modeling/fitting/cylinder_ransac.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

namespace tubebin::modeling {
namespace {

using Vec4f = Eigen::Vector4f;  ///< a Vec3f with a fourth of 0: four floats are one register

struct OrientedPoint {
  Vec4f position, normal;
};

struct Cylinder {
  Vec4f point, direction;
  float radius = 0.0f;
};

double distance_to_axis(const Vec4f& p, const Cylinder& cylinder) {
  const float squared = cylinder.direction.cross3(cylinder.point - p).squaredNorm() / cylinder.direction.squaredNorm();
  return std::sqrt(double(squared));
}

/// Its axis goes through both points' lines along their normals, where these are nearest to each other.
Cylinder cylinder_through(const OrientedPoint& p, const OrientedPoint& q) {
  const Vec4f &n = p.normal, &m = q.normal, w = n + p.position - q.position;
  const float nn = n.dot(n), nm = n.dot(m), mm = m.dot(m), nw = n.dot(w), mw = m.dot(w);
  const float determinant = nn * mm - nm * nm;
  float along_n = 0.0f, along_m = nm > mm ? nw / nm : mw / mm;  // of lines that are parallel
  if (double(determinant) >= 1e-8) {
    along_n = (nm * mw - mm * nw) / determinant;
    along_m = (nn * mw - nm * nw) / determinant;
  }
  Cylinder cylinder;
  cylinder.point = p.position + n + along_n * n;
  cylinder.direction = (q.position + along_m * m - cylinder.point).normalized();
  cylinder.radius = static_cast<float>(distance_to_axis(p.position, cylinder));
  return cylinder;
}

double angle_between(const Vec4f& a, const Vec4f& b) {
  return std::acos(std::clamp(double(a.normalized().dot(b.normalized())), -1.0, 1.0));
}

std::ptrdiff_t count_inliers(const std::vector<OrientedPoint>& points, const Cylinder& cylinder, double threshold) {
  constexpr double kNormalWeight = 0.05;
  const float offset = cylinder.point.dot(cylinder.direction), scale = 1.0f / cylinder.direction.squaredNorm();
  return std::ranges::count_if(points, [&](const OrientedPoint& p) {
    const double off =
        (1.0 - kNormalWeight) * std::abs(distance_to_axis(p.position, cylinder) - double(cylinder.radius));
    if (off > threshold) return false;
    const float along = (p.position.dot(cylinder.direction) - offset) * scale;
    const Vec4f outward = (p.position - (cylinder.point + along * cylinder.direction)).normalized();
    const double angle = angle_between(p.normal, outward);
    return off + kNormalWeight * std::min(angle, std::numbers::pi - angle) < threshold;
  });
}

/// Pairs of points in different places, drawn as PCL draws them.
class PairSampler {
 public:
  explicit PairSampler(const std::vector<OrientedPoint>& points) : points_(points), shuffled_(points.size()) {
    std::iota(shuffled_.begin(), shuffled_.end(), std::size_t{0});
  }

  /// False where the points seem to be all in one place.
  bool draw() {
    constexpr int kTrials = 1000;
    for (int trial = 0; trial < kTrials; ++trial) {
      for (std::size_t i = 0; i < 2; ++i)
        std::swap(shuffled_[i], shuffled_[i + (engine_() >> 1) % (shuffled_.size() - i)]);
      const Vec4f apart = first().position - second().position;
      if (apart.cwiseAbs().maxCoeff() > std::numeric_limits<float>::epsilon()) return true;
    }
    return false;
  }
  const OrientedPoint& first() const { return points_[shuffled_[0]]; }
  const OrientedPoint& second() const { return points_[shuffled_[1]]; }

 private:
  const std::vector<OrientedPoint>& points_;
  std::vector<std::size_t> shuffled_;
  std::mt19937 engine_{12345};
};

/// After so many samples, one of inliers alone was among them with a probability of 0.99.
double samples_needed(double inlier_part) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  return std::log(1.0 - 0.99) / std::log(std::clamp(1.0 - inlier_part * inlier_part, kEpsilon, 1.0 - kEpsilon));
}

}  // namespace

std::optional<AxisLine> search_cylinder(std::span<const cloud::Point> points, std::span<const cloud::Point> normals,
                                        const CylinderSearch& search) {
  if (points.size() < 2) return std::nullopt;
  const auto widened = [](const cloud::Point& p) { return Vec4f(p.x(), p.y(), p.z(), 0.0f); };
  std::vector<OrientedPoint> oriented;
  for (std::size_t i = 0; i < points.size(); ++i) oriented.push_back({widened(points[i]), widened(normals[i])});

  Cylinder best;
  std::ptrdiff_t most = 0;
  PairSampler sampler(oriented);
  int tried = 0, refused = 0;
  for (double needed = std::numeric_limits<double>::infinity(); tried <= std::min(needed, double(search.iterations));) {
    if (!sampler.draw()) break;
    const Cylinder cylinder = cylinder_through(sampler.first(), sampler.second());
    const double radius = cylinder.radius;
    if (radius > 1.2 * search.radius || radius < 0.8 * search.radius) {
      if (++refused < 10 * search.iterations) continue;
      break;
    }
    ++tried;
    const std::ptrdiff_t inliers = count_inliers(oriented, cylinder, search.inlier_distance);
    if (inliers <= most) continue;
    most = inliers;
    best = cylinder;
    needed = samples_needed(double(inliers) / double(points.size()));
  }
  if (most < 5) return std::nullopt;
  const Vec3 direction = best.direction.head<3>().cast<double>();
  return AxisLine{best.point.head<3>().cast<double>(), direction.normalized()};
}

}  // namespace tubebin::modeling
