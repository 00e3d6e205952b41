// Embree's packet queries, of twice as many rays as a register has doubles. Neighbouring samples: their rays are coherent.
#pragma once

#include "../embree_shim.h"

namespace equilux::packets {

template <int W> struct EmbreePacket;
template <> struct EmbreePacket<2> {
  using RayHit = RTCRayHit4;
  using Ray = RTCRay4;
  static constexpr auto intersect = rtcIntersect4;
  static constexpr auto occluded = rtcOccluded4;
};
template <> struct EmbreePacket<4> {
  using RayHit = RTCRayHit8;
  using Ray = RTCRay8;
  static constexpr auto intersect = rtcIntersect8;
  static constexpr auto occluded = rtcOccluded8;
};
template <> struct EmbreePacket<8> {
  using RayHit = RTCRayHit16;
  using Ray = RTCRay16;
  static constexpr auto intersect = rtcIntersect16;
  static constexpr auto occluded = rtcOccluded16;
};

#if EQUILUX_EMBREE_MAJOR == 3

template <int W>
inline void intersect(const int* valid, RTCScene scene, embree::QueryContextBase& context, typename EmbreePacket<W>::RayHit& rays) {
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  EmbreePacket<W>::intersect(valid, scene, &context, &rays);
}
template <int W>
inline void occluded(const int* valid, RTCScene scene, embree::QueryContextBase& context, typename EmbreePacket<W>::Ray& rays) {
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  EmbreePacket<W>::occluded(valid, scene, &context, &rays);
}

#else

template <int W>
inline void intersect(const int* valid, RTCScene scene, embree::QueryContextBase& context, typename EmbreePacket<W>::RayHit& rays) {
  RTCIntersectArguments arguments{};
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  arguments.feature_mask = RTC_FEATURE_FLAG_ALL;
  arguments.context = &context;
  EmbreePacket<W>::intersect(valid, scene, &rays, &arguments);
}
template <int W>
inline void occluded(const int* valid, RTCScene scene, embree::QueryContextBase& context, typename EmbreePacket<W>::Ray& rays) {
  RTCOccludedArguments arguments{};
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  arguments.feature_mask = RTC_FEATURE_FLAG_ALL;
  arguments.context = &context;
  EmbreePacket<W>::occluded(valid, scene, &rays, &arguments);
}

#endif

}  // namespace equilux::packets
