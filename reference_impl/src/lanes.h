// W doubles at a time, in the compiler's vector types: they have operators, comparisons give masks (−1 or 0 per lane) and
// `mask ? a : b` chooses by lane. Only what has no operator stands here, for one double as well, so that a formula is written once.
//
// Files that are compiled for an instruction set of their own use W to tell what they make from what the others make: no code that
// needs AVX-512 may be shared by the linker with a caller that has none.
#pragma once

#include <cmath>
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace equilux {

template <int W> struct LanesOf {
  typedef double Doubles __attribute__((vector_size(8 * W)));
  typedef std::int64_t Longs __attribute__((vector_size(8 * W)));
};
template <int W> using Doubles = typename LanesOf<W>::Doubles;
template <int W> using Longs = typename LanesOf<W>::Longs;  // masks, and places in tables

// a × b − c, rounded once; only where the machine has it.
#if defined(__FMA__) || defined(__aarch64__)
#define EQUILUX_FUSED 1
inline double fused_difference(double a, double b, double c) { return __builtin_fma(a, b, -c); }
#endif
#if defined(__FMA__)
inline Doubles<2> fused_difference(Doubles<2> a, Doubles<2> b, Doubles<2> c) { return (Doubles<2>)_mm_fmsub_pd(a, b, c); }
inline Doubles<4> fused_difference(Doubles<4> a, Doubles<4> b, Doubles<4> c) { return (Doubles<4>)_mm256_fmsub_pd(a, b, c); }
#if defined(__AVX512F__)
inline Doubles<8> fused_difference(Doubles<8> a, Doubles<8> b, Doubles<8> c) { return (Doubles<8>)_mm512_fmsub_pd(a, b, c); }
#endif
#elif defined(__aarch64__)
inline Doubles<2> fused_difference(Doubles<2> a, Doubles<2> b, Doubles<2> c) {
  return {__builtin_fma(a[0], b[0], -c[0]), __builtin_fma(a[1], b[1], -c[1])};
}
#endif

inline double square_root(double value) { return std::sqrt(value); }
#if defined(__SSE2__)
inline Doubles<2> square_root(Doubles<2> a) { return (Doubles<2>)_mm_sqrt_pd(a); }
#else
inline Doubles<2> square_root(Doubles<2> a) { return {std::sqrt(a[0]), std::sqrt(a[1])}; }
#endif
#if defined(__AVX__)
inline Doubles<4> square_root(Doubles<4> a) { return (Doubles<4>)_mm256_sqrt_pd(a); }
#endif
#if defined(__AVX512F__)
inline Doubles<8> square_root(Doubles<8> a) { return (Doubles<8>)_mm512_sqrt_pd(a); }
#endif

// The same number in every lane. Adding it to zeros would turn −0 into 0.
template <class T> inline T in_all_lanes(double value) {
  if constexpr (sizeof(T) == sizeof(double)) {
    return value;
  } else {
    T result;
    for (std::size_t i = 0; i < sizeof(T) / sizeof(double); ++i) result[i] = value;
    return result;
  }
}

}  // namespace equilux
