// Double-double arithmetic: a number is the unevaluated sum of two doubles, hi + lo with |lo| ≤ ulp(hi)/2, about 106 bits.
//
// Error-free transforms after Dekker (1971) and Knuth; the algorithms are those of Hida, Li and Bailey, "Library for double-double and
// quad-double arithmetic" (2007). They rely on IEEE rounding to nearest and on the compiler contracting nothing (-ffp-contract=off, no
// fast-math, see the top CMakeLists.txt). Relative error of + − × ÷ √: below 2^-100.
#pragma once

#include <cmath>

namespace equilux {

struct DoubleDouble {
  double hi = 0, lo = 0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double value) : hi(value) {}  // implicit on purpose: every double is exactly a double-double
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}
};

// --- error-free transforms ---

// a + b exactly, where |a| ≥ |b|.
inline DoubleDouble quick_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

// a + b exactly.
inline DoubleDouble two_sum(double a, double b) {
  const double sum = a + b;
  const double b_seen = sum - a;
  return {sum, (a - (sum - b_seen)) + (b - b_seen)};
}

// a − b exactly.
inline DoubleDouble two_difference(double a, double b) { return two_sum(a, -b); }

// a × b exactly (no under- or overflow). Both ways give the same two doubles, so a machine without FMA computes the same image.
inline DoubleDouble two_product(double a, double b) {
  const double product = a * b;
#if defined(__FMA__) || defined(__aarch64__)
  return {product, __builtin_fma(a, b, -product)};
#else
  constexpr double splitter = 134217729.0;  // 2^27 + 1
  const double a_big = splitter * a, b_big = splitter * b;
  const double a_hi = a_big - (a_big - a), b_hi = b_big - (b_big - b);
  const double a_lo = a - a_hi, b_lo = b - b_hi;
  return {product, ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
#endif
}

// --- arithmetic ---

inline DoubleDouble operator-(DoubleDouble a) { return {-a.hi, -a.lo}; }

inline DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
  DoubleDouble sum = two_sum(a.hi, b.hi);
  const DoubleDouble tail = two_sum(a.lo, b.lo);
  sum = quick_two_sum(sum.hi, sum.lo + tail.hi);
  return quick_two_sum(sum.hi, sum.lo + tail.lo);
}

inline DoubleDouble operator-(DoubleDouble a, DoubleDouble b) { return a + (-b); }

inline DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
  DoubleDouble product = two_product(a.hi, b.hi);
  return quick_two_sum(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
}

inline DoubleDouble operator*(DoubleDouble a, double b) {
  DoubleDouble product = two_product(a.hi, b);
  return quick_two_sum(product.hi, product.lo + a.lo * b);
}

inline DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
  const double first = a.hi / b.hi;
  DoubleDouble rest = a - b * first;
  const double second = rest.hi / b.hi;
  rest = rest - b * second;
  const double third = rest.hi / b.hi;
  return quick_two_sum(first, second) + DoubleDouble(third);
}

inline bool operator<(DoubleDouble a, DoubleDouble b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }
inline bool operator>(DoubleDouble a, DoubleDouble b) { return b < a; }

// --- functions that templates use for double and DoubleDouble alike ---

inline double to_double(double value) { return value; }
inline double to_double(DoubleDouble value) { return value.hi + value.lo; }

inline double square_root(double value) { return std::sqrt(value); }

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
