// What W lanes need beyond operators: masks, tables, and the double-double functions of vec3.h.
#pragma once

#include "../embree_shim.h"
#include "../vec3.h"

namespace equilux::packets {

template <int W> using Exactly = Doubled<Doubles<W>>;
template <int W> using Point = Vec3<Doubles<W>>;
template <int W> using ExactPoint = Vec3<Exactly<W>>;

template <int W> inline Doubles<W> all(double value) { return in_all_lanes<Doubles<W>>(value); }
template <int W> inline Longs<W> all_longs(std::int64_t value) { return value - Longs<W>{}; }
template <int W> inline Exactly<W> all(const DoubleDouble& value) { return {all<W>(value.hi), all<W>(value.lo)}; }
template <int W> inline Point<W> all(const Vec3d& v) { return {all<W>(v.x), all<W>(v.y), all<W>(v.z)}; }
template <int W> inline ExactPoint<W> all(const Vec3dd& v) { return {all<W>(v.x), all<W>(v.y), all<W>(v.z)}; }

template <int W> inline Longs<W> bits(Doubles<W> value) { return reinterpret_cast<Longs<W>>(value); }
template <int W> inline Doubles<W> from_bits(Longs<W> value) { return reinterpret_cast<Doubles<W>>(value); }
template <int W> inline Doubles<W> magnitude(Doubles<W> a) { return from_bits<W>(bits<W>(a) & 0x7fffffffffffffff); }
template <int W> inline Doubles<W> larger(Doubles<W> a, Doubles<W> b) { return a > b ? a : b; }
template <int W> inline Doubles<W> smaller(Doubles<W> a, Doubles<W> b) { return a < b ? a : b; }
template <int W> inline Point<W> magnitudes(const Point<W>& v) { return {magnitude<W>(v.x), magnitude<W>(v.y), magnitude<W>(v.z)}; }
template <int W> inline Doubles<W> largest(const Point<W>& v) {
  return larger<W>(magnitude<W>(v.x), larger<W>(magnitude<W>(v.y), magnitude<W>(v.z)));
}
template <int W> inline Point<W> rounded(const ExactPoint<W>& v) { return {to_double(v.x), to_double(v.y), to_double(v.z)}; }
template <int W> inline Point<W> chosen(Longs<W> mask, const Point<W>& a, const Point<W>& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}
template <int W> inline Exactly<W> chosen(Longs<W> mask, const Exactly<W>& a, const Exactly<W>& b) {
  return {mask ? a.hi : b.hi, mask ? a.lo : b.lo};
}
template <int W> inline ExactPoint<W> chosen(Longs<W> mask, const ExactPoint<W>& a, const ExactPoint<W>& b) {
  return {chosen<W>(mask, a.x, b.x), chosen<W>(mask, a.y, b.y), chosen<W>(mask, a.z, b.z)};
}

// --- masks ------------------------------------------------------------------------------------------------------------

// One bit per lane.
template <int W> inline unsigned packed(Longs<W> mask) {
#if defined(__AVX512DQ__)
  if constexpr (W == 8) return _mm512_movepi64_mask((__m512i)mask);
#endif
#if defined(__AVX__)
  if constexpr (W == 4) return static_cast<unsigned>(_mm256_movemask_pd((__m256d)mask));
#endif
#if defined(__SSE2__)
  if constexpr (W == 2) return static_cast<unsigned>(_mm_movemask_pd((__m128d)mask));
#endif
  unsigned result = 0;
  for (int i = 0; i < W; ++i) result |= (mask[i] != 0 ? 1u : 0u) << i;
  return result;
}
template <int W> inline bool any(Longs<W> mask) { return packed<W>(mask) != 0; }
template <int W> inline Longs<W> unpacked(unsigned lanes) {
  Longs<W> bit;
  for (int i = 0; i < W; ++i) bit[i] = std::int64_t{1} << i;
  return (bit & static_cast<std::int64_t>(lanes)) != 0;
}

// Embree's masks and floats, of which there are as many as lanes.
template <int W> struct Narrow {
  typedef std::int32_t Ints __attribute__((vector_size(4 * W), aligned(4)));
  typedef float Floats __attribute__((vector_size(4 * W), aligned(4)));
};
template <int W> inline Longs<W> mask_from(const int* valid) {
  return __builtin_convertvector(*reinterpret_cast<const typename Narrow<W>::Ints*>(valid), Longs<W>);
}
template <int W> inline void store(int* valid, Longs<W> mask) {
  *reinterpret_cast<typename Narrow<W>::Ints*>(valid) = __builtin_convertvector(mask, typename Narrow<W>::Ints);
}
template <int W> inline void store(float* to, Doubles<W> value) {
  *reinterpret_cast<typename Narrow<W>::Floats*>(to) = __builtin_convertvector(value, typename Narrow<W>::Floats);
}
template <int W> inline Doubles<W> load(const float* from) {
  return __builtin_convertvector(*reinterpret_cast<const typename Narrow<W>::Floats*>(from), Doubles<W>);
}

// --- tables -----------------------------------------------------------------------------------------------------------

// table[place]; every lane's place must be one of the table's.
template <int W> inline Doubles<W> gathered(const double* table, Longs<W> place) {
#if defined(__AVX512F__)
  if constexpr (W == 8) return (Doubles<W>)_mm512_i64gather_pd((__m512i)place, table, 8);
#endif
#if defined(__AVX2__)
  if constexpr (W == 4) return (Doubles<W>)_mm256_i64gather_pd(table, (__m256i)place, 8);
#endif
  Doubles<W> result;
  for (int i = 0; i < W; ++i) result[i] = table[place[i]];
  return result;
}
template <int W> inline Point<W> gathered_point(const double* table, Longs<W> place) {
  return {gathered<W>(table, place), gathered<W>(table + 1, place), gathered<W>(table + 2, place)};
}
template <int W> inline Exactly<W> gathered_exactly(const double* table, Longs<W> place) {
  return {gathered<W>(table, place), gathered<W>(table + 1, place)};
}
template <int W> inline ExactPoint<W> gathered_exact_point(const double* table, Longs<W> place) {
  return {gathered_exactly<W>(table, place), gathered_exactly<W>(table + 2, place), gathered_exactly<W>(table + 4, place)};
}

// --- double-double ----------------------------------------------------------------------------------------------------

// Of numbers above 0.
template <int W> inline Exactly<W> root(const Exactly<W>& a) {
  const Doubles<W> reciprocal = 1.0 / square_root(a.hi);
  const Doubles<W> near = a.hi * reciprocal;
  return Exactly<W>::two_sum(near, (a - Exactly<W>::two_product(near, near)).hi * (reciprocal * 0.5));
}
template <int W> inline Exactly<W> length_of(const ExactPoint<W>& v) { return root<W>(dot(v, v)); }
template <int W> inline Exactly<W> one() { return all<W>(DoubleDouble(1.0)); }

// v made unit. `failed` gains the lanes whose components are too near the ends of a double's range, or all 0.
template <int W> inline ExactPoint<W> direction_of(const ExactPoint<W>& v, Longs<W>& failed) {
  const Doubles<W> size = largest<W>({v.x.hi, v.y.hi, v.z.hi});
  failed |= ~((size > 1e-200) & (size < 1e200));
  const Longs<W> exponent = bits<W>(size) >> 52;
  const Doubles<W> scale = from_bits<W>((2046 - exponent) << 52);  // 2^−ilogb(size)
  const auto scaled = [&](const Exactly<W>& a) { return Exactly<W>(a.hi * scale, a.lo * scale); };
  const ExactPoint<W> near_one{scaled(v.x), scaled(v.y), scaled(v.z)};
  return near_one * (one<W>() / length_of<W>(near_one));
}

template <int W> inline ExactPoint<W> times(const Matrix3<DoubleDouble>& m, const ExactPoint<W>& v) {
  return all<W>(m.column[0]) * v.x + all<W>(m.column[1]) * v.y + all<W>(m.column[2]) * v.z;
}

}  // namespace equilux::packets
