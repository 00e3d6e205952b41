#include "compare.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "parallel.h"
#include "select.h"

namespace equilux {
namespace {

// Sums are taken over blocks and the blocks added pairwise, in an order that the number of threads cannot change: the error of a sum
// over n values is about (192 + log2 n) rounding steps of Σ|x|, whatever n.
constexpr std::size_t kBlockPixels = 64;
constexpr std::size_t kBlockValues = 3 * kBlockPixels;
constexpr std::size_t kChunkBlocks = 64;
constexpr std::size_t kChunkPixels = kBlockPixels * kChunkBlocks;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();

/// One block, widened to double.
struct Block {
  std::size_t first_pixel, pixels;
  double a[kBlockValues], b[kBlockValues];              // radiances
  double own_a[kBlockValues], own_b[kBlockValues];      // each side's own B
  double bound[kBlockValues];                           // B of the pair
  double difference[kBlockValues], magnitude[kBlockValues];
  double en[kBlockValues];
  std::size_t values() const { return 3 * pixels; }
};

void load(const Side& side, std::size_t first, std::size_t count, double* out) {
  if (side.is_double) {
    const double* in = static_cast<const double*>(side.image) + first;
    for (std::size_t i = 0; i < count; ++i) out[i] = in[i];
  } else {
    const float* in = static_cast<const float*>(side.image) + first;
    for (std::size_t i = 0; i < count; ++i) out[i] = in[i];
  }
}

void hard_bound(const Side& side, std::size_t first, std::size_t count, const double* radiance, double* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = side.abs + side.rel * std::fabs(radiance[i]);
  if (side.per_pixel != nullptr)
    for (std::size_t i = 0; i < count; ++i) out[i] += side.per_pixel[first + i];
}

/// B = Σ bounds + k √(σ_a² + σ_b²); each side's own B likewise with its own σ alone.
void add_sampled(const Job& job, Block& block) {
  const std::size_t first = 3 * block.first_pixel;
  const double k = job.coverage_factor;
  for (std::size_t i = 0; i < block.values(); ++i) {
    const double sigma_a = job.a.sigma != nullptr ? job.a.sigma[first + i] : 0.0;
    const double sigma_b = job.b.sigma != nullptr ? job.b.sigma[first + i] : 0.0;
    block.bound[i] += k * std::hypot(sigma_a, sigma_b);
    block.own_a[i] += k * sigma_a;
    block.own_b[i] += k * sigma_b;
  }
}

void fill(const Job& job, std::size_t first_pixel, Block& block) {
  block.first_pixel = first_pixel;
  block.pixels = std::min(kBlockPixels, job.pixels - first_pixel);
  const std::size_t first = 3 * first_pixel, count = block.values();
  load(job.a, first, count, block.a);
  load(job.b, first, count, block.b);
  hard_bound(job.a, first, count, block.a, block.own_a);
  hard_bound(job.b, first, count, block.b, block.own_b);
  for (std::size_t i = 0; i < count; ++i) block.bound[i] = block.own_a[i] + block.own_b[i];
  if (job.a.sigma != nullptr || job.b.sigma != nullptr) add_sampled(job, block);
  for (std::size_t i = 0; i < count; ++i) {
    block.difference[i] = block.a[i] - block.b[i];
    block.magnitude[i] = std::fabs(block.difference[i]);
  }
  // Equal values agree whatever B is; different ones with B = 0 are infinitely far apart.
  for (std::size_t i = 0; i < count; ++i) block.en[i] = block.magnitude[i] == 0 ? 0.0 : block.difference[i] / block.bound[i];
}

bool is_finite(double value) { return std::fabs(value) <= kLargest; }

bool any_suspect(const Block& block) {
  int suspect = 0;
  for (std::size_t i = 0; i < block.values(); ++i) {
    const bool sound = std::fabs(block.a[i]) <= kLargest && std::fabs(block.b[i]) <= kLargest && block.bound[i] >= 0 &&
                       block.bound[i] <= kLargest && block.a[i] >= -block.own_a[i] && block.b[i] >= -block.own_b[i];
    suspect |= !sound;
  }
  return suspect != 0;
}

/// Counts the kinds of one side's pixel; true if there is any.
bool count_kinds(const double* radiance, const double* own, InvalidKinds& kinds) {
  bool nan = false, plus = false, minus = false, negative = false;
  for (int band = 0; band < 3; ++band) {
    const double value = radiance[band];
    if (std::isnan(value)) nan = true;
    else if (value == kInfinity) plus = true;
    else if (value == -kInfinity) minus = true;
    else if (value < -own[band]) negative = true;
  }
  kinds.nan += nan;
  kinds.plus_inf += plus;
  kinds.minus_inf += minus;
  kinds.negative += negative;
  return nan || plus || minus || negative;
}

/// What one thread gathers: only integers, which add up alike in any order.
struct Tally {
  std::array<std::uint64_t, 4> counts{};
  InvalidKinds invalid_a, invalid_b;
  std::uint64_t zeros = 0, scored = 0, en_infinite = 0;
  std::vector<std::uint32_t> magnitudes = std::vector<std::uint32_t>(kBuckets);  // of the non-zero |a − b|
  std::vector<std::uint64_t> en_counts;
};

/// What one chunk gathers: maxima and places, merged in the order of the chunks.
struct Extremes {
  double max_abs = 0, max_rel = -1, edge_max_abs = 0;
  double en_max = -1;
  std::int64_t worst_pixel = -1, first_invalid = -1;
};

/// Bin of |E_n|: a table over the leading bits gives the lowest bin possible, at most a step or two is left to be looked at.
class EnBins {
 public:
  explicit EnBins(std::span<const double> edges) : edges_(edges), first_(kBuckets) {
    std::size_t bin = 0;
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
      const double low = std::bit_cast<double>(static_cast<std::uint64_t>(bucket) << 48);
      while (bin + 1 < bins() && low > edges_[bin + 1]) ++bin;
      first_[bucket] = static_cast<std::uint16_t>(bin);
    }
  }
  std::size_t bins() const { return edges_.size() - 1; }
  std::size_t operator()(double magnitude) const {
    std::size_t bin = first_[bucket_of(magnitude)];
    while (bin + 1 < bins() && magnitude > edges_[bin + 1]) ++bin;
    return bin;
  }

