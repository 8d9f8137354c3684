#include "scan/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace tubebin::scan {
namespace {

/// What Embree hands through to the callbacks. A ray's id is its lane.
struct PacketQuery : embree::QueryContext {
  explicit PacketQuery(RayPacket& rays) : packet(rays) { embree::init_context(*this); }

  RayPacket& packet;
};

template <typename Solid>
using Solids = std::vector<Labelled<Solid>>;

template <typename Solid>
void solid_bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& solids = *static_cast<const Solids<Solid>*>(arguments->geometryUserPtr);
  embree::set_bounds(solids[arguments->primID].solid.bounds(), *arguments->bounds_o);
}

/// Rays that Embree has not found near the solid are looked at too: it is as much a part of their scene.
template <typename Solid>
void intersect_solid(const RTCIntersectFunctionNArguments* arguments) {
  const auto& solid = (*static_cast<const Solids<Solid>*>(arguments->geometryUserPtr))[arguments->primID];
  RayPacket& packet = static_cast<PacketQuery*>(arguments->context)->packet;
  packet.offer(solid);
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  if (arguments->N == kLanes) return packet.limit(std::span<float, kLanes>(&RTCRayN_tfar(rays, kLanes, 0), kLanes));
  for (unsigned i = 0; i < arguments->N; ++i) {
    float& end = RTCRayN_tfar(rays, arguments->N, i);
    end = std::min(end, embree::search_end(packet.depth(static_cast<int>(RTCRayN_id(rays, arguments->N, i)))));
  }
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
      scene_(rtcNewScene(embree::device().get())) {
  attach(embree::device(), scene_, solids_.cylinders);
  attach(embree::device(), scene_, solids_.spheres);
  attach(embree::device(), scene_, solids_.cylinders_around);
  attach(embree::device(), scene_, solids_.boxes_around);
  rtcCommitScene(scene_.get());
  if (!solids_.bin_mesh.empty()) mesh_ = std::make_unique<MeshCaster>(solids_.bin_mesh);
  embree::check_device(embree::device());
}

Hit RayCaster::first_hit(const Vec3& direction) const {
  RayPacket packet({&direction, 1}, depth_min_);
  packet.offer_bin(solids_.bin);
  RTCRayHit ray{};
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = embree::search_start(depth_min_);
  ray.ray.tfar = embree::search_end(std::min(depth_max_, packet.depth(0)));
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  PacketQuery query(packet);
  embree::intersect(scene_.get(), query, ray);
  decide(packet, 1);
  return packet.first(0);
}

void RayCaster::find_first_hits(RayPacket& packet, int count, const BodiesInReach& bodies) const {
  packet.offer_bin(solids_.bin, bodies.boxes);
  if (bodies.solid_count > BodiesInReach::kFew) offer_by_tree(packet, count);
  else offer_few(packet, bodies);
  decide(packet, count);
}

bool RayCaster::find_bin_points(const scene::Camera& camera, int column, int row, BoxFlags boxes,
                                std::span<cloud::Point> points) const {
  return !mesh_ && RayPacket::get_bin_points(camera, column, row, solids_.bin, boxes, depth_min_, depth_max_, points);
}

void RayCaster::offer_few(RayPacket& packet, const BodiesInReach& bodies) const {
  for (std::size_t i = 0; i < bodies.solid_count; ++i)
    visit_solid(solids_, bodies.solids[i], [&](const auto& solid) { packet.offer(solid); });
}

void RayCaster::offer_by_tree(RayPacket& packet, int count) const {
  alignas(32) int valid[kLanes];
  RTCRayHit8 rays{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const Vec3 direction = packet.direction(lane);
    valid[lane] = lane < count ? -1 : 0;
    rays.ray.dir_x[lane] = static_cast<float>(direction.x());
    rays.ray.dir_y[lane] = static_cast<float>(direction.y());
    rays.ray.dir_z[lane] = static_cast<float>(direction.z());
    rays.ray.tnear[lane] = embree::search_start(depth_min_);
    rays.ray.tfar[lane] = embree::search_end(depth_max_);
    rays.ray.mask[lane] = ~0U;
    rays.ray.id[lane] = static_cast<unsigned>(lane);
    rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  }
  packet.limit(rays.ray.tfar);
  PacketQuery query(packet);
  embree::intersect(valid, scene_.get(), query, rays);
}

void RayCaster::decide(RayPacket& packet, int count) const {
  if (packet.has_special())
    for (int lane = 0; lane < count; ++lane)
      if (packet.is_special(lane)) packet.set_first(lane, first_boundary_hit(packet.direction(lane)));
  if (mesh_)
    for (int lane = 0; lane < count; ++lane) {
      const double end = std::min(depth_max_, packet.depth(lane));
      const double depth = mesh_->first_depth(packet.direction(lane), depth_min_, end);
      if (depth <= end) packet.set_first(lane, {depth, 0});  // 0 is the lowest label: first at equal depths
    }
  packet.forget_beyond(depth_max_);
}

Hit RayCaster::first_boundary_hit(const Vec3& direction) const {
  struct Body {
    std::vector<Interval> parts;
    std::vector<Interval> bores;
  };
  std::map<cloud::Label, Body> bodies;
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
  for (const SolidBox& box : solids_.bin) add(box.intersect(direction), bodies[0].parts);
  for (const auto& box : solids_.boxes_around) add(box.solid.intersect(direction), bodies[box.label].parts);
  add_solids(solids_.cylinders);
  add_solids(solids_.spheres);
  add_solids(solids_.cylinders_around);
  Hit first;
  for (auto& [label, body] : bodies) {
    const double depth = first_boundary(body.parts, body.bores, depth_min_);
    if (depth < first.depth) first = {depth, label};
  }
  return first;
}

}  // namespace tubebin::scan
