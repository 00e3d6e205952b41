// The ray-traced lighting model at one surface point (lighting_model.md §3 `raytraced`):
//
//     L_1 = Σ_{N·L_i > 0} E_i τ_i (K_diff (N·L_i) + K_spec max(0, R_i·V)^p) + k_refl  L_refl
//     L_2 = Σ_{N·L_i < 0} E_i τ_i (K_diff |N·L_i| + K_spec max(0, T_i·V)^p) + k_trans L_trans
//     L   = K_emit + K_amb L_amb + (1 − t) L_1 + t L_2
//
// This file has the directions and the local terms; the kernel follows L_refl and L_trans.
//
// Where the digits go, besides phong.h: R, T and every secondary ray are computed in double-double, T_i·V is then as good as R·V. τ of n
// crossings has 2n factors, (1 − t) and t one: (2n + 2) u. A secondary ray's weight gains three factors per bounce, 4 u; sums over h hits
// add h u of the whole.
#pragma once

#include "phong.h"
#include "transport.h"

namespace equilux {

// The mirrored direction of V about N, unit.
inline Vec3dd mirrored_about(const Vec3dd& normal, const Vec3dd& v) {
  return direction_of(normal * (dot(normal, v) * 2.0) - v);
}

// How a direction goes on through a surface.
struct Refraction {
  bool total = false;  // total reflection: there is no direction
  Vec3dd direction;    // unit
  double bend = 1;     // how many times as much it turns, at most, as the incoming direction or the normal does
};

// The way that the direction d, unit, takes through the surface with normal N from a medium of index `from` into one of index `into`:
// with η = from/into, c = N·d, the part along the surface grows η-fold: t = η (d − c N), and the direction is t ± √(1 − t²) N, ± the sign
// of c, so that it goes on to the side that d pointed to. (From 1 − c² it would lose η² digits.) Total reflection: t² > 1; what rounding
// leaves of that counts as 1. In the plane of incidence sin θ_t = η sin θ_i: dθ_t/dθ_i = η cos θ_i / cos θ_t, across it η.
inline Refraction refracted(const Vec3dd& d, const Vec3dd& normal, double from, double into) {
  if (from == into) return {false, d, 1};
  const DoubleDouble c = dot(normal, d), ratio = DoubleDouble(from) / DoubleDouble(into);
  const Vec3dd along = (d - normal * c) * ratio;
  if (!(largest(to_double(along)) < 2)) return {true, {}, 1};
  const DoubleDouble rest = DoubleDouble(1.0) - dot(along, along);
  if (to_double(rest) < -exact_zero) return {true, {}, 1};
  const DoubleDouble root = square_root(rest);
  const double eta = to_double(ratio), grazing = to_double(root) + 0x1p-45;  // the root of what is left of 0
  const Vec3dd onward = along + normal * (to_double(c) < 0 ? -root : root);
  return {false, direction_of(onward), std::fmax(eta, (1 + eta * std::fabs(to_double(c))) / grazing)};
}

// The indices on N's side and behind it: 1 outside the object that was hit, ior inside.
inline double index_in_front(const SurfacePoint& point, const MaterialDescription& material) { return point.outside ? 1 : material.ior; }
inline double index_behind(const SurfacePoint& point, const MaterialDescription& material) { return point.outside ? material.ior : 1; }

// L_trans: how the view ray goes on behind the surface.
inline Refraction refracted_view(const SurfacePoint& point, const MaterialDescription& material) {
  return refracted(-point.to_viewer, point.normal, index_in_front(point, material), index_behind(point, material));
}

// T: how the light of a source behind the surface comes out on the viewer's side.
inline Refraction refracted_light(const SurfacePoint& point, const MaterialDescription& material, const Arriving& arriving) {
  return refracted(-unit(arriving.toward), point.normal, index_behind(point, material), index_in_front(point, material));
}

// max(0, T·V)^p of a light behind the surface; 0 without T.
inline double transmitted_highlight(const SurfacePoint& point, const Vec3d& to_viewer, const Refraction& light, double exponent) {
  if (light.total) return 0;
  return power_of_cosine(to_double(light.direction), to_viewer, exponent,
                         [&] { return to_double(dot(light.direction, point.to_viewer)); });
}

}  // namespace equilux
