#include "modeling/joining/common_shape.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "modeling/joining/sampled_curve.hpp"

namespace tubebin::modeling {
namespace {

/// Samples stand half a radius apart; fits end a radius and a half too early or too late.
constexpr std::ptrdiff_t kEndSlack = 3;

/// Whether the distances between first, middle and last sample are the same but for what fits are off: cheap to ask first.
bool has_same_chords(std::span<const Vec3> a, std::span<const Vec3> b, double radius) {
  const auto chord = [](std::span<const Vec3> curve, std::size_t i, std::size_t j) {
    return (curve[i] - curve[j]).norm();
  };
  const std::size_t middle = a.size() / 2, last = a.size() - 1;
  return std::abs(chord(a, 0, last) - chord(b, 0, last)) < 3.0 * radius &&
         std::abs(chord(a, 0, middle) - chord(b, 0, middle)) < 2.0 * radius &&
         std::abs(chord(a, middle, last) - chord(b, middle, last)) < 2.0 * radius;
}

/// Of a curve.
struct Part {
  std::size_t first = 0, end = 0;  ///< samples; the end is not in it
};

/// The parts of the shape that the piece's samples lie on, until one is `enough`; whether one is. Of two curves by chance alike,
/// the more they bend the fewer: a twelfth of the bend is what parts of one kind agree to.
template <typename Enough>
bool find_parts_under(std::vector<Vec3> piece, const std::vector<Vec3>& shape, double radius, const Enough& enough) {
  const double agreed = std::min(radius / 2.0, sagitta(piece) / 12.0);
  const auto length = static_cast<std::ptrdiff_t>(piece.size()), all = static_cast<std::ptrdiff_t>(shape.size());
  for (const bool is_reversed : {false, true}) {
    if (is_reversed) std::ranges::reverse(piece);
    for (std::ptrdiff_t first = -kEndSlack; first + length <= all + kEndSlack; first += kEndSlack) {
      const std::ptrdiff_t inside = std::max<std::ptrdiff_t>(first, 0), end = std::min(first + length, all);
      const std::span<const Vec3> part(shape.data() + inside, static_cast<std::size_t>(end - inside));
      const std::span<const Vec3> own(piece.data() + (inside - first), part.size());
      if (!has_same_chords(own, part, radius)) continue;
      const Pose motion = best_motion(own, part);
      // Samples that slide along the other curve come nearer to it, but no two and a half times as near.
      if (mean_squared_distance(own, part, motion) > std::pow(2.5 * agreed, 2)) continue;
      if (distance_apart(piece, shape, first, motion) >= agreed) continue;
      if (enough(Part{static_cast<std::size_t>(inside), static_cast<std::size_t>(end)})) return true;
    }
  }
  return false;
}

bool lies_on(const std::vector<Vec3>& piece, const std::vector<Vec3>& shape, double radius) {
  return find_parts_under(piece, shape, radius, [](const Part&) { return true; });
}

struct Curve {
  std::vector<Vec3> samples;
  double length = 0.0;  ///< metres
};

Curve smoothed(const std::vector<Vec3>& nodes, double radius) {
  Curve curve{.samples = smooth_samples(nodes, radius / 2.0, radius)};
  curve.length = polyline_length(curve.samples);
  return curve;
}

/// Straight pieces lie on anything.
std::vector<Curve> bent_pieces(std::span<const TubePiece> pieces, double radius) {
  std::vector<Curve> bent;
  for (const TubePiece& piece : pieces) {
    if (piece.length() < 8.0 * radius) continue;
    Curve curve = smoothed(piece.nodes, radius);
    if (sagitta(curve.samples) >= 2.0 * radius) bent.push_back(std::move(curve));
  }
  return bent;
}

/// Whether one lies on the other.
bool are_alike(const Curve& a, const Curve& b, double radius) {
  const bool a_is_shorter = a.samples.size() < b.samples.size();
  return a_is_shorter ? lies_on(a.samples, b.samples, radius) : lies_on(b.samples, a.samples, radius);
}

/// How many tubes of this shape the pieces that lie on it make up, ends that fits miss left out, where these are two fifths of
/// those that are at least half as long as it; else none. It lies on pieces that go over to another tube.
double tubes_of_shape(const Curve& shape, const std::vector<Curve>& pieces, double radius) {
  double explained = 0.0, all = 0.0;
  for (const Curve& piece : pieces) {
    if (piece.length < shape.length / 2.0) continue;
    all += piece.length;
    if (are_alike(shape, piece, radius)) explained += std::min(piece.length, shape.length);
  }
  return explained >= 0.4 * all ? explained / shape.length : 0.0;
}

/// Of each sample of the curve: whether the piece lies there.
std::vector<bool> samples_under(const Curve& piece, const Curve& curve, double radius) {
  std::vector<bool> is_under(curve.samples.size(), false);
  if (curve.samples.size() < piece.samples.size()) {
    is_under.assign(is_under.size(), lies_on(curve.samples, piece.samples, radius));
    return is_under;
  }
  find_parts_under(piece.samples, curve.samples, radius, [&](const Part& part) {
    for (std::size_t k = part.first; k < part.end; ++k) is_under[k] = true;
    return false;
  });
  return is_under;
}

/// The longest part of the curve that two pieces show: from where it goes over to another tube, its own one stands alone.
Curve shown_twice(const Curve& curve, const std::vector<Curve>& pieces, double radius) {
  std::vector<int> pieces_at(curve.samples.size(), 0);
  for (const Curve& piece : pieces) {
    const std::vector<bool> is_shown = samples_under(piece, curve, radius);
    for (std::size_t k = 0; k < is_shown.size(); ++k) pieces_at[k] += is_shown[k];
  }
  Part longest;
  for (std::size_t first = 0, k = 0; k < pieces_at.size(); ++k) {
    if (pieces_at[k] < 2) first = k + 1;
    else if (k + 1 - first > longest.end - longest.first) longest = {first, k + 1};
  }
  Curve part{.samples = {curve.samples.begin() + static_cast<std::ptrdiff_t>(longest.first),
                         curve.samples.begin() + static_cast<std::ptrdiff_t>(longest.end)}};
  part.length = polyline_length(part.samples);
  return part;
}

}  // namespace

std::vector<std::vector<Vec3>> possible_shapes(std::span<const std::vector<Vec3>> tubes,
                                               std::span<const TubePiece> pieces) {
  constexpr std::size_t kMost = 5;
  constexpr double kNearlyTwo = 1.75, kOneAndMore = 1.25;  // tubes
  if (pieces.empty()) return {};
  const double radius = pieces.front().radius;
  const std::vector<Curve> bent = bent_pieces(pieces, radius);
  std::vector<Curve> common;
  double most = 0.0;
  for (const std::vector<Vec3>& nodes : tubes) {
    const Curve tube = smoothed(nodes, radius);
    if (sagitta(tube.samples) < 4.0 * radius) continue;
    Curve shape = shown_twice(tube, bent, radius);
    if (shape.samples.empty() || sagitta(shape.samples) < 4.0 * radius) continue;
    const double made_up = tubes_of_shape(shape, bent, radius);
    most = std::max(most, made_up);
    if (made_up >= kOneAndMore) common.push_back(std::move(shape));
  }
  if (most < kNearlyTwo) return {};
  // What is seen of a tube is a part of its shape.
  std::ranges::stable_sort(common, std::greater<>(), &Curve::length);
  std::vector<std::vector<Vec3>> distinct;
  for (const Curve& shape : common) {
    const auto is_same = [&](const std::vector<Vec3>& other) {
      return std::abs(polyline_length(other) - shape.length) < 2.0 * radius && lies_on(shape.samples, other, radius);
    };
    if (distinct.size() < kMost && std::ranges::none_of(distinct, is_same)) distinct.push_back(shape.samples);
  }
  return distinct;
}

}  // namespace tubebin::modeling
