#pragma once
// Order statistics of non-negative doubles without sorting or even storing them all: their bit patterns are ordered like the
// numbers, so a histogram over the leading 16 bits, taken in passing, tells which few values can be the ones wanted.

#include <bit>
#include <cstddef>
#include <cstdint>

namespace equilux {

inline constexpr unsigned kBucketShift = 48;
inline constexpr std::size_t kBuckets = 1u << 15;  // the sign bit of a magnitude is 0

inline std::size_t bucket_of(double magnitude) { return std::bit_cast<std::uint64_t>(magnitude) >> kBucketShift; }

/// 0-based rank of the smallest value that `percent` % of `count` values do not exceed (the inverted distribution function).
inline std::uint64_t rank_of_percentile(std::uint64_t count, unsigned percent) { return (count * percent + 99) / 100 - 1; }

}  // namespace equilux
