#include "percentiles.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "block.h"
#include "clones.h"
#include "parallel.h"
#include "select.h"
#include "widen.h"

namespace equilux {
namespace {

constexpr std::uint64_t kAlwaysGathered = 4096;

/// Where one percentile lies: among the values whose bits above `shift` are `prefix`, of which there are `count`, at 0-based `rank`.
struct Place {
  std::uint64_t prefix, rank, count;
  unsigned shift = kBucketShift;
  std::uint64_t lowest() const { return prefix << shift; }
  std::uint64_t highest() const { return lowest() + ((std::uint64_t{1} << shift) - 1); }
  bool operator==(const Place& other) const { return prefix == other.prefix && shift == other.shift; }
};

/// Of the values counted in `histogram`, the one of 0-based rank `rank`: which counter, and its rank there.
template <class Counts>
Place place_of_rank(const Counts& histogram, std::uint64_t rank) {
  for (std::size_t place = 0; place < histogram.size(); ++place) {
    if (rank < histogram[place]) return {place, rank, histogram[place]};
    rank -= histogram[place];
  }
  return {histogram.size(), 0, 0};
}

/// Magnitudes of the `count` values from `first` on; and for each of them whether it is not zero and within one of three ranges of
/// numbers (bounds included; a bound that is NaN bounds nothing).
EQUILUX_CLONES
void find_within(const Job& job, std::size_t first, std::size_t count, const double* low, const double* high, double* magnitude,
                 std::uint64_t* within) {
  double a[kBlockValues], b[kBlockValues];
  widen(job.a, first, count, a);
  widen(job.b, first, count, b);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = std::fabs(a[i] - b[i]);
    magnitude[i] = value;
    const bool any = (!(value < low[0]) & !(value > high[0])) | (!(value < low[1]) & !(value > high[1])) |
                     (!(value < low[2]) & !(value > high[2]));
    within[i] = (value != 0) & any ? 1 : 0;
  }
}

/// Calls found(thread, values, how many) for the scored non-zero values in the wanted places, a block at a time, on all threads.
template <class Found>
void for_values_in(const Job& job, std::span<const Place> places, bool all_scored, unsigned threads, Found&& found) {
  double low[3], high[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const Place& place = places[std::min(i, places.size() - 1)];
    low[i] = std::bit_cast<double>(place.lowest());
    high[i] = std::bit_cast<double>(place.highest());
  }
  parallel_chunks((job.pixels + kChunkPixels - 1) / kChunkPixels, threads, [&](std::size_t chunk, unsigned thread) {
    double magnitude[kBlockValues], kept[kBlockValues];
    std::uint64_t within[kBlockValues];
    const std::size_t end = std::min(job.pixels, (chunk + 1) * kChunkPixels);
    for (std::size_t first = chunk * kChunkPixels; first < end; first += kBlockPixels) {
      const std::size_t values = 3 * std::min(kBlockPixels, end - first);
      find_within(job, 3 * first, values, low, high, magnitude, within);
      if (!all_scored)
        for (std::size_t i = 0; i < values; ++i) within[i] &= is_scored(job.classes[first + i / 3]) ? 1u : 0u;
      std::size_t count = 0;
      for (std::size_t i = 0; i < values; ++i) {
        kept[count] = magnitude[i];
        count += within[i];
      }
      if (count > 0) found(thread, kept, count);
    }
  });
}

/// The same percentile known by sixteen more bits.
Place refined(const Job& job, const Place& place, bool all_scored, unsigned threads) {
  const unsigned shift = place.shift - 16;
  std::vector<std::vector<std::uint32_t>> histograms(threads, std::vector<std::uint32_t>(1u << 16));
  for_values_in(job, {&place, 1}, all_scored, threads, [&](unsigned thread, const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) ++histograms[thread][(std::bit_cast<std::uint64_t>(values[i]) >> shift) & 0xffff];
  });
  for (unsigned thread = 1; thread < threads; ++thread)
    for (std::size_t i = 0; i < histograms[0].size(); ++i) histograms[0][i] += histograms[thread][i];
  Place found = place_of_rank(histograms[0], place.rank);
  found.prefix |= place.prefix << 16;
  found.shift = shift;
  return found;
}

/// All values in the places, `total` of them, in no particular order.
std::vector<double> gather(const Job& job, std::span<const Place> places, std::uint64_t total, bool all_scored, unsigned threads) {
  std::vector<double> out(total);
  std::atomic<std::size_t> next{0};
  for_values_in(job, places, all_scored, threads, [&](unsigned, const double* values, std::size_t count) {
    std::copy(values, values + count, out.begin() + static_cast<std::ptrdiff_t>(next.fetch_add(count)));
  });
  return out;
}

}  // namespace

std::array<double, 3> percentiles(const Job& job, const Magnitudes& magnitudes, unsigned threads) {
  constexpr std::array<unsigned, 3> percents{50, 95, 99};
  std::array<double, 3> out{};
  std::vector<std::uint64_t> histogram = magnitudes.by_bucket;
  histogram[0] -= magnitudes.zeros;
  const std::uint64_t many = std::max(kAlwaysGathered, magnitudes.scored / 16);
  std::vector<Place> places;              // to be gathered, ascending, each once
  std::vector<std::pair<std::size_t, std::uint64_t>> wanted;  // which percentile, at which rank of what is gathered
  std::uint64_t gathered = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint64_t rank = magnitudes.scored == 0 ? 0 : rank_of_percentile(magnitudes.scored, percents[i]);
    if (rank < magnitudes.zeros || magnitudes.scored == 0) continue;  // 0: equal pixels come by the million, and are not gathered
    Place place = place_of_rank(histogram, rank - magnitudes.zeros);
    // A bucket that holds much of the image (differences that are all alike) is not stored but counted more finely.
    while (place.count > many && place.shift > 0) place = refined(job, place, magnitudes.all_scored, threads);
    if (place.shift == 0) {
      out[i] = std::bit_cast<double>(place.prefix);
      continue;
    }
    if (places.empty() || !(places.back() == place)) {
      places.push_back(place);
      gathered += place.count;
    }
    wanted.emplace_back(i, gathered - place.count + place.rank);
  }
  if (places.empty()) return out;
  std::vector<double> values = gather(job, places, gathered, magnitudes.all_scored, threads);
  auto settled = values.begin();  // what lies before is no larger than what lies behind
  for (const auto& [percentile, rank] : wanted) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(settled, place, values.end());
    settled = place;
    out[percentile] = *place;
  }
  return out;
}

}  // namespace equilux
