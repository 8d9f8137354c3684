#include "modeling/fitting/centerline_fitting.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "modeling/fitting/end_growth.hpp"
#include "modeling/fitting/flat_ends.hpp"
#include "modeling/fitting/surface_fitting.hpp"
#include "modeling/joining/boxed_curve.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// A surface point's normal and where it puts the centreline.
struct Vote {
  Vec3 normal;
  Vec3 center;
  std::size_t sample = 0;  ///< nearest sample of the curve
  double arclength = 0.0;  ///< along the curve, metres
};

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

/// Ramer-Douglas-Peucker: the fewest corners that leave no sample farther than `tolerance` from the chords.
void simplify(const std::vector<Vec3>& curve, std::size_t first, std::size_t last, double tolerance,
              std::vector<Vec3>& nodes) {
  const Vec3 chord = (curve[last] - curve[first]).normalized();
  std::size_t corner = first;
  double farthest_off = tolerance;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vec3 offset = curve[i] - curve[first];
    const double off = (offset - offset.dot(chord) * chord).norm();
    if (off > farthest_off) farthest_off = off, corner = i;
  }
  if (corner == first) {
    nodes.push_back(curve[last]);
    return;
  }
  simplify(curve, first, corner, tolerance, nodes);
  simplify(curve, corner, last, tolerance, nodes);
}

/// A straight tube through `center`.
struct AxisGuess {
  Vec3 axis;  ///< unit
  Vec3 center;
  double reach;  ///< of its votes from the axis, metres

  bool explains(const Vote& vote) const {
    const Vec3 offset = vote.center - center;
    const double along = offset.dot(axis);
    return std::abs(vote.normal.dot(axis)) < 0.3 && offset.squaredNorm() - along * along < reach * reach;
  }
};

/// A stretch too short to show its direction as a curve gets it from its normals: two of a side span a plane across
/// the axis. Of the axes of many pairs the one that most votes agree on wins, whatever else is there (a flat end).
/// Half a radius about the middle of what agrees is enough to grow from.
std::vector<Vec3> axis_from_normals(const std::vector<Vote>& votes, double radius) {
  constexpr std::size_t kPairs = 64, kSample = 128;
  std::vector<Vote> sample;
  for (std::size_t i = 0; i < votes.size(); i += votes.size() / kSample + 1) sample.push_back(votes[i]);
  AxisGuess best{Vec3::UnitX(), votes.front().center, radius / 4.0};
  std::ptrdiff_t most = 0;
  for (std::size_t k = 0; k < kPairs; ++k) {
    // Steps of the golden ratio spread the pairs over the votes.
    const auto pick = [&](double shift) -> const Vote& {
      const double place = std::fmod(0.6180339887 * static_cast<double>(k) + shift, 1.0);
      return votes[static_cast<std::size_t>(place * static_cast<double>(votes.size()))];
    };
    const Vote &first = pick(0.0), &second = pick(0.31 + 0.37 * static_cast<double>(k % 2));
    const Vec3 across = first.normal.cross(second.normal);
    if (across.norm() < 0.2) continue;  // 12 degrees: their cross product is mostly noise
    const AxisGuess guess{across.normalized(), first.center, radius / 4.0};
    const auto count = std::ranges::count_if(sample, [&](const Vote& vote) { return guess.explains(vote); });
    if (count > most) most = count, best = guess;
  }
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  for (const Vote& vote : votes)
    if (best.explains(vote)) sum += vote.center, count += 1.0;
  const Vec3 middle = count > 0.0 ? Vec3(sum / count) : best.center;
  return {middle - radius / 4.0 * best.axis, middle + radius / 4.0 * best.axis};
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

/// A joint's sphere would bulge out of a flat end nearer than a radius.
void drop_joints_at_ends(std::vector<Vec3>& nodes, double radius) {
  while (nodes.size() > 2 && (nodes[1] - nodes[0]).norm() < radius) nodes.erase(nodes.begin() + 1);
  while (nodes.size() > 2 && (nodes[nodes.size() - 2] - nodes.back()).norm() < radius) nodes.erase(nodes.end() - 2);
}

/// Joints nearer to each other than `closest` become one in their middle: no tube bends so narrowly that it needs both,
/// and a cylinder with hardly a point on it would be free to lean anywhere.
void merge_close_joints(std::vector<Vec3>& nodes, double closest) {
  for (std::size_t k = 2; k + 1 < nodes.size();) {
    if ((nodes[k] - nodes[k - 1]).norm() >= closest) {
      ++k;
      continue;
    }
    nodes[k - 1] = 0.5 * (nodes[k - 1] + nodes[k]);
    nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(k));
  }
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

/// Where few points, or those of a flat end, lead an end aside, grow_end may turn twice in what becomes one corner: a
/// sharp turn within two radii is no tube, nor is a right angle anywhere.
void drop_sharp_ends(std::vector<Vec3>& nodes, double radius) {
  for (int end = 0; end < 2; ++end) {
    std::reverse(nodes.begin(), nodes.end());
    while (nodes.size() > 2) {
      const Vec3 last = nodes.back() - nodes[nodes.size() - 2];
      const Vec3 before = nodes[nodes.size() - 2] - nodes[nodes.size() - 3];
      if (last.normalized().dot(before.normalized()) > (last.norm() > 2.0 * radius ? 0.0 : kSharpTurn)) break;
      nodes.pop_back();
    }
  }
}

}  // namespace

