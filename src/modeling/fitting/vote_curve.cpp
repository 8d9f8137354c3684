#include "modeling/fitting/vote_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "modeling/joining/boxed_curve.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// Mean votes at equal geodesic distance from one end: the level sets' centres are a first skeleton (Verroust and
/// Lazarus 2000, "Extracting skeletal curves from 3D scattered data").
std::vector<Vec3> level_set_skeleton(const VoteGraph& graph, double step) {
  const std::vector<double>& distance = graph.distances_from_end();
  std::vector<Vec3> sums;
  std::vector<double> counts;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (!std::isfinite(distance[i])) continue;
    const auto level = static_cast<std::size_t>(distance[i] / step);
    if (level >= sums.size()) {
      sums.resize(level + 1, Vec3::Zero());
      counts.resize(level + 1, 0.0);
    }
    const auto weight = static_cast<double>(graph.count(i));
    sums[level] += weight * graph.mean(i).cast<double>();
    counts[level] += weight;
  }
  std::vector<Vec3> skeleton;
  for (std::size_t level = 0; level < sums.size(); ++level)
    if (counts[level] > 0.0) skeleton.push_back(sums[level] / counts[level]);
  return skeleton;
}

/// A curve and its unit tangents.
struct Course {
  explicit Course(const std::vector<Vec3>& curve) : samples(curve) {
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, curve.size() - 1);
      tangents.push_back((curve[after] - curve[before]).normalized());
    }
  }

  const std::vector<Vec3>& samples;
  std::vector<Vec3> tangents;
};

/// Finds each vote's place along the course.
void place_along(const Course& course, std::vector<Vote>& votes) {
  std::vector<double> arclength = {0.0};
  for (std::size_t i = 1; i < course.samples.size(); ++i)
    arclength.push_back(arclength.back() + (course.samples[i] - course.samples[i - 1]).norm());
  const BoxedCurve boxed(course.samples);
  std::size_t sample = 0;
  for (Vote& vote : votes) {
    sample = boxed.nearest(vote.center, sample);  // the last vote's is near
    vote.sample = sample;
    vote.arclength = arclength[sample] + (vote.center - course.samples[sample]).dot(course.tangents[sample]);
  }
}

/// Mean votes in steps along the curve. A vote counts if its normal stands across the tube (within 30 degrees; those
/// of a flat end do not) and it lies within half a radius of the curve.
std::vector<Vec3> smooth(const std::vector<Vec3>& curve, std::vector<Vote>& votes, double step, double radius) {
  const Course course(curve);
  place_along(course, votes);
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const Vote& vote : votes) first = std::min(first, vote.arclength), last = std::max(last, vote.arclength);
  struct Mean {
    Vec3 sum = Vec3::Zero();
    double count = 0.0;
  };
  std::vector<Mean> means(static_cast<std::size_t>((last - first) / step) + 1);
  for (const Vote& vote : votes) {
    const Vec3& along = course.tangents[vote.sample];
    const Vec3 offset = vote.center - curve[vote.sample];
    if (std::abs(vote.normal.dot(along)) > 0.5 || (offset - offset.dot(along) * along).norm() > radius / 2.0) continue;
    Mean& mean = means[static_cast<std::size_t>((vote.arclength - first) / step)];
    mean.sum += vote.center;
    mean.count += 1.0;
  }
  std::vector<Vec3> result;
  for (const Mean& mean : means)
    if (mean.count > 0.0) result.push_back(mean.sum / mean.count);
  return result;
}

/// The curve without what lies within `cut` of its ends, where the votes of a flat end bend the skeleton aside.
std::vector<Vec3> trim(const std::vector<Vec3>& curve, double cut) {
  const double length = polyline_length(curve);
  std::vector<Vec3> middle;
  double arclength = 0.0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (i > 0) arclength += (curve[i] - curve[i - 1]).norm();
    if (arclength >= cut && arclength <= length - cut) middle.push_back(curve[i]);
  }
  return middle;
}

/// Of so many of a stretch's points, one votes. Where smooth() takes means of r / 3 of a fully visible tube, eight
/// votes, each off by r / 6, make them good to r / 17; a short stretch needs some hundred votes in all.
std::size_t vote_stride(std::size_t points, double radius, double spacing) {
  constexpr double kVotesOfMean = 8.0, kVotesOfStretch = 300.0;
  const double points_of_mean = points_of_visible_stretch(radius, radius / 3.0, spacing);
  const double stride =
      std::min(std::round(points_of_mean / kVotesOfMean), std::floor(static_cast<double>(points) / kVotesOfStretch));
  return static_cast<std::size_t>(std::max(stride, 1.0));
}

}  // namespace

VoteCurve find_vote_curve(const FilteredCloud& cloud, Stretch stretch, double radius) {
  VoteCurve found{.points = std::move(stretch.segment), .surface = {}, .votes = {}, .samples = {}};
  const Segment& segment = found.points;
  const std::size_t stride = vote_stride(segment.size(), radius, cloud.spacing);
  for (std::size_t first = 0; first < segment.size(); first += stride) {
    // One of each few at random: a fixed stride picks stripes out of the rows that points stand in.
    const std::size_t k = std::min(first + derive_seed({first}) % stride, segment.size() - 1);
    const Vec3 p = cloud.points[segment[k]].cast<double>(), n = cloud.normals[segment[k]].cast<double>();
    found.surface.push_back({p, n});
    found.votes.push_back({.normal = n, .center = p - radius * n});
  }
  std::vector<Vec3> curve = level_set_skeleton(stretch.graph, radius / 3.0);
  if (curve.size() >= 3) curve = smooth(curve, found.votes, radius / 3.0, radius);
  if (curve.size() >= 3) curve = smooth(curve, found.votes, radius / 3.0, radius);
  found.samples = trim(curve, 1.5 * radius);
  return found;
}

double roughness(std::span<const VoteCurve> curves) {
  std::vector<double> differences;  // second ones, across the curve: bends make few of them
  for (const VoteCurve& curve : curves)
    for (std::size_t k = 1; k + 1 < curve.samples.size(); ++k) {
      const Vec3 &before = curve.samples[k - 1], &after = curve.samples[k + 1];
      const Vec3 along = (after - before).normalized(), bend = before - 2.0 * curve.samples[k] + after;
      differences.push_back((bend - bend.dot(along) * along).norm());
    }
  if (differences.empty()) return 0.0;
  const auto middle = differences.begin() + std::ssize(differences) / 2;
  std::ranges::nth_element(differences, middle);
  // The median length of two normal axes is sqrt(2 log 2) standard deviations; a second difference has the variance of six.
  return *middle / std::sqrt(12.0 * std::numbers::ln2);
}

}  // namespace tubebin::modeling
