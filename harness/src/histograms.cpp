#include "histograms.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "block.h"
#include "clones.h"

namespace equilux {
namespace {

/// Which counter each value belongs to: places are what a scalar loop would otherwise have to work out one by one.
EQUILUX_CLONES
void find_places(const double* magnitudes, const double* errors, std::size_t values, const double* upper, std::uint64_t lowest,
                 std::uint64_t highest, std::uint32_t* magnitude_place, std::uint32_t* error_place) {
  for (std::size_t i = 0; i < values; ++i)
    magnitude_place[i] = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(magnitudes[i]) >> kBucketShift);
  const auto first = static_cast<std::int32_t>(lowest), last = static_cast<std::int32_t>(highest);
  std::int32_t bucket[kBlockValues];
  for (std::size_t i = 0; i < values; ++i)
    bucket[i] = static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(std::fabs(errors[i])) >> kBucketShift);
  for (std::size_t i = 0; i < values; ++i) {
    const std::int32_t at_least = bucket[i] < first ? first : bucket[i];
    bucket[i] = (at_least > last ? last : at_least) - first;
  }
  for (std::size_t i = 0; i < values; ++i)
    error_place[i] = static_cast<std::uint32_t>(2 * bucket[i] + (std::fabs(errors[i]) > upper[bucket[i]] ? 1 : 0));
}

}  // namespace

Histograms::Histograms(std::span<const double> edges) : magnitudes_(kBuckets) {
  std::vector<double> upper(edges.begin() + 1, edges.end());
  for (std::size_t i = 0; i + 1 < upper.size(); ++i)
    if (!(upper[i] > 0 && upper[i + 1] >= upper[i] * 1.125))
      throw std::invalid_argument("edges of E_n must ascend by an eighth at least");
  upper.back() = kInfinity;
  if (upper.size() > 1) {
    lowest_ = bucket_of(upper.front());
    highest_ = bucket_of(upper[upper.size() - 2]) + 1;
  }
  std::size_t bin = 0;
  for (std::uint64_t bucket = lowest_; bucket <= highest_; ++bucket) {
    while (std::bit_cast<double>(bucket << kBucketShift) > upper[bin]) ++bin;
    upper_.push_back(upper[bin]);
    bin_.push_back(bin);
  }
  errors_.resize(2 * upper_.size());
}

void Histograms::count(const double* magnitudes, const double* errors, std::size_t values) {
  std::uint32_t magnitude_place[kBlockValues], error_place[kBlockValues];
  find_places(magnitudes, errors, values, upper_.data(), lowest_, highest_, magnitude_place, error_place);
  Turns<std::uint32_t>* const by_magnitude = magnitudes_.data();
  Turns<std::uint32_t>* const by_error = errors_.data();
  for (std::size_t i = 0; i < values; ++i) {
    ++by_magnitude[magnitude_place[i]][i % kTurns];
    ++by_error[error_place[i]][i % kTurns];
  }
}

std::vector<std::uint64_t> Histograms::errors() const {
  std::vector<std::uint64_t> out(bin_.back() + 1);
  for (std::size_t bucket = 0; bucket < bin_.size(); ++bucket) {
    out[bin_[bucket]] += total(errors_[2 * bucket]);
    if (bin_[bucket] + 1 < out.size()) out[bin_[bucket] + 1] += total(errors_[2 * bucket + 1]);
  }
  return out;
}

}  // namespace equilux
