// Double-double arithmetic: a number is the unevaluated sum of two doubles, hi + lo with |lo| ≤ ulp(hi)/2, about 106 bits.
//
// Error-free transforms after Dekker (1971) and Knuth; the algorithms are those of Hida, Li and Bailey, "Library for double-double and
// quad-double arithmetic" (2007). They rely on IEEE rounding to nearest and on the compiler contracting nothing (-ffp-contract=off, no
// fast-math, see the top CMakeLists.txt). Relative error of + − × ÷ √: below 2^-100.
#pragma once

#include <cmath>

#include "lanes.h"

namespace equilux {

// T: double, or Doubles<W> for W numbers at a time, which come out as one by one.
template <class T>
struct Doubled {
  T hi{}, lo{};

  constexpr Doubled() = default;
  constexpr Doubled(T value) : hi(value) {}  // implicit on purpose: every double is exactly a double-double
  constexpr Doubled(T high, T low) : hi(high), lo(low) {}

  friend Doubled operator-(Doubled a) { return {-a.hi, -a.lo}; }

  friend Doubled operator+(Doubled a, Doubled b) {
    Doubled sum = two_sum(a.hi, b.hi);
    const Doubled tail = two_sum(a.lo, b.lo);
    sum = quick_two_sum(sum.hi, sum.lo + tail.hi);
    return quick_two_sum(sum.hi, sum.lo + tail.lo);
  }

  friend Doubled operator-(Doubled a, Doubled b) { return a + (-b); }

  friend Doubled operator*(Doubled a, Doubled b) {
    const Doubled product = two_product(a.hi, b.hi);
    return quick_two_sum(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
  }

  friend Doubled operator*(Doubled a, T b) {
    const Doubled product = two_product(a.hi, b);
    return quick_two_sum(product.hi, product.lo + a.lo * b);
  }

  friend Doubled operator/(Doubled a, Doubled b) {
    const T first = a.hi / b.hi;
    Doubled rest = a - b * first;
    const T second = rest.hi / b.hi;
    rest = rest - b * second;
    const T third = rest.hi / b.hi;
    return quick_two_sum(first, second) + Doubled(third);
  }

  friend bool operator<(Doubled a, Doubled b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }
  friend bool operator>(Doubled a, Doubled b) { return b < a; }

  // --- error-free transforms ---

  // a + b exactly, where |a| ≥ |b|.
  static Doubled quick_two_sum(T a, T b) {
    const T sum = a + b;
    return {sum, b - (sum - a)};
  }

  // a + b exactly.
  static Doubled two_sum(T a, T b) {
    const T sum = a + b;
    const T b_seen = sum - a;
    return {sum, (a - (sum - b_seen)) + (b - b_seen)};
  }

  // a × b exactly (no under- or overflow). Both ways give the same two doubles, so a machine without FMA computes the same image.
  static Doubled two_product(T a, T b) {
    const T product = a * b;
#if defined(EQUILUX_FUSED)
    return {product, fused_difference(a, b, product)};
#else
    constexpr double splitter = 134217729.0;  // 2^27 + 1
    const T a_big = splitter * a, b_big = splitter * b;
    const T a_hi = a_big - (a_big - a), b_hi = b_big - (b_big - b);
    const T a_lo = a - a_hi, b_lo = b - b_hi;
    return {product, ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
#endif
  }
};

using DoubleDouble = Doubled<double>;

inline DoubleDouble quick_two_sum(double a, double b) { return DoubleDouble::quick_two_sum(a, b); }
inline DoubleDouble two_sum(double a, double b) { return DoubleDouble::two_sum(a, b); }
inline DoubleDouble two_difference(double a, double b) { return two_sum(a, -b); }  // a − b exactly
inline DoubleDouble two_product(double a, double b) { return DoubleDouble::two_product(a, b); }

// --- functions that templates use for double and DoubleDouble alike ---

inline double to_double(double value) { return value; }
template <class T> inline T to_double(Doubled<T> value) { return value.hi + value.lo; }

// One Newton step on 1/√a from the double's root (Karp and Markstein).
inline DoubleDouble square_root(DoubleDouble a) {
  if (!(a.hi > 0)) return {0, 0};
  const double reciprocal = 1 / std::sqrt(a.hi);
  const double root = a.hi * reciprocal;
  return two_sum(root, (a - two_product(root, root)).hi * (reciprocal * 0.5));
}

// --- angles ---

struct SineCosine {
  DoubleDouble sine, cosine;
};

// sin and cos of an angle of 0…180 degrees. The angle is divided by 32 and both Taylor series are summed (argument below 0.1, nine
// terms leave 1e-36), then the angle is doubled five times. 0, 90 and 180 degrees come out exact.
inline SineCosine sine_cosine_of_degrees(DoubleDouble degrees) {
  const DoubleDouble pi(3.141592653589793116e+00, 1.224646799147353207e-16);
  if (degrees.hi == 90 && degrees.lo == 0) return {1.0, 0.0};
  if (degrees.hi == 180 && degrees.lo == 0) return {0.0, -1.0};
  const DoubleDouble x = degrees * pi / DoubleDouble(180.0 * 32.0);
  DoubleDouble term = x, sine = x, versine = 0.0;  // versine = 1 − cos: doubling it loses no digits near 0
  for (int n = 2; n <= 20; ++n) {
    term = term * x / DoubleDouble(static_cast<double>(n));
    const int quarter = n % 4;
    if (quarter == 2) versine = versine + term;
    if (quarter == 0) versine = versine - term;
    if (quarter == 3) sine = sine - term;
    if (quarter == 1) sine = sine + term;
  }
  for (int doubling = 0; doubling < 5; ++doubling) {  // sin 2x = 2 sin x cos x; 1 − cos 2x = 2 sin² x
    const DoubleDouble cosine = DoubleDouble(1.0) - versine, twice = sine * 2.0;
    versine = twice * sine;
    sine = twice * cosine;
  }
  return {sine, DoubleDouble(1.0) - versine};
}

}  // namespace equilux
