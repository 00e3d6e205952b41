#pragma once
// From two radiance images with bounds to classes, normalised error and statistics, in one pass (and a second, light one for the
// percentiles). Blocks with nothing remarkable in them take the quick way (plain_block.h), the others the careful one. All
// arithmetic is double; nothing is clamped, normalised or zeroed before it is scored.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace equilux {

enum class PixelClass : std::uint8_t { agree = 0, diverge = 1, edge = 2, invalid = 3 };

/// Whether a pixel of this class counts in the statistics.
inline bool is_scored(std::uint8_t kind) {
  return kind == static_cast<std::uint8_t>(PixelClass::agree) || kind == static_cast<std::uint8_t>(PixelClass::diverge);
}

/// One render: its image, and the bound |error| ≤ abs + rel |L| + per_pixel, plus a standard deviation. Null pointers are zeros.
struct Side {
  const void* image = nullptr;  // pixels × 3, float or double
  bool is_double = false;
  double abs = 0, rel = 0;
  const float* per_pixel = nullptr;  // pixels × 3
  const float* sigma = nullptr;      // pixels × 3
};

struct Job {
  Side a, b;
  std::size_t pixels = 0;
  double coverage_factor = 0;            // k
  const std::uint8_t* edge = nullptr;    // per pixel: non-zero excuses a divergence
  std::span<const double> en_edges;      // ascending; bin i counts en_edges[i] < |E_n| ≤ en_edges[i + 1], the first from 0, the last to ∞
  unsigned threads = 0;                  // 0: as many as the machine has
  float* difference = nullptr;           // out, pixels × 3, or null
  float* normalised_error = nullptr;     // out, pixels × 3, or null
  std::uint8_t* classes = nullptr;       // out, per pixel
};

/// Pixels of one side that hold at least one such value. A pixel may count under several kinds.
struct InvalidKinds {
  std::uint64_t nan = 0, plus_inf = 0, minus_inf = 0, negative = 0;
};

/// Statistics are over the bands of the pixels that are neither edge nor invalid (`scored_values` of them).
struct Result {
  std::array<std::uint64_t, 4> counts{};  // by PixelClass
  InvalidKinds invalid_a, invalid_b;
  std::uint64_t scored_values = 0;
  double max_abs = 0;
  double max_rel = -1;                    // −1: no |b| exceeds its own uncertainty
  double sum = 0, sum_of_squares = 0;     // of a − b
  std::array<double, 3> percentiles{};    // 50, 95, 99: the smallest |a − b| that this share of the values does not exceed
  double edge_max_abs = 0;
  double en_max = 0;
  std::uint64_t en_infinite = 0;          // bands without uncertainty that differ all the same
  std::int64_t worst_pixel = -1;          // largest |E_n|, the first of equals
  std::int64_t farthest_pixel = -1;       // largest |a − b|, the first of equals
  std::int64_t first_invalid = -1;
  std::vector<std::uint64_t> en_counts;
};

/// Throws std::domain_error when a bound is negative, NaN or infinite where both radiances are finite.
Result compare(const Job& job);

}  // namespace equilux
