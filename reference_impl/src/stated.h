// What a sample states of its own error, completed at the ends of what double can do.
//
// The bounds of phong.h, opengl.h and raytraced.h are relative roundings of double's shading. Besides:
//   geometry    is found in double-double, and shows only where lengths are 2^40 apart or more: spread.h's first order, at the first hit, too.
//   underflow   below the smallest normal double, 2^-1022, a product loses up to 2^-1075 absolutely: a few of them per light, each times a
//               coefficient at most. Where 1/(d_c + d_l r + d_q r²) itself is that small, so much of the light's strength.
//   overflow    radiance beyond 1.8e308 is Inf, never NaN, and no digit of it is vouched for.
//   undecided   nor of a sample that hangs on whether two surfaces count as coincident (ray.h).
#pragma once

#include <limits>

#include "spread.h"

namespace equilux {

struct DoublesEnd {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr double smallest_normal = 0x1p-1022;
  static constexpr double lost = 8 * 0x1p-1074 / Rounding::unit;  // of a light's few products, in units of Rounding::unit
};

// A light's part of the bound, in units of Rounding::unit. reflected: the sum of the coefficients that its light is multiplied by.
inline Bands completed(const Bands& shading, const Light& light, const Arriving& arriving, const Bands& reflected, const Moved& moved) {
  const double geometry = turned_to_light(light, arriving, moved) / Rounding::unit;
  Bands bound = shading * (1 + geometry) + (Bands{1, 1, 1} + reflected) * DoublesEnd::lost;
  if (arriving.in_cone && arriving.attenuated < DoublesEnd::smallest_normal) {
    bound = bound + light.given.strength * reflected * (DoublesEnd::smallest_normal / Rounding::unit);
  }
  return bound;
}

// Inf for what no double can hold.
inline Bands shown(const Bands& radiance) {
  const auto held = [](double band) { return std::isfinite(band) ? band : DoublesEnd::infinity; };
  return {held(radiance.r), held(radiance.g), held(radiance.b)};
}

// rounding: in units of Rounding::unit; radiance: as shown. → W/(m²·sr)
inline Bands stated(const Bands& rounding, const Bands& radiance, bool undecided) {
  const auto band = [undecided](double error, double value) {
    if (undecided || !std::isfinite(value) || std::isnan(error)) return DoublesEnd::infinity;
    return error * Rounding::unit + 0x1p-1072;
  };
  return {band(rounding.r, radiance.r), band(rounding.g, radiance.g), band(rounding.b, radiance.b)};
}

}  // namespace equilux