std::optional<TubePiece> fit_centerline(const FilteredCloud& cloud, const Stretch& stretch,
                                        std::span<const SurfacePoint> loose, double radius, const Vec3& viewpoint) {
  const Segment& segment = stretch.segment;
  const std::size_t stride = vote_stride(segment.size(), radius, cloud.spacing);
  std::vector<Vote> votes;
  std::vector<SurfacePoint> surface;
  for (std::size_t first = 0; first < segment.size(); first += stride) {
    // One of each few at random: a fixed stride picks stripes out of the rows that points stand in.
    const std::size_t k = std::min(first + derive_seed({first}) % stride, segment.size() - 1);
    const Vec3 p = cloud.points[segment[k]].cast<double>(), n = cloud.normals[segment[k]].cast<double>();
    surface.push_back({p, n});
    votes.push_back({.normal = n, .center = p - radius * n});
  }
  std::vector<Vec3> curve = level_set_skeleton(stretch.graph, radius / 3.0);
  if (curve.size() >= 3) curve = smooth(curve, votes, radius / 3.0, radius);
  if (curve.size() >= 3) curve = smooth(curve, votes, radius / 3.0, radius);
  curve = trim(curve, 1.5 * radius);

  TubePiece piece{.nodes = {}, .radius = radius, .points = segment};
  if (curve.size() < 2 || polyline_length(curve) < 2.0 * radius) {
    piece.nodes = axis_of_flat_end(surface, radius);
    if (!piece.nodes.empty()) return piece;
    piece.nodes = axis_from_normals(votes, radius);
  } else {
    piece.nodes = {curve.front()};
    // A bend shows as an offset from the chord; r / 20 is what the means of some ten votes, each off by r / 6, are
    // good for.
    simplify(curve, 0, curve.size() - 1, radius / 20.0, piece.nodes);
  }
  if (fit_surface(piece.nodes, surface, radius).sigma > radius / 4.0) return std::nullopt;

  grow_end(piece.nodes, cloud, segment, loose, radius, viewpoint);
  std::reverse(piece.nodes.begin(), piece.nodes.end());
  grow_end(piece.nodes, cloud, segment, loose, radius, viewpoint);
  // Twice: a corner that the first nodes cut is found when they have moved.
  for (int round = 0; round < 2; ++round) {
    std::vector<Vec3> nodes = {piece.nodes.front()};
    simplify(piece.nodes, 0, piece.nodes.size() - 1, radius / 50.0, nodes);
    drop_joints_at_ends(nodes, radius);
    merge_close_joints(nodes, radius / 2.0);
    if (round > 0 && nodes.size() == piece.nodes.size()) break;
    piece.nodes = std::move(nodes);
    fit_surface(piece.nodes, surface, radius);
  }
  drop_sharp_ends(piece.nodes, radius);
  if (piece.length() < radius / 2.0) return std::nullopt;
  return piece;
}

}  // namespace tubebin::modeling
