#include "scan/ray_caster.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace tubebin {
namespace {

/// Embree walks its tree in single precision with rays from the origin: a direction and a bound are each off
/// by at most 2^-24 of the distance, the box test by a few times that. Bounds grow by 32 x 2^-24 of the
/// farthest corner's distance (4 micrometres at 2 m), so that no solid is missed; what is hit is then decided
/// in double precision.
constexpr double kBoundsPadding = 32.0 * 0x1p-24;

/// The single precision bound just beyond a depth, so that what is equally deep is still looked at.
float beyond(double depth) { return static_cast<float>(std::max(depth, 0.0)) * (1.0F + 0x1p-22F) + 1e-9F; }

/// What Embree hands through to the callbacks of one ray.
struct RayQuery : embree::QueryContext {
  RayQuery(const Vec3& ray_direction, double ray_depth_min) : direction(ray_direction), depth_min(ray_depth_min) {
    embree::init_context(*this);
  }

  /// Equal depths go to the lower label, so that the result does not depend on the order of traversal.
  void offer(const Interval& inside, Label label) {
    if (inside.empty() || inside.end < depth_min) return;
    if (inside.begin < depth_min) begins_inside = true;
    if (inside.begin < first.depth || (inside.begin == first.depth && label < first.label)) {
      first = {inside.begin, label};
      enters_bore = false;
    }
  }

  template <typename Solid>
  void offer(const Labelled<Solid>& labelled) {
    const Interval inside = labelled.solid.intersect(direction);
    offer(inside, labelled.label);
    if (labelled.bore_radius == 0.0 || inside.empty() || first.label != labelled.label || first.depth != inside.begin)
      return;
    // Only a cap's plane gives the solid and its bore the same first point.
    enters_bore |= labelled.solid.intersect(direction, labelled.bore_radius).begin == inside.begin;
  }

  Vec3 direction;
  double depth_min;
  Hit first;
  bool begins_inside = false;
  bool enters_bore = false;  ///< at `first`, through the open end of a hollow tube
};

template <typename Solid>
using Solids = std::vector<Labelled<Solid>>;

template <typename Solid>
void solid_bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& solids = *static_cast<const Solids<Solid>*>(arguments->geometryUserPtr);
  const Eigen::AlignedBox3d box = solids[arguments->primID].solid.bounds();
  const double padding = kBoundsPadding * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm();
  const Eigen::Vector3f low = (box.min().array() - padding).cast<float>();
  const Eigen::Vector3f high = (box.max().array() + padding).cast<float>();
  RTCBounds& bounds = *arguments->bounds_o;
  bounds.lower_x = low.x();
  bounds.lower_y = low.y();
  bounds.lower_z = low.z();
  bounds.upper_x = high.x();
  bounds.upper_y = high.y();
  bounds.upper_z = high.z();
}

template <typename Solid>
void intersect_solid(const RTCIntersectFunctionNArguments* arguments) {
  const auto& solid = (*static_cast<const Solids<Solid>*>(arguments->geometryUserPtr))[arguments->primID];
  auto& query = *static_cast<RayQuery*>(arguments->context);
  query.offer(solid);
  auto& ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray;
  ray.tfar = std::min(ray.tfar, beyond(query.first.depth));
}

template <typename Solid>
void attach(const embree::Device& device, const embree::Scene& scene, const Solids<Solid>& solids) {
  const embree::Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(solids.size()));
  rtcSetGeometryUserData(geometry.get(), const_cast<Solids<Solid>*>(&solids));
  rtcSetGeometryBoundsFunction(geometry.get(), solid_bounds<Solid>, nullptr);
  rtcSetGeometryIntersectFunction(geometry.get(), intersect_solid<Solid>);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene.get(), geometry.get());
}

void check_device(const embree::Device& device) {
  const RTCError error = rtcGetDeviceError(device.get());
  if (error != RTC_ERROR_NONE) throw std::runtime_error(fmt::format("Embree failed with error {}", int{error}));
}

RTCRayHit make_ray(const Vec3& direction, double depth_min, double depth_max) {
  RTCRayHit hit{};
  hit.ray.dir_x = static_cast<float>(direction.x());
  hit.ray.dir_y = static_cast<float>(direction.y());
  hit.ray.dir_z = static_cast<float>(direction.z());
  hit.ray.tnear = std::max(0.0F, static_cast<float>(depth_min) * (1.0F - 0x1p-22F));
  hit.ray.tfar = beyond(depth_max);
  hit.ray.mask = ~0U;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return hit;
}

}  // namespace

