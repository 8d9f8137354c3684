#include "modeling/fitting/piece_evidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace tubebin::modeling {
namespace {

/// A point's place across the axis of its stretch: direction from it, and distance beyond the radius.
struct AcrossPoint {
  Eigen::Vector2d direction;
  double excess = 0.0;
};

/// The points of the piece's side by stretches of some radii, straight enough for one axis each.
std::vector<std::vector<AcrossPoint>> points_across(const TubePiece& piece, const FilteredCloud& cloud) {
  struct Axis {
    Vec3 start, along, side, up;
    double length;
  };
  // The flat end of a tube that points at the scanner may have as many points as its side.
  constexpr double kMostAlong = 0.7;  // a normal's cosine with the axis
  std::vector<Axis> axes;
  const double most = 4.0 * piece.radius;
  for (std::size_t k = 0; k + 1 < piece.nodes.size(); ++k) {
    const Vec3 whole = piece.nodes[k + 1] - piece.nodes[k];
    const int parts = static_cast<int>(std::ceil(whole.norm() / most));
    for (int part = 0; part < parts; ++part) {
      const Vec3 along = whole.normalized(), side = along.unitOrthogonal();
      axes.push_back({.start = piece.nodes[k] + double(part) / parts * whole,
                      .along = along,
                      .side = side,
                      .up = along.cross(side),
                      .length = whole.norm() / parts});
    }
  }
  std::vector<std::vector<AcrossPoint>> stretches(axes.size());
  for (const std::uint32_t i : piece.points) {
    const Vec3 p = cloud.points[i].cast<double>(), normal = cloud.normals[i].cast<double>();
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const Vec3 offset = p - axes[k].start;
      const double t = offset.dot(axes[k].along);
      if (t < 0.0 || t > axes[k].length) continue;
      const Eigen::Vector2d across(offset.dot(axes[k].side), offset.dot(axes[k].up));
      const double distance = across.norm(), excess = distance - piece.radius;
      if (std::abs(excess) > piece.radius / 3.0) continue;
      if (std::abs(normal.dot(axes[k].along)) > kMostAlong) break;
      stretches[k].push_back({.direction = across / distance, .excess = excess});
      break;
    }
  }
  return stretches;
}

/// Sums of squares of a linear model excess = change + a cos(angle) + b sin(angle), with one change of the radius for all
/// stretches and a shift (a, b) of each one's axis, which is eliminated (Schur complement).
struct RadiusChange {
  double information = 0.0, pull = 0.0, squares = 0.0, freedom = -1.0;

  void add(const std::vector<AcrossPoint>& stretch) {
    if (stretch.size() < 8) return;
    Eigen::Matrix2d shifts = Eigen::Matrix2d::Identity() * 1e-6;
    Eigen::Vector2d mixed = Eigen::Vector2d::Zero(), right = Eigen::Vector2d::Zero();
    double sum = 0.0, own_squares = 0.0;
    for (const auto& [direction, excess] : stretch) {
      shifts += direction * direction.transpose();
      mixed += direction;
      right += excess * direction;
      sum += excess;
      own_squares += excess * excess;
    }
    const auto factors = shifts.ldlt();
    const auto count = static_cast<double>(stretch.size());
    information += count - mixed.dot(factors.solve(mixed));
    pull += sum - mixed.dot(factors.solve(right));
    squares += own_squares - right.dot(factors.solve(right));
    freedom += count - 2.0;
  }
};

/// Calls visit(center, direction) for places of the centreline a radius apart or less; returns how many they are.
template <typename Visit>
double visit_along(std::span<const Vec3> nodes, double radius, const Visit& visit) {
  double places = 0.0;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 along = nodes[k + 1] - nodes[k];
    const int steps = static_cast<int>(along.norm() / radius) + 1;
    for (int step = 0; step < steps; ++step) visit(nodes[k] + (step + 0.5) / steps * along, along.normalized());
    places += steps;
  }
  return places;
}

/// How the visible sides look, to 53 degrees left and right of the top as the viewpoint has it.
void look_at_sides(const TubePiece& piece, const OcclusionTest& occlusion, PieceEvidence& evidence) {
  const double places = visit_along(piece.nodes, piece.radius, [&](const Vec3& center, const Vec3& direction) {
    const StretchEvidence sides = occlusion.sides(center, direction);
    evidence.surface += sides.surface, evidence.empty += sides.empty;
  });
  evidence.surface /= std::max(places, 1.0), evidence.empty /= std::max(places, 1.0);
}