 private:
  std::span<const double> edges_;
  std::vector<std::uint16_t> first_;
};

PixelClass classify(const Job& job, const Block& block, std::size_t pixel, bool suspect, Tally& tally) {
  const std::size_t v = 3 * pixel;
  if (suspect) {
    const bool bad_a = count_kinds(block.a + v, block.own_a + v, tally.invalid_a);
    const bool bad_b = count_kinds(block.b + v, block.own_b + v, tally.invalid_b);
    for (std::size_t i = v; i < v + 3; ++i)
      if (is_finite(block.a[i]) && is_finite(block.b[i]) && !(block.bound[i] >= 0 && block.bound[i] <= kLargest))
        throw std::domain_error("the uncertainty of a pixel is negative, NaN or infinite");
    if (bad_a || bad_b) return PixelClass::invalid;
  }
  const bool within = block.magnitude[v] <= block.bound[v] && block.magnitude[v + 1] <= block.bound[v + 1] &&
                      block.magnitude[v + 2] <= block.bound[v + 2];
  if (within) return PixelClass::agree;
  const bool excused = job.edge != nullptr && job.edge[block.first_pixel + pixel] != 0;
  return excused ? PixelClass::edge : PixelClass::diverge;
}

/// The three bands of one pixel that is neither edge nor invalid.
void score_pixel(const Block& block, std::size_t pixel, const EnBins& bins, Tally& tally, Extremes& extremes, double& sum,
                 double& squares) {
  for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
    const double magnitude = block.magnitude[i], en = std::fabs(block.en[i]), reference = std::fabs(block.b[i]);
    sum += block.difference[i];
    squares += magnitude * magnitude;
    if (magnitude == 0) ++tally.zeros;
    else ++tally.magnitudes[bucket_of(magnitude)];
    if (magnitude > extremes.max_abs) extremes.max_abs = magnitude;
    // The division is worth its time only where it can be a new maximum; the margin outweighs the rounding of the product.
    if (reference > block.own_b[i] && magnitude >= extremes.max_rel * reference * (1 - 1e-15))
      extremes.max_rel = std::max(extremes.max_rel, magnitude / reference);
    ++tally.en_counts[bins(en)];
    if (en > kLargest) ++tally.en_infinite;
    if (en > extremes.en_max) {
      extremes.en_max = en;
      extremes.worst_pixel = static_cast<std::int64_t>(block.first_pixel + pixel);
    }
  }
  tally.scored += 3;
}

