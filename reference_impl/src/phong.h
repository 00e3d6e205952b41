// The local lighting model, light by light (lighting_model.md §3 `phong`):
//
//     L(V) = K_emit + K_amb L_amb + Σ_i E_i g_i [ K_diff (N·L_i) + K_spec max(0, R_i·V)^p ],   R = 2 (N·L) N − L
//
// Where the digits go. P, N, V and L come in double-double (relative 1e-28 and better, after the amplification by distant small spheres
// and narrow views), so what is left is the rounding of the shading itself, in double; u = 2^-53, p the exponent:
//   E                      r², √, the attenuation and a quotient: relative 8 u.
//   N, V; L                rounded components: |δN|, |δV| ≤ u; scaled by 1/r: |δL| ≤ 5 u.
//   N·L                    |δN| + |δL| + 3 u for the sum: 9 u. With E and three products: 20 u E K_diff. Below 2^-10, where that would show
//                          in the picture's own digits, N·L comes from the double-doubles.
//   R − V                  2 |δN| + 2 δ(N·L) + |δL| + |δV| + 4 u = 30 u =: δ.
//   max(0, R·V)^p          with d = |R − V|, cos = 1 − d²/2: p d e^(−p d²/2) δ ≤ √(p/e) δ = 18 √p u. (From a rounded cosine it would be
//                          p × 9 u at the peak, 30 times as much at p = 1000.) exp and log1p add 2 u, E and products 11 u.
//                          p < 1: p cos^(p−1) is unbounded, so below 1/8 the cosine is taken in double-double; above, 45 u.
//   cos^e of a spot        the same, except for e ≥ 4096: −L − axis then comes from the double-doubles, and with p d²/2 e^(−p d²/2) ≤ 1/e
//                          what is left is the rounding of d²/2, 6 u, of the power and of products: 16 u for every exponent.
//   the sum                (lights + 3) u L.
//   gates and cones        compared in double; where rounding could tip them, in double-double. There |x| ≤ 2^-85 counts as 0, so a
//                          light in a surface's own plane is not in front of it, and a point on the cone is inside it.
// That is the bound of channel `rounding`: 7e-14 × E (K_diff + K_spec) at p = 1000.
#pragma once

#include "surface.h"

