#pragma once
// Order statistics of non-negative doubles without sorting or even storing them all: their bit patterns are ordered like the
// numbers, so a histogram over the leading 16 bits, taken in passing, tells which few values can be the ones wanted.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace equilux {

inline constexpr std::size_t kBuckets = 1u << 15;  // the sign bit of a magnitude is 0

inline std::size_t bucket_of(double magnitude) { return std::bit_cast<std::uint64_t>(magnitude) >> 48; }

/// Where the value of 0-based rank `rank` lies: its bucket, and its rank within that bucket.
struct Place {
  std::size_t bucket;
  std::uint64_t rank;
};

inline Place place_of_rank(const std::vector<std::uint32_t>& histogram, std::uint64_t rank) {
  for (std::size_t bucket = 0; bucket < histogram.size(); ++bucket) {
    if (rank < histogram[bucket]) return {bucket, rank};
    rank -= histogram[bucket];
  }
  return {histogram.size(), 0};
}

/// 0-based rank of the smallest value that `percent` % of `count` values do not exceed (the inverted distribution function).
inline std::uint64_t rank_of_percentile(std::uint64_t count, unsigned percent) { return (count * percent + 99) / 100 - 1; }

/// The value of 0-based rank `rank`. Many values are first narrowed down 16 bits at a time: equal ones come by the million.
inline double value_of_rank(std::vector<double>& values, std::uint64_t rank) {
  constexpr std::size_t kFew = 1u << 16;
  for (int shift = 32; shift >= 0 && values.size() > kFew; shift -= 16) {
    const auto digit = [shift](double value) { return (std::bit_cast<std::uint64_t>(value) >> shift) & 0xffff; };
    std::vector<std::uint32_t> histogram(1u << 16);
    for (const double value : values) ++histogram[digit(value)];
    const Place place = place_of_rank(histogram, rank);
    if (histogram[place.bucket] < values.size()) std::erase_if(values, [&](double value) { return digit(value) != place.bucket; });
    rank = place.rank;
  }
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace equilux
