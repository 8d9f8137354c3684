// The one place that tells Embree 3 from Embree 4. Handles release themselves; errors become exceptions.
#pragma once

#if TUBEBIN_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <memory>

#include "tubebin/core/geometry.hpp"

namespace tubebin::embree {

#if TUBEBIN_EMBREE_MAJOR >= 4
using QueryContext = RTCRayQueryContext;

inline void init_context(QueryContext& context) { rtcInitRayQueryContext(&context); }

inline void intersect(RTCScene scene, QueryContext& context, RTCRayHit& ray) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(scene, &ray, &arguments);
}

/// Neighbouring rays; those with valid[i] = 0 are left out, the others have -1.
inline void intersect(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &rays, &arguments);
}
#else
using QueryContext = RTCIntersectContext;

inline void init_context(QueryContext& context) { rtcInitIntersectContext(&context); }

inline void intersect(RTCScene scene, QueryContext& context, RTCRayHit& ray) { rtcIntersect1(scene, &context, &ray); }

/// Neighbouring rays; those with valid[i] = 0 are left out, the others have -1.
inline void intersect(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &context, &rays);
}
#endif

template <typename Handle, void (*release)(Handle)>
struct Release {
  using pointer = Handle;
  void operator()(Handle handle) const { release(handle); }
};

using Device = std::unique_ptr<RTCDevice, Release<RTCDevice, rtcReleaseDevice>>;
using Scene = std::unique_ptr<RTCScene, Release<RTCScene, rtcReleaseScene>>;
using Geometry = std::unique_ptr<RTCGeometry, Release<RTCGeometry, rtcReleaseGeometry>>;

/// Throws std::runtime_error where Embree has failed.
void check_device(const Device& device);
/// One for all scenes: making it takes a third of a millisecond.
const Device& device();

/// What Embree is told of a body's bounds.
void set_bounds(const Eigen::AlignedBox3d& box, RTCBounds& bounds);
/// The single precision bound just before a depth (metres).
inline float search_start(double depth_min) {
  return std::max(0.0F, static_cast<float>(depth_min) * (1.0F - 0x1p-22F));
}
/// Just beyond it, so that what is equally deep is still looked at.
inline float search_end(double depth) { return static_cast<float>(std::max(depth, 0.0)) * (1.0F + 0x1p-22F) + 1e-9F; }

}  // namespace tubebin::embree