/// |E_n| ≤ 1 in the plane exactly where the band agrees: a value just above 1 must not be rounded down to it.
float plane_en(double en) {
  const float rounded = static_cast<float>(en);
  if (std::fabs(en) > 1 && std::fabs(rounded) <= 1) return std::copysign(std::nextafter(1.0f, 2.0f), rounded);
  return rounded;
}

void write_planes(const Job& job, const Block& block) {
  const std::size_t first = 3 * block.first_pixel;
  if (job.difference != nullptr)
    for (std::size_t i = 0; i < block.values(); ++i) job.difference[first + i] = static_cast<float>(block.difference[i]);
  if (job.normalised_error != nullptr)
    for (std::size_t i = 0; i < block.values(); ++i)
      job.normalised_error[first + i] = is_finite(block.a[i]) && is_finite(block.b[i]) ? plane_en(block.en[i])
                                                                                       : std::numeric_limits<float>::quiet_NaN();
}

/// Recursive halving: the rounding error grows with the logarithm of the count.
double pairwise_sum(std::span<const double> values) {
  if (values.size() <= 8) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
  }
  const std::size_t half = values.size() / 2;
  return pairwise_sum(values.first(half)) + pairwise_sum(values.subspan(half));
}

struct FirstPass {
  std::vector<Tally> tallies;      // per thread
  std::vector<Extremes> extremes;  // per chunk
  std::vector<double> sums, squares;  // per block
};

void score_block(const Job& job, const EnBins& bins, std::size_t index, Block& block, FirstPass& pass, Tally& tally,
                 Extremes& extremes) {
  fill(job, index * kBlockPixels, block);
  const bool suspect = any_suspect(block);
  double sum = 0, squares = 0;
  for (std::size_t pixel = 0; pixel < block.pixels; ++pixel) {
    const PixelClass kind = classify(job, block, pixel, suspect, tally);
    ++tally.counts[static_cast<std::size_t>(kind)];
    job.classes[block.first_pixel + pixel] = static_cast<std::uint8_t>(kind);
    if (kind == PixelClass::agree || kind == PixelClass::diverge) {
      score_pixel(block, pixel, bins, tally, extremes, sum, squares);
    } else if (kind == PixelClass::edge) {
      for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i)
        extremes.edge_max_abs = std::max(extremes.edge_max_abs, block.magnitude[i]);
    } else if (extremes.first_invalid < 0) {
      extremes.first_invalid = static_cast<std::int64_t>(block.first_pixel + pixel);
    }
  }
  pass.sums[index] = sum;
  pass.squares[index] = squares;
  write_planes(job, block);
}

FirstPass first_pass(const Job& job, unsigned threads, std::size_t chunks, std::size_t blocks) {
  const EnBins bins(job.en_edges);
  FirstPass pass;
  pass.tallies.resize(threads);
  for (Tally& tally : pass.tallies) tally.en_counts.resize(bins.bins());
  pass.extremes.resize(chunks);
  pass.sums.resize(blocks);
  pass.squares.resize(blocks);
  parallel_chunks(chunks, threads, [&](std::size_t chunk, unsigned thread) {
    Block block;
    const std::size_t end = std::min(blocks, (chunk + 1) * kChunkBlocks);
    for (std::size_t index = chunk * kChunkBlocks; index < end; ++index)
      score_block(job, bins, index, block, pass, pass.tallies[thread], pass.extremes[chunk]);
  });
  return pass;
}

void add(InvalidKinds& total, const InvalidKinds& part) {
  total.nan += part.nan;
  total.plus_inf += part.plus_inf;
  total.minus_inf += part.minus_inf;
  total.negative += part.negative;
}

Result merge(const FirstPass& pass, std::size_t bins) {
  Result result;
  result.en_counts.resize(bins);
  for (const Tally& tally : pass.tallies) {
    for (std::size_t i = 0; i < 4; ++i) result.counts[i] += tally.counts[i];
    for (std::size_t i = 0; i < bins; ++i) result.en_counts[i] += tally.en_counts[i];
    add(result.invalid_a, tally.invalid_a);
    add(result.invalid_b, tally.invalid_b);
    result.scored_values += tally.scored;
    result.en_infinite += tally.en_infinite;
  }
  double en_max = -1;
  for (const Extremes& part : pass.extremes) {
    result.max_abs = std::max(result.max_abs, part.max_abs);
    result.max_rel = std::max(result.max_rel, part.max_rel);
    result.edge_max_abs = std::max(result.edge_max_abs, part.edge_max_abs);
    if (part.en_max > en_max) {
      en_max = part.en_max;
      result.worst_pixel = part.worst_pixel;
    }
    if (result.first_invalid < 0) result.first_invalid = part.first_invalid;
  }
  result.en_max = std::max(en_max, 0.0);
  result.sum = pairwise_sum(pass.sums);
  result.sum_of_squares = pairwise_sum(pass.squares);
  return result;
}

