#include "scan/mesh_caster.hpp"

#include <cmath>
#include <limits>

namespace tubebin::scan {
namespace {

struct MeshQuery : embree::QueryContext {
  MeshQuery(const Vec3& ray, double least) : direction(ray), depth_min(least) { embree::init_context(*this); }

  const Vec3& direction;
  double depth_min;
  double first = std::numeric_limits<double>::infinity();
};

/// Where t * direction is on the triangle; NaN or infinity where it never is. The signs on both sides of an edge come
/// from the same numbers, so that no ray passes between two triangles.
double depth_on(const scene::Triangle& triangle, const Vec3& direction) {
  const auto& [a, b, c] = triangle.corners;
  const double u = direction.dot(b.cross(c)), v = direction.dot(c.cross(a)), w = direction.dot(a.cross(b));
  const bool is_inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
  if (!is_inside) return std::numeric_limits<double>::infinity();
  const Vec3 normal = (b - a).cross(c - a);
  return normal.dot(a) / normal.dot(direction);
}

const scene::Triangle& triangle_of(const void* all, unsigned i) {
  return (*static_cast<const std::vector<scene::Triangle>*>(all))[i];
}

void triangle_bounds(const RTCBoundsFunctionArguments* arguments) {
  Eigen::AlignedBox3d box;
  for (const Vec3& corner : triangle_of(arguments->geometryUserPtr, arguments->primID).corners) box.extend(corner);
  embree::set_bounds(box, *arguments->bounds_o);
}

void intersect_triangle(const RTCIntersectFunctionNArguments* arguments) {
  auto& query = static_cast<MeshQuery&>(*arguments->context);
  const double depth = depth_on(triangle_of(arguments->geometryUserPtr, arguments->primID), query.direction);
  if (!(depth >= query.depth_min && depth < query.first)) return;
  query.first = depth;
  float& end = RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0);
  end = std::min(end, embree::search_end(depth));
}

}  // namespace

MeshCaster::MeshCaster(std::vector<scene::Triangle> triangles)
    : triangles_(std::move(triangles)), scene_(rtcNewScene(embree::device().get())) {
  const embree::Geometry geometry(rtcNewGeometry(embree::device().get(), RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(triangles_.size()));
  rtcSetGeometryUserData(geometry.get(), &triangles_);
  rtcSetGeometryBoundsFunction(geometry.get(), triangle_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry.get(), intersect_triangle);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene_.get(), geometry.get());
  rtcCommitScene(scene_.get());
  embree::check_device(embree::device());
}

double MeshCaster::first_depth(const Vec3& direction, double depth_min, double depth_max) const {
  RTCRayHit ray{};
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = embree::search_start(depth_min);
  ray.ray.tfar = embree::search_end(depth_max);
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  MeshQuery query(direction, depth_min);
  embree::intersect(scene_.get(), query, ray);
  return query.first <= depth_max ? query.first : std::numeric_limits<double>::infinity();
}

}  // namespace tubebin::scan