namespace equilux {

// A light as one surface point sees it.
struct Arriving {
  Vec3dd toward;         // from the point to the light, exact, not unit
  Vec3d to_light;        // L, unit
  double distance = 0;   // r; 1 for a directional light
  double position_size = 0;  // |P| / r: how much larger than 2^-104 the rounding of L is
  bool in_cone = true;
  double share = 0;      // E = strength × share
  double attenuated = 0;  // the same without the cone's cos^e: what the rounding of cos^e is relative to
};

constexpr double exact_zero = 0x1p-85;

// Bounds derived above, in units of u = 2^-53.
struct Rounding {
  static constexpr double unit = 0x1p-53;
  static constexpr double diffuse = 20;
  static double lobe(double exponent) { return (exponent < 1 ? 45 : 0) + 18 * std::sqrt(exponent) + 13; }
  // |−L − axis| has an error below δ.
  static double cone(double exponent) { return exponent >= tight_spot ? 16 : exponent > 0 ? lobe(exponent) : 0; }
  static constexpr double tight_spot = 4096;
};

// max(0, cos)^exponent of the angle between unit vectors u and v, of which u − v is given; 0 where cos ≤ 0, for every exponent. exact_cosine() is asked for only
// where the double's digits do not suffice.
template <class ExactCosine> double power_of_chord(const Vec3d& apart, double exponent, const ExactCosine& exact_cosine) {
  const double versine = 0.5 * dot(apart, apart), cosine = 1 - versine;
  if (cosine < -0x1p-40) return 0;
  if (cosine < (exponent < 1 ? 0.125 : 0x1p-40)) {
    const double exact = exact_cosine();
    return exact > exact_zero ? std::pow(exact, exponent) : 0;
  }
  return std::exp(exponent * std::log1p(-versine));
}

// The same of u and v.
template <class ExactCosine>
double power_of_cosine(const Vec3d& u, const Vec3d& v, double exponent, const ExactCosine& exact_cosine) {
  return power_of_chord(u - v, exponent, exact_cosine);
}

// Whether the point is in the light's cone, to 2^-85 of the light's own directions: the versine of the angle to the axis, which keeps its
// digits where the cosine has none left, is not above the cone's.
inline bool reaches_cone(const Light& light, const Arriving& arriving) {
  const Vec3dd apart = unit(arriving.toward) + light.axis;
  const DoubleDouble versine = dot(apart, apart) * 0.5;
  const double tolerance = exact_zero * (1 + arriving.position_size) * std::sqrt(2 * to_double(light.cone_versine));
  return to_double(versine - light.cone_versine) <= tolerance;
}

template <bool Spot> Arriving arriving_light(const Light& light, const SurfacePoint& point) {
  Arriving arriving;
  if (light.given.kind == LightKind::directional) {
    arriving.toward = light.to_light;
    arriving.to_light = light.to_light_rounded;
    arriving.distance = 1;
    arriving.share = arriving.attenuated = 1;
    return arriving;
  }
  arriving.toward = light.position - point.position;
  const Vec3d toward = to_double(arriving.toward);
  const double r2 = dot(toward, toward), r = std::sqrt(r2);
  if (r == 0) return arriving;  // the light lies in the point: it has no direction, and is not in front
  arriving.distance = r;
  arriving.to_light = toward * (1 / r);
  arriving.position_size = largest(to_double(point.position)) / r;
  arriving.share = arriving.attenuated = 1 / (light.given.constant + light.given.linear * r + light.given.quadratic * r2);
  if constexpr (Spot) {
    if (light.given.kind == LightKind::spot) {
      const Vec3d away = -arriving.to_light;
      const auto exact_cosine = [&] { return -(dot(arriving.toward, light.axis) / length(arriving.toward)); };
      // inclusive: cos ≥ cos(half-angle)
      const double inside = dot(away, light.axis_rounded) - to_double(light.cone_cosine);
      arriving.in_cone = std::fabs(inside) > 0x1p-40 ? inside > 0 : reaches_cone(light, arriving);
      if (!arriving.in_cone) {
        arriving.share = 0;
      } else if (light.given.exponent > 0) {
        const bool tight = light.given.exponent >= Rounding::tight_spot;
        const Vec3d apart = tight ? to_double(-unit(arriving.toward) - light.axis) : away - light.axis_rounded;
        arriving.share *= power_of_chord(apart, light.given.exponent, [&] { return to_double(exact_cosine()); });
      }
    }
  }
  return arriving;
}

// N·L to its own last digits, 0 where rounding is all that is left of it.
inline double cosine_to_light(const SurfacePoint& point, const Vec3d& normal, const Arriving& arriving) {
  const double cosine = dot(normal, arriving.to_light);
  if (std::fabs(cosine) > 0x1p-10) return cosine;
  const double exact = to_double(dot(point.normal, arriving.toward)) / arriving.distance;
  return std::fabs(exact) > exact_zero * (1 + arriving.position_size) ? exact : 0;
}

// max(0, R·V)^p
inline double highlight(const SurfacePoint& point, const Vec3d& normal, const Vec3d& to_viewer, const Arriving& arriving,
                        double cosine, double exponent) {
  const Vec3d mirrored = normal * (2 * cosine) - arriving.to_light;
  return power_of_cosine(mirrored, to_viewer, exponent, [&] {
    const Vec3dd L = unit(arriving.toward);
    return to_double(dot(point.normal, L) * dot(point.normal, point.to_viewer) * 2.0 - dot(L, point.to_viewer));
  });
}

}  // namespace equilux
