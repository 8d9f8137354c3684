#include "modeling/fitting/wire_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "modeling/median.hpp"

namespace tubebin::modeling {
namespace {

/// Of each of two directions, at least.
constexpr std::size_t kManyWires = 12;
/// Of the length of all pieces: hoops of a round basket are bent. Tubes in a bin, straight ones too, have a fifth at most.
constexpr double kLeastAligned = 0.5;
/// Radii, from axis to axis; tubes that touch are two apart.
constexpr double kFarApart = 5.0;

struct Wire {
  Vec3 from, to, direction;
  double length;
};

using Wires = std::vector<Wire>;

Wires straight_pieces(const std::vector<TubePiece>& pieces) {
  Wires wires;
  for (const TubePiece& piece : pieces) {
    const Vec3 &from = piece.nodes.front(), &to = piece.nodes.back();
    const double chord = (to - from).norm();
    if (chord > 2.0 * piece.radius && chord > 0.99 * piece.length())
      wires.push_back({from, to, (to - from) / chord, piece.length()});
  }
  return wires;
}

/// Sine, and cosine, of 3 degrees.
constexpr double kSine = 0.0523, kCosine = 0.9986;

bool are_parallel(const Vec3& a, const Vec3& b) { return std::abs(a.dot(b)) > kCosine; }

bool are_square(const Vec3& a, const Vec3& b) { return std::abs(a.dot(b)) < kSine; }

double length_of(const Wires& wires) {
  return std::accumulate(wires.begin(), wires.end(), 0.0,
                         [](double sum, const Wire& wire) { return sum + wire.length; });
}

Wires parallel_to(const Wires& wires, const Vec3& direction) {
  Wires parallel;
  std::ranges::copy_if(wires, std::back_inserter(parallel),
                       [&](const Wire& wire) { return are_parallel(wire.direction, direction); });
  return parallel;
}

Wires square_to(const Wires& wires, const Vec3& direction) {
  Wires square;
  std::ranges::copy_if(wires, std::back_inserter(square),
                       [&](const Wire& wire) { return are_square(wire.direction, direction); });
  return square;
}

/// Those that are parallel to the one with the longest such company.
Wires most_parallel(const Wires& wires) {
  if (wires.empty()) return {};
  const auto length_along = [&](const Wire& wire) {
    double length = 0.0;
    for (const Wire& other : wires)
      if (are_parallel(wire.direction, other.direction)) length += other.length;
    return length;
  };
  return parallel_to(wires, std::ranges::max(wires, {}, length_along).direction);
}

/// To the nearest parallel one that has a part beside it; infinite where there is none.
std::vector<double> distances_side_by_side(const Wires& parallel) {
  const Vec3& axis = parallel.front().direction;
  const auto span_of = [&](const Wire& wire) { return std::minmax({axis.dot(wire.from), axis.dot(wire.to)}); };
  std::vector<double> distances;
  for (const Wire& wire : parallel) {
    const auto [low, high] = span_of(wire);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wire& other : parallel) {
      const auto [other_low, other_high] = span_of(other);
      if (&other == &wire || other_high < low || high < other_low) continue;
      const Vec3 apart = other.from - wire.from;
      nearest = std::min(nearest, (apart - apart.dot(axis) * axis).norm());
    }
    distances.push_back(nearest);
  }
  return distances;
}

}  // namespace

bool is_wire_mesh(const std::vector<TubePiece>& pieces) {
  if (pieces.size() < 2 * kManyWires) return false;
  const Wires wires = straight_pieces(pieces), first = most_parallel(wires);
  if (first.size() < kManyWires) return false;
  const Wires across = square_to(wires, first.front().direction), second = most_parallel(across);
  if (second.size() < kManyWires) return false;
  const Wires third = square_to(across, second.front().direction);
  double all = 0.0;
  for (const TubePiece& piece : pieces) all += piece.length();
  if (length_of(first) + length_of(second) + length_of(third) < kLeastAligned * all) return false;
  const double radius = pieces.front().radius;
  return std::ranges::all_of(std::array{&first, &second}, [&](const Wires* parallel) {
    std::vector<double> distances = distances_side_by_side(*parallel);
    return median(distances) > kFarApart * radius;
  });
}

}  // namespace tubebin::modeling
