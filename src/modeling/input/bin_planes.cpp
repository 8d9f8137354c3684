#include "modeling/input/bin_planes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "modeling/median.hpp"

namespace tubebin::modeling {
namespace {

constexpr int kTrials = 300;           ///< a wall of a tenth of the points is missed by chance once in e^3, some 20
constexpr std::size_t kSample = 3000;  ///< points: a plane's share of them is known to 1 %

constexpr double kSlantMax = 0.1;  ///< sine of a wall's slant, as moulded boxes have

std::vector<Vec3> sample_points(const ModelingInput& input) {
  std::vector<Vec3> finite;
  for (const cloud::Point& p : input.points)
    if (cloud::is_finite(p)) finite.push_back(p.cast<double>());
  std::vector<Vec3> sample;
  for (std::size_t i = 0; i < finite.size(); i += finite.size() / kSample + 1) sample.push_back(finite[i]);
  return sample;
}

struct Share {
  double on = 0.0, behind = 0.0;
};

/// How many of the points do not lie at the height above the floor that most of them share.
double count_off_rim(std::vector<double> heights, double tolerance) {
  if (heights.empty()) return 0.0;
  const double rim = median(heights);
  return static_cast<double>(
      std::count_if(heights.begin(), heights.end(), [&](double h) { return std::abs(h - rim) > tolerance; }));
}

/// Points on the plane and behind it, as shares. Behind a wall its own rim is in order: points at one height above
/// the `floor` (null for the floor itself).
Share share_of(const std::vector<Vec3>& sample, const BinPlane& plane, const BinPlane* floor, double tolerance) {
  Share share;
  std::vector<double> heights_behind;
  for (const Vec3& p : sample) {
    const double height = plane.height(p);
    if (std::abs(height) <= tolerance) share.on += 1.0;
    else if (height < 0.0 && floor) heights_behind.push_back(floor->height(p));
    else if (height < 0.0) share.behind += 1.0;
  }
  share.behind += count_off_rim(std::move(heights_behind), tolerance);
  const auto count = static_cast<double>(sample.size());
  return {share.on / count, share.behind / count};
}

/// The plane of least squares through the points near `plane`, its normal on the same side.
BinPlane refined(const std::vector<Vec3>& sample, const BinPlane& plane, double tolerance) {
  std::vector<Vec3> near;
  for (const Vec3& p : sample)
    if (std::abs(plane.height(p)) <= tolerance) near.push_back(p);
  if (near.size() < 3) return plane;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : near) mean += p / static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vec3& p : near) scatter += (p - mean) * (p - mean).transpose();
  BinPlane fitted{.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0)};
  if (fitted.normal.dot(plane.normal) < 0.0) fitted.normal = -fitted.normal;
  fitted.offset = fitted.normal.dot(mean);
  return fitted;
}

/// The best plane of those that `propose` makes of random sample points (its normal turned to `inside`), with at least
/// `share_min` of the points on it and at most 2 % of them behind it.
template <typename Propose>
std::optional<BinPlane> find_plane(const std::vector<Vec3>& sample, const Vec3& inside, const BinPlane* floor,
                                   double tolerance, double share_min, Random& random, const Propose& propose) {
  std::optional<BinPlane> best;
  double most = share_min;
  const int last = static_cast<int>(sample.size()) - 1;
  const auto pick = [&] { return sample[static_cast<std::size_t>(random.integer(0, last))]; };
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vec3 a = pick(), b = pick(), c = pick();
    const Vec3 normal = propose(a, b, c);
    if (normal.norm() < 1e-12) continue;
    BinPlane plane{.normal = normal.normalized()};
    plane.offset = plane.normal.dot(a);
    plane = refined(sample, plane, tolerance);
    if (floor && std::abs(plane.normal.dot(floor->normal)) > kSlantMax) continue;
    if (plane.height(inside) < 0.0) plane.normal = -plane.normal, plane.offset = -plane.offset;
    const Share share = share_of(sample, plane, floor, tolerance);
    if (share.on > most && share.behind < 0.02) most = share.on, best = plane;
  }
  return best;
}

}  // namespace

std::vector<BinPlane> find_bin_planes(const ModelingInput& input, const ViewProjection& projection, double tolerance,
                                      std::uint64_t seed) {
  std::vector<Vec3> sample = sample_points(input);
  if (sample.size() < 100) return {};
  Random random(derive_seed({seed, 0x62696e}));
  const Vec3 viewpoint = projection.viewpoint().cast<double>();
  // A layer of tubes has a tenth and more of its points near its top plane too, but most of the rest behind it.
  const auto floor = find_plane(sample, viewpoint, nullptr, tolerance, 0.1, random,
                                [](const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); });
  if (!floor) return {};
  std::vector<BinPlane> planes = {*floor};
  const auto inside = [&](const BinPlane& plane) {
    std::erase_if(sample, [&](const Vec3& p) { return plane.height(p) < tolerance; });
  };
  inside(*floor);
  for (int wall = 0; wall < 4 && sample.size() >= 100; ++wall) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : sample) middle += p / static_cast<double>(sample.size());
    // Walls stand on the floor: two points make one, where three would seldom lie on the same wall.
    const auto plane =
        find_plane(sample, middle, &*floor, tolerance, 0.03, random,
                   [&](const Vec3& a, const Vec3& b, const Vec3&) { return floor->normal.cross(b - a); });
    if (!plane) break;
    planes.push_back(*plane);
    inside(*plane);
  }
  return planes;
}

std::vector<std::uint32_t> crop_planes(const ModelingInput& input, const ViewProjection& projection,
                                       const FilteringOptions& options, std::uint64_t seed) {
  const std::vector<BinPlane> planes = find_bin_planes(input, projection, options.bin_margin, seed);
  std::vector<std::uint32_t> inside;
  for (std::uint32_t i = 0; i < input.points.size(); ++i) {
    if (!cloud::is_finite(input.points[i])) continue;
    const Vec3 p = input.points[i].cast<double>();
    if (std::all_of(planes.begin(), planes.end(),
                    [&](const BinPlane& plane) { return plane.height(p) > 2.0 * options.bin_margin; }))
      inside.push_back(i);
  }
  return inside;
}

}  // namespace tubebin::modeling
