// The one place that tells Embree 3 from Embree 4. Handles release themselves; errors become exceptions.
#pragma once

#if TUBEBIN_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>

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

}  // namespace tubebin::embree
