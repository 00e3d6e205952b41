#pragma once
// Pixels are scored in blocks of 64 × 3 values. Sums are taken over eight lanes in blocks and the blocks added pairwise, in an
// order that the number of threads cannot change: the error of a sum over n values is about (32 + log2 n) rounding steps of Σ|x|.
// Loops over lanes are what a compiler turns into SIMD without being allowed to reorder anything.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace equilux {

inline constexpr std::size_t kLanes = 8;
inline constexpr std::size_t kBlockPixels = 64;
inline constexpr std::size_t kBlockValues = 3 * kBlockPixels;
inline constexpr std::size_t kChunkBlocks = 64;  // what a thread takes at a time
inline constexpr std::size_t kChunkPixels = kChunkBlocks * kBlockPixels;
static_assert(kBlockValues % kLanes == 0);

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kLargest = std::numeric_limits<double>::max();

/// Sums and maxima over a block.
struct Reduction {
  double sum = 0, squares = 0, max_abs = 0, max_rel = -1, max_en = 0;
  std::uint64_t zeros = 0;
};

/// A maximum that keeps what it has when the newcomer is NaN.
inline double larger(double one, double other) { return one > other ? one : other; }

/// |E_n| ≤ 1 in the plane exactly where the band agrees: a value just above 1 must not be rounded down to it.
inline float plane_en(double en) {
  const float rounded = static_cast<float>(en);
  const float above_one = std::copysign(0x1.000002p0f, rounded);
  return std::fabs(en) > 1 && std::fabs(rounded) <= 1 ? above_one : rounded;
}

}  // namespace equilux
