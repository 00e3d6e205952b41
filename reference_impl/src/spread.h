// How far a path may have strayed: the rounding of double-double geometry, carried from hit to hit.
//
// Between plane surfaces it stays what it is, near 2^-96, and nothing of it reaches a double. But every reflection off a ball turns a
// displacement into a change of direction, and over some distance back into a larger displacement: between two balls it grows tenfold
// or more with each, and after thirty of them no precision is enough. So it is followed, to first order, and where it comes near a
// double's own rounding the bound of channel `rounding` says so. As always that bound holds while the path signature does.
//
// Along a ray of length s:       across' = across + s turned + e size
// At a surface, c = |Ng·D|:      the point moves by across' / c; its normal by (point's move) × curvature
// Mirrored:                      turned' = turned + 2 δN; across' stays (a mirror is an isometry)
// Refracted, with its `bend`:    turned' = bend turned + (bend + 1) δN; across' × max(1, c' / c)
// c' = |Ng·D'|. Each step adds rounding of its own, e = 2^-96, times the bend.
#pragma once

#include "phong.h"

namespace equilux {

constexpr double geometry_rounding = 0x1p-96;

// Of a ray where it starts.
struct Spread {
  double across_m = 0, turned = 0;
};

// Of a surface point.
struct Moved {
  double across_m = 0, view = 0, position_m = 0, normal = 0;

  double turned() const { return view + normal; }
};

constexpr double mirror_bend = 1;

// |change of N| per metre along the surface at the point: an upper bound.
double curvature(const World& world, const SurfacePoint& point);

// Metres: the lengths that the crossing was summed up of. A sphere's are its radius and its distance, however near its surface is.
double rounding_size(const World& world, const SurfacePoint& point);

inline double across_surface(const SurfacePoint& point, const Vec3d& direction) {
  return std::fabs(dot(point.geometric, direction)) / length(point.geometric);
}

inline Moved moved_by(const World& world, const Spread& spread, const SurfacePoint& point) {
  Moved moved;
  moved.view = spread.turned + geometry_rounding;
  moved.across_m = spread.across_m + point.distance * spread.turned +
                   geometry_rounding * (world.eye_size + point.position_size + rounding_size(world, point));
  moved.position_m = moved.across_m / std::fmax(across_surface(point, to_double(point.to_viewer)), 0x1p-40);
  moved.normal = geometry_rounding + moved.position_m * curvature(world, point);
  return moved;
}

// What the eye sees.
inline Moved moved_by_camera(const World& world, const SurfacePoint& point) { return moved_by(world, {}, point); }

// How far the direction to a light may be off, radians.
inline double turned_to_light(const Light& light, const Arriving& arriving, const Moved& moved) {
  return light.given.kind == LightKind::directional ? moved.turned() : moved.turned() + moved.position_m / arriving.distance;
}

inline Spread spread_beyond(const Moved& moved, const SurfacePoint& point, const Vec3d& direction, double bend) {
  const double before = std::fmax(across_surface(point, to_double(point.to_viewer)), 0x1p-40);
  return {moved.across_m * std::fmax(1, across_surface(point, direction) / before),
          bend * moved.view + (bend + 1) * moved.normal + bend * geometry_rounding};
}

}  // namespace equilux
