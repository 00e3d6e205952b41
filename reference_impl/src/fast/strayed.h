// How far rays and the points that they meet are from where they should be: the float mode's part of spread.h, to first order, in
// scaled units of length. What a discontinuity makes of it is not in here: that is the business of class `edge`.
//
//   a ray     is displaced by `across` and turned by `turned`. The eye's: x and y have two roundings, |D| ≥ 1: turned 2 u.
//   a point   Embree's crossing is as good as the rounded vertices, centres and matrices and a dot product over them: off the surface by
//             8 u of the lengths involved; moved along it by (across + t turned + 8 u size) / c, c = |Ng·D|.
//   N         4 u of its own, and curvature × the point's move.
//   onward    beside() adds 2^-19 √3 of the size to `across`; mirrored and refracted as in spread.h, 8 u for the arithmetic.
#pragma once

#include "lanes.h"

namespace equilux::fast {

constexpr float unit_roundoff = 0x1p-24f;
constexpr float least_slope = 0x1p-10f;  // below, a ray passes along the surface: a silhouette

template <int W> struct Strayed {
  Floats<W> across{}, turned{};
};

// Of a surface point.
template <int W> struct MovedPoint {
  Floats<W> across{}, position{}, normal{}, view{}, slope{};
};

template <int W> inline Strayed<W> of_the_eye() { return {Floats<W>{}, all_of<W>(2 * unit_roundoff)}; }

// along: t × |D|; size: of the lengths that were added up.
template <int W>
inline MovedPoint<W> moved_point(const Strayed<W>& ray, Floats<W> along, Floats<W> size, Floats<W> slope, Floats<W> curvature) {
  MovedPoint<W> moved;
  moved.slope = larger<W>(slope, all_of<W>(least_slope));
  moved.across = ray.across + along * ray.turned + 8 * unit_roundoff * size;
  moved.position = moved.across / moved.slope;
  moved.normal = 4 * unit_roundoff + curvature * moved.position;
  moved.view = ray.turned + unit_roundoff;
  return moved;
}

template <int W> inline Strayed<W> strayed_beyond(const MovedPoint<W>& moved, Floats<W> size, Floats<W> bend, Floats<W> slope) {
  return {moved.across * larger<W>(all_of<W>(1.0f), slope / moved.slope) + 0x1.bcp-19f * size,
          bend * (moved.view + 8 * unit_roundoff) + (bend + 1.0f) * moved.normal};
}

}  // namespace equilux::fast
