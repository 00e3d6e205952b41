// The fixed-function lighting model, light by light (lighting_model.md §3 `opengl`):
//
//     L = e_m + a_m a_global + Σ_i att_i spot_i [ a_m a_i + d_m d_i max(0, N·L_i) + f_i s_m s_i max(0, N·H_i)^s ]
//     f_i = 1 if N·L_i > 0 else 0;   H_i = unit(L_i + V)
//
// a_i, d_i, s_i are the light's strength times its ambient, diffuse and specular shares. N is on the side that is seen, V is GL's: to the
// eye point in every projection (viewer local), or minus the view direction (viewer infinite). max(0, N·H)^0 is 1, as in the API's own
// arithmetic: unlike phong's, a highlight of exponent 0 is there wherever f_i is 1.
//
// Where the digits go, as far as that differs from phong.h (u = 2^-53): a product more for the shares, so that the diffuse term loses
// 21 u, and the ambient one 8 u for E and 2 u for products. |δL| ≤ 5 u, |δV| ≤ u; the sum L + V adds 2 u, its normalisation divides by
// |L + V| and adds 4 u. Where |L + V| < 1/2 it is taken in double-double, so
//   N − H                  |δN| + 8 u / |L + V| + 4 u ≤ 21 u, less than the 30 u that phong's Rounding::lobe allows for R − V.
#pragma once

#include "phong.h"

namespace equilux {

struct OpenglRounding {
  static constexpr double ambient = 10, diffuse = 21;
  static double lobe(double exponent) { return Rounding::lobe(exponent) + 1; }
};

// GL's V at the point, unit.
inline Vec3dd opengl_viewer(const World& world, const SurfacePoint& point) {
  if (world.description.infinite_viewer) return -world.camera.forward;
  return world.camera.perspective() ? point.to_viewer : -direction_of(point.position);
}

// H, unit; 0 where L = −V, which has no half vector.
inline Vec3d half_vector(const Arriving& arriving, const Vec3dd& to_viewer) {
  const Vec3d sum = arriving.to_light + to_double(to_viewer);
  const double size = length(sum);
  if (size >= 0.5) return sum * (1 / size);
  const Vec3dd exact = unit(arriving.toward) + to_viewer;
  return largest(to_double(exact)) > exact_zero ? to_double(direction_of(exact)) : Vec3d{};
}

// max(0, N·H)^s
inline double half_vector_highlight(const SurfacePoint& point, const Vec3d& normal, const Arriving& arriving, const Vec3dd& to_viewer,
                                    double exponent) {
  if (exponent == 0) return 1;
  const Vec3d halfway = half_vector(arriving, to_viewer);
  if (!(largest(halfway) > 0)) return 0;
  return power_of_cosine(normal, halfway, exponent,
                         [&] { return to_double(dot(point.normal, direction_of(unit(arriving.toward) + to_viewer))); });
}

}  // namespace equilux
