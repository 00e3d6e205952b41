#pragma once
// Percentiles of |a − b| over the scored values, exact, without sorting or even storing them all.

#include <array>
#include <cstdint>
#include <vector>

#include "compare.h"

namespace equilux {

/// What is known of the magnitudes after the first pass.
struct Magnitudes {
  std::vector<std::uint64_t> by_bucket;  // kBuckets counts (select.h), zeros among them
  std::uint64_t zeros = 0, scored = 0;
  bool all_scored = true;  // no pixel of the image is left out
};

/// 50, 95, 99: the smallest magnitude that this share of the scored values does not exceed; 0 where nothing was scored. The classes
/// must have been written.
std::array<double, 3> percentiles(const Job& job, const Magnitudes& magnitudes, unsigned threads);

}  // namespace equilux
