#include "physics/collision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace tubebin::physics {
namespace {

/// A unit vector across `direction` that hardly turns while the direction sways, other than unitOrthogonal().
Vec3 steady_orthogonal(const Vec3& direction) {
  Eigen::Index least = 0;
  direction.cwiseAbs().minCoeff(&least);
  return (Vec3::Unit(least) - direction[least] * direction).normalized();
}

/// A tube that leans by less than this sine stands: its rim points stay where they are, or it would walk on them. The
/// deepest of all then lies at most 0.0015 radii deeper than the deepest of the eight.
constexpr double kStandingSine = 0.02;

}  // namespace

std::array<Vec3, 8> rim_points(const CollisionCylinder& cylinder, const Vec3& center, const Vec3& toward) {
  const Vec3 radial = toward - toward.dot(cylinder.direction) * cylinder.direction;
  const bool stands = radial.squaredNorm() <= kStandingSine * kStandingSine * toward.squaredNorm();
  const Vec3 u = stands ? steady_orthogonal(cylinder.direction) : Vec3(radial.normalized());
  const Vec3 v = cylinder.direction.cross(u);
  constexpr double kDiagonal = std::numbers::sqrt2 / 2.0;
  constexpr double kCircle[][2] = {{1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
                                   {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};
  std::array<Vec3, 8> points;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = center + cylinder.radius * (kCircle[i][0] * u + kCircle[i][1] * v);
  return points;
}

void keep_deepest_of_each_spot(std::size_t begin, double spot, std::vector<Touch>& touches) {
  constexpr double kSameDirection = 0.9;  // cosine
  const auto at = [&](std::size_t i) { return touches.begin() + static_cast<std::ptrdiff_t>(i); };
  if (touches.size() - begin < 2) return;
  std::stable_sort(at(begin), touches.end(), [](const Touch& a, const Touch& b) { return a.depth > b.depth; });
  std::size_t kept = begin;
  for (std::size_t i = begin; i < touches.size(); ++i) {
    const Touch& touch = touches[i];
    const bool known = std::any_of(at(begin), at(kept), [&](const Touch& t) {
      return (t.position - touch.position).squaredNorm() < spot * spot && t.normal.dot(touch.normal) > kSameDirection;
    });
    if (!known) touches[kept++] = touch;
  }
  touches.resize(kept);
}

namespace {

/// Parallel within this sine, two cylinders touch along a line and get a touch at each end of it.
constexpr double kParallelSine = 0.15;

/// Whether the way out through a flat end is as short as `depth`, the way out through the side (metres).
bool is_flat_end(const CollisionCylinder& cylinder, double parameter, double depth = 0.0) {
  const double along = parameter * cylinder.length;
  const double reach = std::max(depth, 0.0);
  return (cylinder.flat_a && along <= reach) || (cylinder.flat_b && along >= cylinder.length - reach);
}

Vec3 outward_end_direction(const CollisionCylinder& cylinder, double parameter) {
  return parameter < 0.5 ? Vec3(-cylinder.direction) : cylinder.direction;
}

Vec3 project_on_box(const scene::Box& box, const Vec3& point) { return point.cwiseMax(box.min()).cwiseMin(box.max()); }

/// Touch of two balls: the general case of round parts of two cylinders.
std::optional<Touch> touch_balls(const Vec3& p, double radius_p, const Vec3& q, double radius_q, double depth_min) {
  const Vec3 offset = q - p;
  const double distance = offset.norm();
  const double depth = radius_p + radius_q - distance;
  if (depth < depth_min) return std::nullopt;
  const Vec3 normal = distance > 1e-12 ? Vec3(offset / distance) : Vec3::UnitZ();
  return Touch{p + normal * (radius_p - 0.5 * depth), normal, depth};
}

/// A flat end of `cylinder` against the round part of `other`.
std::optional<Touch> touch_flat_with_round(const CollisionCylinder& cylinder, double end,
                                           const CollisionCylinder& other, double depth_min) {
  const SolidCylinder solid = cylinder.solid();
  const auto project = [&](const Vec3& point) { return solid.project(point); };
  const Vec3 on_axis = other.axis.at(nearest_parameter(other.axis, project));
  const Vec3 nearest = project(on_axis);
  const Vec3 offset = on_axis - nearest;
  const double distance = offset.norm();
  const double depth = other.radius - distance;
  if (depth < depth_min) return std::nullopt;
  const Vec3 normal = distance > 1e-9 ? Vec3(offset / distance) : outward_end_direction(cylinder, end);
  return Touch{nearest - normal * (0.5 * depth), normal, depth};
}

/// How far a cylinder's solid reaches along a unit direction, from its axis' start.
double reach_along(const CollisionCylinder& cylinder, const Vec3& direction) {
  const double cosine = cylinder.direction.dot(direction);
  return std::max(0.0, cosine * cylinder.length) + cylinder.radius * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
}

/// Two flat ends that overlap by more than their rims' rounding: out the shortest way, axes apart or along either.
Touch touch_overlapping_ends(const CollisionCylinder& first, const CollisionCylinder& second,
                             const SegmentPair& closest, const Vec3& position) {
  const Vec3 between_axes = second.axis.at(closest.t) - first.axis.at(closest.s);
  const Vec3 ways[] = {between_axes.stableNormalized(), outward_end_direction(first, closest.s),
                       -outward_end_direction(second, closest.t)};
  Touch touch{position, ways[1], std::numeric_limits<double>::max()};
  for (const Vec3& way : ways) {
    if (way.isZero()) continue;  // axes that cross
    const double depth = reach_along(first, way) + reach_along(second, -way) + (first.axis.a - second.axis.a).dot(way);
    if (depth < touch.depth) touch.normal = way, touch.depth = depth;
  }
  return touch;
}

/// Two flat ends, both with rounded rims.
std::optional<Touch> touch_flat_with_flat(const CollisionCylinder& first, const CollisionCylinder& second,
                                          const SegmentPair& closest, double depth_min) {
  const SolidCylinder core_first = first.solid(kRimRounding);
  const SolidCylinder core_second = second.solid(kRimRounding);
  const auto [p, q] =
      closest_of_convex([&](const Vec3& x) { return core_first.project(x); },
                        [&](const Vec3& x) { return core_second.project(x); }, second.axis.at(closest.t));
  const Vec3 offset = q - p;
  const double distance = offset.norm();
  const double depth = 2.0 * kRimRounding - distance;
  if (depth < depth_min) return std::nullopt;
  if (distance < 0.1 * kRimRounding) return touch_overlapping_ends(first, second, closest, 0.5 * (p + q));
  return Touch{0.5 * (p + q), offset / distance, depth};
}

/// The touch at the closest points of two cylinders' axes.
std::optional<Touch> touch_cylinders(const CollisionCylinder& first, const CollisionCylinder& second,
                                     const SegmentPair& closest, double depth_min) {
  const double depth_of_sides =
      first.radius + second.radius - (first.axis.at(closest.s) - second.axis.at(closest.t)).norm();
  const bool first_flat = is_flat_end(first, closest.s, depth_of_sides);
  const bool second_flat = is_flat_end(second, closest.t, depth_of_sides);
  if (first_flat && second_flat) return touch_flat_with_flat(first, second, closest, depth_min);
  if (first_flat) return touch_flat_with_round(first, closest.s, second, depth_min);
  if (second_flat) {
    auto touch = touch_flat_with_round(second, closest.t, first, depth_min);
    if (touch) touch->normal = -touch->normal;
    return touch;
  }
  return touch_balls(first.axis.at(closest.s), first.radius, second.axis.at(closest.t), second.radius, depth_min);
}

/// How far a place lies beyond a flat end of the cylinder, along its direction: negative before its start.
double beyond_flat_ends(const CollisionCylinder& cylinder, const Vec3& position) {
  const double along = (position - cylinder.axis.a).dot(cylinder.direction);
  if (cylinder.flat_a && along < 0.0) return along;
  if (cylinder.flat_b && along > cylinder.length) return along - cylinder.length;
  return 0.0;
}

/// Nearly parallel cylinders: touches at both ends of the stretch where they run side by side.
void add_line_touches(const CollisionCylinder& first, const CollisionCylinder& second, double depth_min,
                      std::vector<Touch>& out) {
  double from = (second.axis.a - first.axis.a).dot(first.direction);
  double to = (second.axis.b - first.axis.a).dot(first.direction);
  if (from > to) std::swap(from, to);
  from = std::max(from, 0.0);
  to = std::min(to, first.length);
  if (to <= from) return;
  for (const double along : {from, to}) {
    const Vec3 on_first = first.axis.a + along * first.direction;
    const double t = std::clamp((on_first - second.axis.a).dot(second.direction) / second.length, 0.0, 1.0);
    auto touch = touch_balls(on_first, first.radius, second.axis.at(t), second.radius, depth_min);
    // Deeper than they run side by side, they meet end to end instead.
    if (!touch || touch->depth >= to - from) continue;
    // The balls of a slanting pair reach up to 0.15 radii beyond a flat end, where nothing is.
    for (const CollisionCylinder* cylinder : {&first, &second})
      touch->position -= beyond_flat_ends(*cylinder, touch->position) * cylinder->direction;
    if (std::abs(beyond_flat_ends(first, touch->position)) < 0.01 * first.radius) out.push_back(*touch);
  }
}

/// The touch of a box (first) with a ball.
std::optional<Touch> touch_box_with_ball(const scene::Box& box, const Vec3& center, double radius, double depth_min) {
  const Vec3 nearest = project_on_box(box, center);
  const Vec3 offset = center - nearest;
  const double distance = offset.norm();
  if (distance > 1e-12) {
    const double depth = radius - distance;
    if (depth < depth_min) return std::nullopt;
    const Vec3 normal = offset / distance;
    return Touch{nearest - normal * (0.5 * depth), normal, depth};
  }
  // The centre is inside: out through the nearest face.
  Eigen::Matrix<double, 6, 1> inside;
  inside << center - box.min(), box.max() - center;
  Eigen::Index face = 0;
  const double out = inside.minCoeff(&face);
  Vec3 normal = Vec3::Zero();
  normal[face % 3] = face < 3 ? -1.0 : 1.0;
  return Touch{center, normal, out + radius};
}

/// Places all over a disc of radius 1.
std::vector<Eigen::Vector2d> disc_places() {
  constexpr int kAround = 64, kRings = 8;
  std::vector<Eigen::Vector2d> places;
  for (int ring = 1; ring <= kRings; ++ring)
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      places.push_back(Eigen::Vector2d(std::cos(angle), std::sin(angle)) * ring / kRings);
    }
  return places;
}

/// How deep a point lies in a box; negative beside it.
double depth_in(const scene::Box& box, const Vec3& point) {
  return (point - box.min()).cwiseMin(box.max() - point).minCoeff();
}

/// The point of a flat end that lies deepest in a box whose edge may cut into it between the rim points below.
void add_deepest_end_touch(const scene::Box& box, const CollisionCylinder& cylinder, const Vec3& center,
                           std::vector<Touch>& out) {
  const Vec3 extent = cylinder.radius * (1.0 - cylinder.direction.array().square()).max(0.0).sqrt();
  const scene::Box end(center - extent, center + extent);
  if (!box.intersects(end)) return;
  const auto sides = ((end.min().array() < box.min().array()) || (end.max().array() > box.max().array())).count();
  if (sides < 2) return;  // before one face: the deepest is on the rim, toward the face
  static const std::vector<Eigen::Vector2d> places = disc_places();  // misses the rim's deepest by 0.1 % of the radius
  const Vec3 u = cylinder.radius * cylinder.direction.unitOrthogonal(), v = cylinder.direction.cross(u);
  double deepest = 0.0;
  Vec3 at;
  for (const Eigen::Vector2d& place : places) {
    const Vec3 point = center + place.x() * u + place.y() * v;
    const double depth = depth_in(box, point);
    if (depth > deepest) at = point, deepest = depth;
  }
  if (deepest > 0.0) out.push_back(*touch_box_with_ball(box, at, 0.0, 0.0));
}

/// A flat end's rim against a box: the rim point that lies deepest and seven more around, which keep a standing
/// tube upright.
void add_rim_touches(const scene::Box& box, const CollisionCylinder& cylinder, bool at_a, double depth_min,
                     std::vector<Touch>& out) {
  const Vec3 center = at_a ? cylinder.axis.a : cylinder.axis.b;
  const Vec3 toward = project_on_box(box, center) - center;
  const double reach = cylinder.radius - depth_min;
  if (toward.squaredNorm() > reach * reach) return;
  for (const Vec3& rim : rim_points(cylinder, center, toward))
    if (const auto touch = touch_box_with_ball(box, rim, 0.0, depth_min)) out.push_back(*touch);
  add_deepest_end_touch(box, cylinder, center, out);
}

/// Whether all of a segment lies before one and the same face of a box.
bool is_before_one_face(const scene::Box& box, const Segment& segment) {
  int faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = [&](const Vec3& point) {
      return (point[axis] > box.max()[axis]) - (point[axis] < box.min()[axis]);
    };
    const int side_a = side(segment.a);
    if (side_a != side(segment.b)) return false;
    faces += side_a != 0;
  }
  return faces == 1;
}

/// A cylinder across a box's edge, as a tube that leans over the wall.
void add_edge_touch(const scene::Box& box, const CollisionCylinder& cylinder, double depth_min,
                    std::vector<Touch>& out) {
  // There the distance is linear along the axis: least at an end, which joints and rims stand for.
  if (is_before_one_face(box, cylinder.axis)) return;
  const auto project = [&](const Vec3& point) { return project_on_box(box, point); };
  const double t = nearest_parameter(cylinder.axis, project);
  if (is_flat_end(cylinder, t)) {
    const SolidCylinder core = cylinder.solid(kRimRounding);
    const auto [p, q] = closest_of_convex(
        project, [&](const Vec3& x) { return core.project(x); }, cylinder.axis.at(t));
    if ((q - p).squaredNorm() < 1e-18) return;  // deeper than the rounding: the rim's touches see it
    if (const auto touch = touch_box_with_ball(box, q, kRimRounding, depth_min)) out.push_back(*touch);
  } else if (t > 0.0 && t < 1.0) {
    if (const auto touch = touch_box_with_ball(box, cylinder.axis.at(t), cylinder.radius, depth_min))
      out.push_back(*touch);
  }
}

scene::Box inflated(const scene::Box& box, double margin) {
  return {box.min() - Vec3::Constant(margin), box.max() + Vec3::Constant(margin)};
}

/// The closest points of two cylinders' axes where the cylinders come within `gap` (metres).
std::optional<SegmentPair> closest_within(const CollisionCylinder& first, const CollisionCylinder& second, double gap) {
  const SegmentPair closest = closest_on_segments(first.axis, second.axis);
  const double reach = first.radius + second.radius + gap;
  if ((first.axis.at(closest.s) - second.axis.at(closest.t)).squaredNorm() > reach * reach) return std::nullopt;
  return closest;
}

/// The touches of a box with the parts of a tube, in one frame.
void collide_box(const scene::Box& box, const std::vector<Ball>& joints,
                 const std::vector<CollisionCylinder>& cylinders, double depth_min, std::vector<Touch>& out) {
  const scene::Box reach = inflated(box, -std::min(depth_min, 0.0));
  for (const Ball& joint : joints)
    if (const auto touch = touch_box_with_ball(box, joint.center, joint.radius, depth_min)) out.push_back(*touch);
  for (const CollisionCylinder& cylinder : cylinders) {
    if (!reach.intersects(cylinder.bounds)) continue;
    if (cylinder.flat_a) add_rim_touches(box, cylinder, true, depth_min, out);
    if (cylinder.flat_b) add_rim_touches(box, cylinder, false, depth_min, out);
    add_edge_touch(box, cylinder, depth_min, out);
  }
}

/// The same in the box's frame, of what of the tube is near.
void collide_turned(const CollisionBox& box, const CollisionTube& tube, double depth_min, std::vector<Touch>& out) {
  const scene::Box reach = inflated(box.bounds, -std::min(depth_min, 0.0));
  const Pose part_from_world = box.part.world_from_part.inverse();
  std::vector<Ball> joints;
  for (const Ball& joint : tube.joints)
    if (reach.squaredExteriorDistance(joint.center) <= joint.radius * joint.radius)
      joints.push_back({part_from_world * joint.center, joint.radius});
  std::vector<CollisionCylinder> cylinders;
  for (const CollisionCylinder& cylinder : tube.cylinders) {
    if (!reach.intersects(cylinder.bounds)) continue;
    cylinders.push_back(cylinder);
    cylinders.back().place({part_from_world * cylinder.axis.a, part_from_world * cylinder.axis.b});
  }
  const std::size_t begin = out.size();
  collide_box(box.part.box, joints, cylinders, depth_min, out);
  for (std::size_t i = begin; i < out.size(); ++i) {
    out[i].position = box.part.world_from_part * out[i].position;
    out[i].normal = box.part.world_from_part.linear() * out[i].normal;
  }
}

}  // namespace