/// All |a − b| of scored pixels that lie in one of the wanted buckets.
std::array<std::vector<double>, 3> gather(const Job& job, const std::array<std::size_t, 3>& buckets, unsigned threads,
                                          std::size_t chunks) {
  std::vector<std::array<std::vector<double>, 3>> found(threads);
  parallel_chunks(chunks, threads, [&](std::size_t chunk, unsigned thread) {
    double a[kBlockValues], b[kBlockValues];
    const std::size_t end = std::min(job.pixels, (chunk + 1) * kChunkPixels);
    for (std::size_t first = chunk * kChunkPixels; first < end; first += kBlockPixels) {
      const std::size_t pixels = std::min(kBlockPixels, end - first);
      load(job.a, 3 * first, 3 * pixels, a);
      load(job.b, 3 * first, 3 * pixels, b);
      for (std::size_t i = 0; i < 3 * pixels; ++i) {
        const auto kind = static_cast<PixelClass>(job.classes[first + i / 3]);
        const double magnitude = std::fabs(a[i] - b[i]);
        if (magnitude == 0 || (kind != PixelClass::agree && kind != PixelClass::diverge)) continue;
        const std::size_t bucket = bucket_of(magnitude);
        for (std::size_t which = 0; which < 3; ++which)
          if (bucket == buckets[which]) {
            found[thread][which].push_back(magnitude);
            break;
          }
      }
    }
  });
  for (unsigned thread = 1; thread < threads; ++thread)
    for (std::size_t which = 0; which < 3; ++which)
      found[0][which].insert(found[0][which].end(), found[thread][which].begin(), found[thread][which].end());
  return std::move(found[0]);
}

void percentiles(const Job& job, const FirstPass& pass, unsigned threads, std::size_t chunks, Result& result) {
  if (result.scored_values == 0) return;
  constexpr std::array<unsigned, 3> percents{50, 95, 99};
  std::uint64_t zeros = 0;
  std::vector<std::uint32_t> histogram(kBuckets);
  for (const Tally& tally : pass.tallies) {
    zeros += tally.zeros;
    for (std::size_t i = 0; i < kBuckets; ++i) histogram[i] += tally.magnitudes[i];
  }
  std::array<Place, 3> places{};
  std::array<std::size_t, 3> buckets{kBuckets, kBuckets, kBuckets};  // no value has this one
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint64_t rank = rank_of_percentile(result.scored_values, percents[i]);
    if (rank < zeros) continue;
    places[i] = place_of_rank(histogram, rank - zeros);
    buckets[i] = places[i].bucket;
  }
  if (buckets == std::array<std::size_t, 3>{kBuckets, kBuckets, kBuckets}) return;
  auto candidates = gather(job, buckets, threads, chunks);
  for (std::size_t i = 0; i < 3; ++i) {
    if (buckets[i] == kBuckets) continue;
    // Percentiles that share a bucket share the first one's values.
    const std::size_t which = static_cast<std::size_t>(std::find(buckets.begin(), buckets.end(), buckets[i]) - buckets.begin());
    std::vector<double>& values = candidates[which];
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(places[i].rank);
    std::nth_element(values.begin(), nth, values.end());
    result.percentiles[i] = *nth;
  }
}

}  // namespace

Result compare(const Job& job) {
  const std::size_t blocks = (job.pixels + kBlockPixels - 1) / kBlockPixels;
  const std::size_t chunks = (job.pixels + kChunkPixels - 1) / kChunkPixels;
  const unsigned threads = thread_count(job.threads, chunks);
  const FirstPass pass = first_pass(job, threads, chunks, blocks);
  Result result = merge(pass, job.en_edges.size() - 1);
  percentiles(job, pass, threads, chunks, result);
  return result;
}

}  // namespace equilux
