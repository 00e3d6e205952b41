// max(0, cos)^p of W angles at once, from the versine v = 1 − cos: p log1p(−v) keeps its digits at the peak of a narrow lobe, where a
// rounded cosine has none.
//
//   log1p(−v)   w = 1 − v = 2^e (1 + f) with 1 + f in [3/4, 3/2); below v = 1/4, e = 0 and f = −v, exact. log(1 + f) = 2 atanh(s),
//               s = f / (2 + f), |s| ≤ 1/5: five terms leave s^11/11 < 2e-9. Relative error < 2^-21.
//   exp(y)      y = n ln 2 + r, |r| ≤ ln 2 / 2, Taylor to r^6: relative error < 2^-22 (and that of y: |y| 2^-21).
// A factor below 2^-125 counts as 0. Error of the lobe, as a share of its peak: |y| e^y 2^-21 + e^y 2^-22 ≤ 2^-21.
#pragma once

#include "lanes.h"

namespace equilux::fast {

template <int W> inline Floats<W> log1p_of_minus(Floats<W> v) {
  const Floats<W> w = 1.0f - v;
  const Ints<W> shifted = bits<W>(w) - 0x3f400000;  // of 3/4
  const Ints<W> exponent = v > 0.25f ? shifted >> 23 : Ints<W>{};
  const Floats<W> mantissa = from_bits<W>((shifted & 0x007fffff) + 0x3f400000);
  const Floats<W> f = v > 0.25f ? mantissa - 1.0f : -v;
  const Floats<W> s = f / (2.0f + f), z = s * s;
  const Floats<W> series = 2.0f * s * (1.0f + z * (1.0f / 3 + z * (1.0f / 5 + z * (1.0f / 7 + z * (1.0f / 9)))));
  return as_floats<W>(exponent) * 0x1.62e43p-1f + series;
}

// y ≤ 0
template <int W> inline Floats<W> exponential(Floats<W> y) {
  const Mask<W> vanishes = !(y > -86.6f);
  const Floats<W> bounded = vanishes ? Floats<W>{} : y;
  const Ints<W> n = truncated<W>(bounded * 0x1.715476p+0f - 0.5f);
  const Floats<W> whole = as_floats<W>(n);
  const Floats<W> r = (bounded - whole * 0x1.62e4p-1f) - whole * 0x1.7f7d1cp-20f;
  const Floats<W> series =
      1.0f + r * (1.0f + r * (0.5f + r * (1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720))))));
  const Floats<W> result = from_bits<W>(bits<W>(series) + (n << 23));
  return vanishes ? Floats<W>{} : result;
}

// max(0, u·v)^p of unit vectors; 0 where u·v ≤ 0, for every p.
template <int W> inline Floats<W> lobe(const Vectors<W>& u, const Vectors<W>& v, Floats<W> p) {
  const Vectors<W> apart = u - v;
  const Floats<W> versine = 0.5f * dot<W>(apart, apart);
  const Mask<W> shines = versine < 1.0f;
  const Floats<W> value = exponential<W>(p * log1p_of_minus<W>(shines ? versine : Floats<W>{}));
  return shines ? value : Floats<W>{};
}

}  // namespace equilux::fast
