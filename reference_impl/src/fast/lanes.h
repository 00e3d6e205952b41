// W floats or integers at a time, in the compiler's vector types: they have operators, comparisons give masks (−1 or 0 per lane) and
// `mask ? a : b` chooses by lane. Only what has no operator stands here.
//
// Everything is a template over W, and each W is compiled in a file of its own with its own instruction set: no code that needs AVX-512
// can be shared by the linker with a caller that has none.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace equilux::fast {

template <int W> struct Lanes {
  typedef float Floats __attribute__((vector_size(4 * W)));
  typedef std::int32_t Ints __attribute__((vector_size(4 * W)));
};
template <int W> using Floats = typename Lanes<W>::Floats;
template <int W> using Ints = typename Lanes<W>::Ints;
template <int W> using Mask = Ints<W>;

template <int W> inline Floats<W> all_of(float value) { return value - Floats<W>{}; }
template <int W> inline Ints<W> all_of(std::int32_t value) { return value - Ints<W>{}; }

template <int W> inline Ints<W> bits(Floats<W> value) { return reinterpret_cast<Ints<W>>(value); }
template <int W> inline Floats<W> from_bits(Ints<W> value) { return reinterpret_cast<Floats<W>>(value); }
template <int W> inline Floats<W> as_floats(Ints<W> value) { return __builtin_convertvector(value, Floats<W>); }
template <int W> inline Ints<W> truncated(Floats<W> value) { return __builtin_convertvector(value, Ints<W>); }

template <int W> inline Floats<W> larger(Floats<W> a, Floats<W> b) { return a > b ? a : b; }
template <int W> inline Floats<W> smaller(Floats<W> a, Floats<W> b) { return a < b ? a : b; }
template <int W> inline Floats<W> magnitude(Floats<W> a) { return from_bits<W>(bits<W>(a) & 0x7fffffff); }

// One bit per lane.
template <int W> inline unsigned packed(Mask<W> mask) {
#if defined(__AVX512F__)
  if constexpr (W == 16) return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask);
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#endif
#if defined(__SSE2__)
  if constexpr (W == 4) return static_cast<unsigned>(_mm_movemask_ps((__m128)mask));
#endif
  unsigned result = 0;
  for (int i = 0; i < W; ++i) result |= (mask[i] != 0 ? 1u : 0u) << i;
  return result;
}
template <int W> inline bool any(Mask<W> mask) { return packed<W>(mask) != 0; }
template <int W> inline Mask<W> unpacked(unsigned mask) {
  Ints<W> bit;
  for (int i = 0; i < W; ++i) bit[i] = 1 << i;
  return (bit & static_cast<std::int32_t>(mask)) != 0;
}
[[gnu::always_inline]] inline int first_of(unsigned mask) { return __builtin_ctz(mask); }

template <int W> inline Floats<W> root(Floats<W> a) {
#if defined(__AVX512F__)
  if constexpr (W == 16) return _mm512_sqrt_ps(a);
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return _mm256_sqrt_ps(a);
#endif
#if defined(__SSE2__)
  if constexpr (W == 4) return _mm_sqrt_ps(a);
#endif
  Floats<W> result;
  for (int i = 0; i < W; ++i) result[i] = __builtin_sqrtf(a[i]);
  return result;
}

// 1/√a to 3 units of the last place; infinite at 0.
template <int W> inline Floats<W> reciprocal_root(Floats<W> a) {
#if defined(__AVX512F__)
  if constexpr (W == 16) {
    const Floats<W> y = _mm512_rsqrt14_ps(a), better = y * (1.5f - 0.5f * a * y * y);
    return a > 0 ? better : y;
  }
#endif
  return 1.0f / root<W>(a);
}

// table[index], for lanes whose index is a place in the table; all must be.
template <int W> inline Floats<W> gathered(const float* table, Ints<W> index) {
#if defined(__AVX512F__)
  if constexpr (W == 16) return _mm512_i32gather_ps((__m512i)index, table, 4);
#endif
#if defined(__AVX2__)
  if constexpr (W == 8) return _mm256_i32gather_ps(table, (__m256i)index, 4);
#endif
  Floats<W> result;
  for (int i = 0; i < W; ++i) result[i] = table[index[i]];
  return result;
}
template <int W> inline Ints<W> gathered(const std::int32_t* table, Ints<W> index) {
#if defined(__AVX512F__)
  if constexpr (W == 16) return (Ints<W>)_mm512_i32gather_epi32((__m512i)index, table, 4);
#endif
#if defined(__AVX2__)
  if constexpr (W == 8) return (Ints<W>)_mm256_i32gather_epi32(table, (__m256i)index, 4);
#endif
  Ints<W> result;
  for (int i = 0; i < W; ++i) result[i] = table[index[i]];
  return result;
}

template <int W> inline Floats<W> loaded(const float* from) {
  Floats<W> result;
  __builtin_memcpy(&result, from, sizeof(result));
  return result;
}
template <int W> inline void store(float* to, Floats<W> value) { __builtin_memcpy(to, &value, sizeof(value)); }

// W vectors of three.
template <int W> struct Vectors {
  Floats<W> x, y, z;
};
template <int W> inline Vectors<W> operator+(const Vectors<W>& a, const Vectors<W>& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <int W> inline Vectors<W> operator-(const Vectors<W>& a, const Vectors<W>& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <int W> inline Vectors<W> times(const Vectors<W>& a, Floats<W> s) { return {a.x * s, a.y * s, a.z * s}; }
template <int W> inline Floats<W> dot(const Vectors<W>& a, const Vectors<W>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <int W> inline Vectors<W> chosen(Mask<W> mask, const Vectors<W>& a, const Vectors<W>& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}
template <int W> inline Vectors<W> everywhere(const float* v) { return {all_of<W>(v[0]), all_of<W>(v[1]), all_of<W>(v[2])}; }
template <int W> inline Vectors<W> made_unit(const Vectors<W>& a) { return times<W>(a, reciprocal_root<W>(dot<W>(a, a))); }

}  // namespace equilux::fast
