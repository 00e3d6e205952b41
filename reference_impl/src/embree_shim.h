// The one place that knows which major of Embree is underneath: 3.13 (Debian 12) and 4.3 (Debian 13) differ only in the structs that
// carry a ray query's context and its flags.
//
// The packet queries are always inlined: they are compiled in files of different instruction sets (fast/), which must not share a copy.
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

// Queries of 4, 8 or 16 rays; valid: −1 per ray that takes part, 0 for others; alignment 4 × the number of rays. One per thread.
class PacketQueries {
 public:
#if EQUILUX_EMBREE_MAJOR == 3
  [[gnu::always_inline]] explicit inline PacketQueries(bool coherent) {
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
#define EQUILUX_QUERIES_OF(N)                                                                                            \
  [[gnu::always_inline]] inline void intersect(const int* valid, RTCScene scene, RTCRayHit##N& rays) {                   \
    rtcIntersect##N(valid, scene, &context_, &rays);                                                                     \
  }                                                                                                                      \
  [[gnu::always_inline]] inline void occluded(const int* valid, RTCScene scene, RTCRay##N& rays) {                       \
    rtcOccluded##N(valid, scene, &context_, &rays);                                                                      \
  }
#else
  [[gnu::always_inline]] explicit inline PacketQueries(bool coherent) {
    rtcInitIntersectArguments(&intersect_);
    rtcInitOccludedArguments(&occluded_);
    intersect_.flags = occluded_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
#define EQUILUX_QUERIES_OF(N)                                                                                            \
  [[gnu::always_inline]] inline void intersect(const int* valid, RTCScene scene, RTCRayHit##N& rays) {                   \
    rtcIntersect##N(valid, scene, &rays, &intersect_);                                                                   \
  }                                                                                                                      \
  [[gnu::always_inline]] inline void occluded(const int* valid, RTCScene scene, RTCRay##N& rays) {                       \
    rtcOccluded##N(valid, scene, &rays, &occluded_);                                                                     \
  }
#endif
  EQUILUX_QUERIES_OF(4)
  EQUILUX_QUERIES_OF(8)
  EQUILUX_QUERIES_OF(16)
#undef EQUILUX_QUERIES_OF

 private:
#if EQUILUX_EMBREE_MAJOR == 3
  RTCIntersectContext context_;
#else
  RTCIntersectArguments intersect_;
  RTCOccludedArguments occluded_;
#endif
};

}  // namespace equilux::embree