void find_near_cylinders(const CollisionTube& first, const CollisionTube& second, double reach,
                         std::vector<CylinderPair>& out) {
  const scene::Box reached = inflated(second.bounds, reach);
  if (!first.bounds.intersects(reached)) return;
  for (std::uint32_t i = 0; i < first.cylinders.size(); ++i) {
    const CollisionCylinder& p = first.cylinders[i];
    if (!p.bounds.intersects(reached)) continue;
    const scene::Box cylinder_reach = inflated(p.bounds, reach);
    for (std::uint32_t j = 0; j < second.cylinders.size(); ++j) {
      const CollisionCylinder& q = second.cylinders[j];
      if (!cylinder_reach.intersects(q.bounds)) continue;
      if (closest_within(p, q, reach)) out.push_back({i, j});
    }
  }
}

void collide(const CollisionTube& first, const CollisionTube& second, double depth_min, std::vector<Touch>& out) {
  std::vector<CylinderPair> pairs;
  find_near_cylinders(first, second, -std::min(depth_min, 0.0), pairs);
  collide(first, second, pairs, depth_min, out);
}

void collide(const CollisionTube& first, const CollisionTube& second, const std::vector<CylinderPair>& pairs,
             double depth_min, std::vector<Touch>& out) {
  const std::size_t begin = out.size();
  const double gap = -std::min(depth_min, 0.0);
  for (const CylinderPair& pair : pairs) {
    const CollisionCylinder& p = first.cylinders[pair.first];
    const CollisionCylinder& q = second.cylinders[pair.second];
    if (!p.bounds.intersects(inflated(q.bounds, gap))) continue;
    const auto closest = closest_within(p, q, gap);
    if (!closest) continue;
    if (const auto touch = touch_cylinders(p, q, *closest, depth_min)) out.push_back(*touch);
    if (p.direction.cross(q.direction).squaredNorm() < kParallelSine * kParallelSine)
      add_line_touches(p, q, depth_min, out);
  }
  keep_deepest_of_each_spot(begin, 0.5 * std::min(first.radius, second.radius), out);
}

void collide(const std::vector<CollisionBox>& bin, const CollisionTube& tube, double depth_min,
             std::vector<Touch>& out) {
  const double gap = -std::min(depth_min, 0.0);
  for (const CollisionBox& box : bin) {
    if (!inflated(box.bounds, gap).intersects(tube.bounds)) continue;
    const std::size_t begin = out.size();
    if (box.part.is_turned) collide_turned(box, tube, depth_min, out);
    else collide_box(box.part.box, tube.joints, tube.cylinders, depth_min, out);
    keep_deepest_of_each_spot(begin, 0.5 * tube.radius, out);
  }
}

}  // namespace tubebin::physics
