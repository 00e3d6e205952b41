// What every shape answers: where a ray crosses it.
//
// A shape is intersected in its canonical frame (unit sphere, cube [-1,1]³, …) by code that is written once and run at two precisions:
//   double        in Embree's callback, to find which object is nearest. Every comparison that rounding could tip is reported as
//                 `uncertain`, every parameter s with a bound of its error.
//   DoubleDouble  to decide what was uncertain, and to find the shaded point of the object that won.
// So a silhouette, an edge or a tie is decided to about 2^-90 of the object's size, and nothing leaks between shapes that share an edge.
#pragma once

#include "../vec3.h"

namespace equilux {

// The ray o + s d in a shape's canonical frame. o_size and d_size are, per component, the sum of the magnitudes that were added up to
// make o and d: the size their rounding errors are relative to.
template <class R>
struct LocalRay {
  Vec3<R> o, d;
  Vec3d o_size, d_size;
};

// Unit of rounding with a margin for the few operations behind every number: a dozen operations in double, some fifty in double-double.
template <class R> constexpr double rounding = 0;
template <> constexpr double rounding<double> = 0x1p-48;
template <> constexpr double rounding<DoubleDouble> = 0x1p-92;

// face: which part of the shape (its numbering is the shape's), doubled, plus 1 where the ray leaves a solid. Only `face / 2` is a
// surface; the last bit tells the two crossings of one surface apart.
template <class R>
struct Crossing {
  R s{};
  double error = 0;  // bound on |error of s|
  int face = 0;
};

// At most two crossings, nearest first.
template <class R>
struct Crossings {
  Crossing<R> at[2];
  int count = 0;
  bool uncertain = false;  // double only: rounding may have tipped a comparison

  void add(R s, double error, int face) { at[count++] = {s, error, face}; }
};

enum class Sign { negative, zero, positive };

// The sign of a number known to ± error.
template <class R> Sign sign_within(R value, double error) {
  const double rounded = to_double(value);
  return rounded > error ? Sign::positive : rounded < -error ? Sign::negative : Sign::zero;
}

// Is value ≥ 0? What lies within the error counts as zero, and is reported as uncertain for double.
template <class R> bool not_negative(R value, double error, Crossings<R>& out) {
  const Sign sign = sign_within(value, error);
  out.uncertain |= sign == Sign::zero;
  return sign != Sign::negative;
}

}  // namespace equilux
