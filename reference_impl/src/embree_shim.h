// The one place that knows which major of Embree is underneath: 3.13 (Debian 12) and 4.3 (Debian 13) differ only in the structs that
// carry a ray query's context.
#pragma once

#if EQUILUX_EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

namespace equilux::embree {

#if EQUILUX_EMBREE_MAJOR == 3
using QueryContextBase = RTCIntersectContext;
inline void initialise(QueryContextBase& context) { rtcInitIntersectContext(&context); }
inline void intersect(RTCScene scene, QueryContextBase& context, RTCRayHit& ray_hit) { rtcIntersect1(scene, &context, &ray_hit); }
#else
using QueryContextBase = RTCRayQueryContext;
inline void initialise(QueryContextBase& context) { rtcInitRayQueryContext(&context); }
inline void intersect(RTCScene scene, QueryContextBase& context, RTCRayHit& ray_hit) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(scene, &ray_hit, &arguments);
}
#endif

}  // namespace equilux::embree
