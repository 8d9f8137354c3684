#include "tubebin/modeling/bin_planes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tubebin {
namespace {

constexpr int kTrials = 300;           ///< a plane of a fifth of the points is missed by chance once in e^2.4 ... 11
constexpr std::size_t kSample = 3000;  ///< points: a plane's share of them is known to 1 %

std::vector<Vec3> sample_points(const ModelingInput& input) {
  std::vector<Vec3> finite;
  for (const Point& p : input.points)
    if (is_finite(p)) finite.push_back(p.cast<double>());
  std::vector<Vec3> sample;
  for (std::size_t i = 0; i < finite.size(); i += finite.size() / kSample + 1) sample.push_back(finite[i]);
  return sample;
}

struct Share {
  double on = 0.0, behind = 0.0;
};

Share share_of(const std::vector<Vec3>& sample, const BinPlane& plane, double tolerance) {
  Share share;
  for (const Vec3& p : sample) {
    const double height = plane.height(p);
    if (std::abs(height) <= tolerance) share.on += 1.0;
    else if (height < 0.0) share.behind += 1.0;
  }
  const auto count = static_cast<double>(sample.size());
  return {share.on / count, share.behind / count};
}

/// The best plane through three sample points that `accept`s its normal (which looks to `inside`), with at least
/// `share_min` of the points on it and at most 2 % of them behind it.
template <typename Accept>
std::optional<BinPlane> find_plane(const std::vector<Vec3>& sample, const Vec3& inside, double tolerance,
                                   double share_min, Random& random, const Accept& accept) {
  std::optional<BinPlane> best;
  double most = share_min;
  const int last = static_cast<int>(sample.size()) - 1;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto pick = [&] { return sample[static_cast<std::size_t>(random.integer(0, last))]; };
    const Vec3 a = pick(), b = pick(), c = pick();
    const Vec3 cross = (b - a).cross(c - a);
    if (cross.norm() < 1e-12) continue;
    BinPlane plane{.normal = cross.normalized()};
    if (plane.normal.dot(inside - a) < 0.0) plane.normal = -plane.normal;
    plane.offset = plane.normal.dot(a);
    if (!accept(plane)) continue;
    const Share share = share_of(sample, plane, tolerance);
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
  const auto floor = find_plane(sample, viewpoint, tolerance, 0.1, random, [](const BinPlane&) { return true; });
  if (!floor) return {};
  std::vector<BinPlane> planes = {*floor};
  const auto inside = [&](const BinPlane& plane) {
    std::erase_if(sample, [&](const Vec3& p) { return plane.height(p) < tolerance; });
  };
  inside(*floor);
  for (int wall = 0; wall < 4 && sample.size() >= 100; ++wall) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : sample) middle += p / static_cast<double>(sample.size());
    const auto plane = find_plane(sample, middle, tolerance, 0.03, random, [&](const BinPlane& candidate) {
      return std::abs(candidate.normal.dot(floor->normal)) < 0.1;
    });
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
    if (!is_finite(input.points[i])) continue;
    const Vec3 p = input.points[i].cast<double>();
    if (std::all_of(planes.begin(), planes.end(),
                    [&](const BinPlane& plane) { return plane.height(p) > 2.0 * options.bin_margin; }))
      inside.push_back(i);
  }
  return inside;
}

}  // namespace tubebin