namespace {

/// Thinner gaps between the solids of one body, and thinner walls, are rounding (metres).
constexpr double kSliver = 1e-9;

/// The union of intervals, in order.
std::vector<Interval> merged(std::vector<Interval>& parts) {
  std::ranges::sort(parts, {}, &Interval::begin);
  std::vector<Interval> whole;
  for (const Interval& part : parts) {
    if (whole.empty() || part.begin > whole.back().end + kSliver) whole.push_back(part);
    else whole.back().end = std::max(whole.back().end, part.end);
  }
  return whole;
}

/// What intervals leave of [begin, end], in order.
std::vector<Interval> without(Interval part, const std::vector<Interval>& holes) {
  std::vector<Interval> left;
  const auto keep = [&](double begin, double end) {
    if (end - begin > kSliver) left.push_back({begin, end});
  };
  for (const Interval& hole : holes) {
    if (hole.end <= part.begin || hole.begin >= part.end) continue;
    keep(part.begin, hole.begin);
    part.begin = hole.end;
  }
  keep(part.begin, part.end);
  return left;
}

}  // namespace

double first_boundary(std::vector<Interval>& parts, std::vector<Interval>& bores, double depth_min) {
  if (bores.empty()) return first_boundary(parts, depth_min);
  const std::vector<Interval> holes = merged(bores);
  for (const Interval& part : merged(parts))
    for (const Interval& wall : without(part, holes)) {
      if (wall.begin >= depth_min) return wall.begin;
      if (wall.end >= depth_min) return wall.end;
    }
  return std::numeric_limits<double>::infinity();
}

double first_boundary(std::vector<Interval>& parts, double depth_min) {
  std::ranges::sort(parts, {}, &Interval::begin);
  double first = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < parts.size();) {
    Interval merged = parts[i++];
    while (i < parts.size() && parts[i].begin <= merged.end) merged.end = std::max(merged.end, parts[i++].end);
    if (merged.begin >= depth_min) return std::min(first, merged.begin);
    if (merged.end >= depth_min) first = std::min(first, merged.end);
  }
  return first;
}

RayCaster::RayCaster(SceneSolids solids, double depth_min, double depth_max)
    : solids_(std::move(solids)),
      depth_min_(depth_min - kDepthTolerance),
      depth_max_(depth_max + kDepthTolerance),
      device_(rtcNewDevice("threads=1")) {
  check_device(device_);
  scene_.reset(rtcNewScene(device_.get()));
  attach(device_, scene_, solids_.cylinders);
  attach(device_, scene_, solids_.spheres);
  rtcCommitScene(scene_.get());
  check_device(device_);
}

Hit RayCaster::first_hit(const Vec3& direction) const {
  RayQuery query(direction, depth_min_);
  const Vec3 inverse = inverse_direction(direction);
  for (const Box& box : solids_.bin) query.offer(intersect(box, inverse), 0);
  RTCRayHit ray = make_ray(direction, depth_min_, std::min(depth_max_, query.first.depth));
  embree::intersect(scene_.get(), query, ray);
  const Hit hit = query.begins_inside || query.enters_bore ? first_boundary_hit(direction) : query.first;
  return hit.depth <= depth_max_ ? hit : Hit{};
}

Hit RayCaster::first_boundary_hit(const Vec3& direction) const {
  struct Body {
    std::vector<Interval> parts;
    std::vector<Interval> bores;
  };
  std::map<Label, Body> bodies;
  const auto add = [](const Interval& inside, std::vector<Interval>& to) {
    if (!inside.empty()) to.push_back(inside);
  };
  const auto add_solids = [&](const auto& solids) {
    for (const auto& [solid, label, bore_radius] : solids) {
      const Interval inside = solid.intersect(direction);
      if (inside.empty()) continue;
      Body& body = bodies[label];
      body.parts.push_back(inside);
      if (bore_radius > 0.0) add(solid.intersect(direction, bore_radius), body.bores);
    }
  };
  const Vec3 inverse = inverse_direction(direction);
  for (const Box& box : solids_.bin) add(intersect(box, inverse), bodies[0].parts);
  add_solids(solids_.cylinders);
  add_solids(solids_.spheres);
  Hit first;
  for (auto& [label, body] : bodies) {
    const double depth = first_boundary(body.parts, body.bores, depth_min_);
    if (depth < first.depth) first = {depth, label};
  }
  return first;
}

}  // namespace tubebin
