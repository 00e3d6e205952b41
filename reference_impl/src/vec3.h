// Vectors and matrices of three, over any number type that has + − × ÷ and square_root (double, DoubleDouble; float later).
#pragma once

#include "double_double.h"

namespace equilux {

template <class R>
struct Vec3 {
  R x{}, y{}, z{};
};

using Vec3d = Vec3<double>;
using Vec3dd = Vec3<DoubleDouble>;

template <class R> Vec3<R> operator+(const Vec3<R>& a, const Vec3<R>& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class R> Vec3<R> operator-(const Vec3<R>& a, const Vec3<R>& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class R> Vec3<R> operator-(const Vec3<R>& a) { return {-a.x, -a.y, -a.z}; }
template <class R> Vec3<R> operator*(const Vec3<R>& a, R s) { return {a.x * s, a.y * s, a.z * s}; }
template <class R> R dot(const Vec3<R>& a, const Vec3<R>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <class R> Vec3<R> cross(const Vec3<R>& a, const Vec3<R>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class R> R length(const Vec3<R>& a) { return square_root(dot(a, a)); }
template <class R> Vec3<R> unit(const Vec3<R>& a) { return a * (R(1.0) / length(a)); }

inline Vec3dd exactly(const Vec3d& a) { return {a.x, a.y, a.z}; }
inline Vec3d to_double(const Vec3d& a) { return a; }
inline Vec3d to_double(const Vec3dd& a) { return {to_double(a.x), to_double(a.y), to_double(a.z)}; }
inline Vec3dd difference(const Vec3d& a, const Vec3d& b) {
  return {two_difference(a.x, b.x), two_difference(a.y, b.y), two_difference(a.z, b.z)};
}
inline Vec3d magnitudes(const Vec3d& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }
inline double largest(const Vec3d& a) { return std::fmax(std::fabs(a.x), std::fmax(std::fabs(a.y), std::fabs(a.z))); }

// v × 2^k with components near 1, exactly: directions may be given with any length, 1e-300 or 1e300.
inline Vec3dd scaled_to_one(const Vec3dd& v) {
  const double size = largest({v.x.hi, v.y.hi, v.z.hi});
  const int k = size > 0 && std::isfinite(size) ? -std::ilogb(size) : 0;
  const auto scaled = [k](DoubleDouble a) { return DoubleDouble(std::ldexp(a.hi, k), std::ldexp(a.lo, k)); };
  return {scaled(v.x), scaled(v.y), scaled(v.z)};
}
inline Vec3dd direction_of(const Vec3dd& v) { return unit(scaled_to_one(v)); }
inline Vec3dd direction_of(const Vec3d& v) { return direction_of(exactly(v)); }

// Two unit vectors that make a right-handed orthonormal frame (u, v, n) with the unit vector n.
template <class R> void complete_frame(const Vec3<R>& n, Vec3<R>& u, Vec3<R>& v) {
  const Vec3d size = magnitudes(to_double(n));
  Vec3<R> axis;
  (size.x <= size.y && size.x <= size.z ? axis.x : size.y <= size.z ? axis.y : axis.z) = R(1.0);
  u = unit(cross(axis, n));
  v = cross(n, u);
}

// Three columns: the images of the unit vectors.
template <class R>
struct Matrix3 {
  Vec3<R> column[3];
};

template <class R> Vec3<R> operator*(const Matrix3<R>& m, const Vec3<R>& v) {
  return m.column[0] * v.x + m.column[1] * v.y + m.column[2] * v.z;
}
template <class R> Matrix3<R> operator*(const Matrix3<R>& a, const Matrix3<R>& b) {
  return {{a * b.column[0], a * b.column[1], a * b.column[2]}};
}
template <class R> Vec3<R> transposed_times(const Matrix3<R>& m, const Vec3<R>& v) {
  return {dot(m.column[0], v), dot(m.column[1], v), dot(m.column[2], v)};
}
template <class R> R determinant(const Matrix3<R>& m) { return dot(m.column[0], cross(m.column[1], m.column[2])); }

// Cramer's rule; the caller has looked at the determinant.
template <class R> Matrix3<R> inverse(const Matrix3<R>& m) {
  const R scale = R(1.0) / determinant(m);
  const Vec3<R> row0 = cross(m.column[1], m.column[2]) * scale, row1 = cross(m.column[2], m.column[0]) * scale,
                row2 = cross(m.column[0], m.column[1]) * scale;
  return {{{row0.x, row1.x, row2.x}, {row0.y, row1.y, row2.y}, {row0.z, row1.z, row2.z}}};
}

}  // namespace equilux
