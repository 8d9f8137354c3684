#include "modeling/fitting/centerline_fitting.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "modeling/fitting/end_growth.hpp"
#include "modeling/fitting/flat_ends.hpp"
#include "modeling/fitting/piece_parts.hpp"
#include "modeling/fitting/surface_fitting.hpp"
#include "modeling/input/point_sample.hpp"

namespace tubebin::modeling {
namespace {

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
  const std::vector<Vote> sample = some_of<Vote>(votes, kSample);
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

/// Where few points, or those of a flat end, lead an end aside, grow_end may turn twice in what becomes one corner: a
/// sharp turn within two radii is no tube, nor is a turn by much more than a right angle anywhere (cosine of 102 degrees).
/// The longer half stays.
void drop_sharp_ends(std::vector<Vec3>& nodes, double radius) {
  for (int end = 0; end < 2; ++end) {
    std::reverse(nodes.begin(), nodes.end());
    while (nodes.size() > 2) {
      const Vec3 last = nodes.back() - nodes[nodes.size() - 2];
      const Vec3 before = nodes[nodes.size() - 2] - nodes[nodes.size() - 3];
      if (2.0 * last.norm() > polyline_length(nodes)) break;
      if (last.normalized().dot(before.normalized()) > (last.norm() > 2.0 * radius ? -0.2 : kSharpTurn)) break;
      nodes.pop_back();
    }
  }
}

bool is_short(const VoteCurve& votes, double radius) {
  return votes.samples.size() < 2 || polyline_length(votes.samples) < 2.0 * radius;
}

bool turns_back(const std::vector<Vec3>& nodes, std::size_t k) {
  constexpr double kCosine = -0.98;  // of 169 degrees; paths of trees that fork narrowly turn nearly as much
  return (nodes[k] - nodes[k - 1]).normalized().dot((nodes[k + 1] - nodes[k]).normalized()) < kCosine;
}

/// At a fork a node may be drawn out of the trunk toward the branch.
void drop_spikes(std::vector<Vec3>& nodes, double radius) {
  for (std::size_t k = 1; k + 1 < nodes.size();) {
    const std::array<Vec3, 2> beside = {nodes[k - 1], nodes[k + 1]};
    if (turns_back(nodes, k) && distance_to_polyline(nodes[k], beside) < radius)
      nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(k));
    else ++k;
  }
}

/// Two nodes within a radius of each other, the first such pair from `start` on, that a loop of the course lies between; a
/// tube's course has none.
std::optional<std::pair<std::size_t, std::size_t>> find_loop(const std::vector<Vec3>& nodes, std::size_t start,
                                                             double radius) {
  constexpr double kShortest = 3.0, kLongest = 12.0;  // radii
  for (std::size_t k = start; k < nodes.size(); ++k) {
    double length = 0.0;
    std::optional<std::size_t> back;
    for (std::size_t next = k + 1; next < nodes.size(); ++next) {
      length += (nodes[next] - nodes[next - 1]).norm();
      if (length > kLongest * radius) break;
      if (length >= kShortest * radius && (nodes[next] - nodes[k]).norm() <= radius) back = next;
    }
    if (back) return std::pair(k, *back);
  }
  return std::nullopt;
}

/// Where a course makes a loop, the end of another tube that touches it was followed, too. What makes two, or is hardly more than
/// one, is no tube, and keeps them for those who examine it.
void drop_loop(std::vector<Vec3>& nodes, double radius) {
  const auto loop = find_loop(nodes, 0, radius);
  if (!loop || find_loop(nodes, loop->second, radius)) return;
  std::vector<Vec3> without(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(loop->first) + 1);
  without.insert(without.end(), nodes.begin() + static_cast<std::ptrdiff_t>(loop->second) + 1, nodes.end());
  if (polyline_length(without) >= radius / 2.0) nodes = std::move(without);
}

}  // namespace

double bend_tolerance(std::span<const VoteCurve> curves, double radius) {
  // r / 20 is what the means of some ten votes, each off by r / 6, are good for.
  return std::clamp(4.0 * roughness(curves), radius / 20.0, radius / 9.0);
}

std::vector<Vec3> first_nodes(const VoteCurve& votes, double tolerance, double radius) {
  if (is_short(votes, radius)) return axis_from_normals(votes.votes, radius);
  std::vector<Vec3> nodes = {votes.samples.front()};
  // A bend shows as an offset from the chord.
  simplify(votes.samples, 0, votes.samples.size() - 1, tolerance, nodes);
  return nodes;
}

std::optional<TubePiece> fit_centerline(const FilteredCloud& cloud, const VoteCurve& votes, double tolerance,
                                        const LoosePoints& loose, double radius, const Vec3& viewpoint) {
  const Segment& segment = votes.points;
  const std::vector<SurfacePoint>& surface = votes.surface;
  TubePiece piece{.nodes = {}, .radius = radius, .points = segment};
  if (is_short(votes, radius)) piece.nodes = axis_of_flat_end(surface, radius);
  if (!piece.nodes.empty()) return piece;
  piece.nodes = first_nodes(votes, tolerance, radius);
  if (fit_surface(piece.nodes, surface, radius).sigma > radius / 4.0) return std::nullopt;

  grow_end(piece.nodes, cloud, segment, loose, radius, viewpoint);
  std::reverse(piece.nodes.begin(), piece.nodes.end());
  grow_end(piece.nodes, cloud, segment, loose, radius, viewpoint);
  // Twice: a corner that the first nodes cut is found when they have moved.
  for (int round = 0; round < 2; ++round) {
    std::vector<Vec3> nodes = {piece.nodes.front()};
    simplify(piece.nodes, 0, piece.nodes.size() - 1, 0.4 * tolerance, nodes);
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

std::vector<TubePiece> cut_where_it_turns_back(TubePiece piece, std::span<const cloud::Point> points) {
  drop_spikes(piece.nodes, piece.radius);
  drop_loop(piece.nodes, piece.radius);
  std::vector<TubePiece> parts = {{.nodes = {piece.nodes.front()}, .radius = piece.radius, .points = {}}};
  for (std::size_t k = 1; k + 1 < piece.nodes.size(); ++k) {
    parts.back().nodes.push_back(piece.nodes[k]);
    if (turns_back(piece.nodes, k)) parts.push_back({.nodes = {piece.nodes[k]}, .radius = piece.radius, .points = {}});
  }
  parts.back().nodes.push_back(piece.nodes.back());
  if (parts.size() == 1) return {std::move(piece)};
  std::erase_if(parts, [](const TubePiece& part) { return part.length() < part.radius / 2.0; });
  share_points(piece, points, parts);
  return parts;
}

}  // namespace tubebin::modeling