/// A tube's own solid keeps places of its centreline two radii apart, but for those less than the tightest half turn apart
/// along it. Votes on a thicker round thing make a curve that winds over its surface.
double coiled_part(const TubePiece& piece) {
  struct Place {
    Vec3 position;
    double arc_length;
  };
  std::vector<Place> places;
  double arc_length = 0.0;
  for (std::size_t k = 0; k + 1 < piece.nodes.size(); ++k) {
    const Vec3 along = piece.nodes[k + 1] - piece.nodes[k];
    const int steps = static_cast<int>(2.0 * along.norm() / piece.radius) + 1;
    for (int step = 0; step < steps; ++step) {
      const double t = (step + 0.5) / steps;
      places.push_back({.position = piece.nodes[k] + t * along, .arc_length = arc_length + t * along.norm()});
    }
    arc_length += along.norm();
  }
  const double half_turn = std::numbers::pi * piece.radius;
  std::vector<bool> is_coiled(places.size(), false);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = i + 1; j < places.size(); ++j)
      if (places[j].arc_length - places[i].arc_length > half_turn &&
          (places[j].position - places[i].position).norm() < piece.radius)
        is_coiled[i] = is_coiled[j] = true;
  return static_cast<double>(std::ranges::count(is_coiled, true)) / static_cast<double>(places.size());
}

}  // namespace

OutlineEvidence outline_along(std::span<const Vec3> nodes, double radius, const OcclusionTest& occlusion) {
  OutlineEvidence mean;
  const double places = visit_along(nodes, radius, [&](const Vec3& center, const Vec3& direction) {
    const OutlineEvidence outline = occlusion.outline(center, direction);
    mean.edge += outline.edge, mean.level += outline.level, mean.flat += outline.flat;
  });
  for (double* part : {&mean.edge, &mean.level, &mean.flat}) *part /= std::max(places, 1.0);
  return mean;
}

PieceEvidence examine_piece(const TubePiece& piece, const FilteredCloud& cloud, const OcclusionTest& occlusion) {
  PieceEvidence evidence;
  RadiusChange change;
  for (const auto& stretch : points_across(piece, cloud)) change.add(stretch);
  if (change.information > 0.0 && change.freedom > 0.0) {
    const double radius_change = change.pull / change.information;
    const double squares = std::max(change.squares - radius_change * change.pull, 0.0);
    evidence.sigma = std::sqrt(squares / change.freedom);
    // Joints and bends that the polyline cuts leave some hundredths of a radius, whatever the noise.
    const double error = std::max(evidence.sigma, 0.01 * piece.radius);
    // A plane at the radius' distance is r (1 / cos(angle) - 1) off, to second order a change of r.
    evidence.curvature = 1.0 - radius_change / piece.radius;
    evidence.curvature_error = error / piece.radius / std::sqrt(change.information);
  } else {
    evidence.curvature_error = 1.0;
  }
  look_at_sides(piece, occlusion, evidence);
  evidence.outline = outline_along(piece.nodes, piece.radius, occlusion);
  evidence.coiled = coiled_part(piece);
  return evidence;
}

bool has_other_radius(const PieceEvidence& evidence) {
  return std::abs(evidence.curvature - 1.0) > 0.15 + 4.0 * evidence.curvature_error;
}

bool goes_on_beside(const OutlineEvidence& outline) {
  constexpr double kChance = 0.1;  // of flanks that noise puts in front
  return outline.flat > std::max(outline.edge, kChance);
}

bool are_sunk(const OutlineEvidence& outline) {
  constexpr double kMost = 1.0 / 3.0;  // of tubes' places
  return outline.level > std::max(outline.edge, kMost);
}

bool is_tube(const PieceEvidence& evidence, double radius, double noise) {
  if (evidence.sigma > std::hypot(2.0 * noise, radius / 10.0)) return false;
  if (evidence.empty > 0.3 || evidence.coiled > 0.6) return false;
  // A plane has to be four standard deviations away.
  return evidence.curvature_error < 0.25 && std::abs(evidence.curvature - 1.0) < 0.15 + 2.0 * evidence.curvature_error;
}

bool is_doubtful(double length, double radius, double evidence) {
  constexpr double kEvidence = 100.0;  // nats
  return length < kShort * radius && evidence < kEvidence;
}

bool stands_upright(const TubePiece& piece, const Vec3& up) {
  if (up.isZero()) return false;
  constexpr double kStraight = 0.95, kLean = 0.05, kAxisError = 0.4;  // chord per length; a slope; radii
  const Vec3 chord = piece.nodes.back() - piece.nodes.front();
  const double level = (chord - chord.dot(up) * up).norm();
  return chord.norm() > kStraight * piece.length() && chord.norm() > 2.0 * piece.radius &&
         level < kLean * chord.norm() + kAxisError * piece.radius;
}

bool goes_on(const TubePiece& upright, const std::vector<Vec3>& ends) {
  return std::ranges::any_of(ends, [&](const Vec3& end) {
    return std::min((end - upright.nodes.front()).norm(), (end - upright.nodes.back()).norm()) < 1.5 * upright.radius;
  });
}

bool is_inside(const TubePiece& piece, const TubePiece& solid) {
  const double radius = std::max(piece.radius, solid.radius);
  const auto inside = std::ranges::count_if(
      piece.nodes, [&](const Vec3& node) { return distance_to_polyline(node, solid.nodes) < radius; });
  return 2 * inside > std::ssize(piece.nodes);
}

}  // namespace tubebin::modeling
