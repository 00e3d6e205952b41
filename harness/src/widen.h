#pragma once
// Radiances of one side as doubles, whatever they are stored as.

#include <cstddef>

#include "compare.h"

namespace equilux {

template <class Number>
[[gnu::always_inline]] inline void widen_from(const void* image, std::size_t first, std::size_t count, double* out) {
  const Number* in = static_cast<const Number*>(image) + first;
  for (std::size_t i = 0; i < count; ++i) out[i] = in[i];
}

/// The `count` values from `first` on. Inlined always, so that it is compiled for the SIMD of its caller (clones.h).
[[gnu::always_inline]] inline void widen(const Side& side, std::size_t first, std::size_t count, double* out) {
  if (side.is_double) widen_from<double>(side.image, first, count, out);
  else widen_from<float>(side.image, first, count, out);
}

}  // namespace equilux
