#pragma once
// Histograms of |a − b| (by its leading bits, for the percentiles) and of |E_n| (by the bins that are reported).

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "select.h"

namespace equilux {

/// Counters of one thread. Neighbours mostly fall into the same place, and a counter that is written again at once waits for
/// itself: so there are four of each, side by side, taken in turns.
class Histograms {
 public:
  /// edges of |E_n|: ascending by an eighth at least, the first 0; the last bin reaches to ∞. Throws std::invalid_argument.
  explicit Histograms(std::span<const double> edges);

  /// At most kBlockValues values; `errors` of either sign.
  void count(const double* magnitudes, const double* errors, std::size_t values);

  /// How many |a − b| are in a bucket, so far.
  std::uint64_t magnitudes(std::size_t bucket) const { return total(magnitudes_[bucket]); }
  /// How many |E_n| are in each bin, so far.
  std::vector<std::uint64_t> errors() const;

 private:
  static constexpr std::size_t kTurns = 4;
  template <class Counter>
  using Turns = std::array<Counter, kTurns>;
  template <class Counter>
  static std::uint64_t total(const Turns<Counter>& turns) {
    return std::accumulate(turns.begin(), turns.end(), std::uint64_t{0});
  }

  /// Edges lie so far apart that the numbers of one bucket belong to one bin or two: those up to `upper_` and those beyond. The
  /// buckets kept are those that the edges span: all below the first is bin 0, all beyond the last is the last bin.
  std::uint64_t lowest_ = 0, highest_ = 0;
  std::vector<double> upper_;
  std::vector<std::size_t> bin_;  // of the numbers up to `upper_`
  std::vector<Turns<std::uint32_t>> magnitudes_;
  std::vector<Turns<std::uint32_t>> errors_;  // two places per bucket: up to `upper_`, and beyond
};

}  // namespace equilux
