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

// Sums are taken over eight lanes in blocks and the blocks added pairwise, in an order that the number of threads cannot change: the
// error of a sum over n values is about (32 + log2 n) rounding steps of Σ|x|. Loops over lanes are what a compiler turns into SIMD
// without being allowed to reorder anything.
constexpr std::size_t kLanes = 8;
constexpr std::size_t kBlockPixels = 64;
constexpr std::size_t kBlockValues = 3 * kBlockPixels;
constexpr std::size_t kChunkBlocks = 64;
constexpr std::size_t kChunkPixels = kBlockPixels * kChunkBlocks;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();

/// One block, widened to double. Values beyond `values` up to the next multiple of kLanes are zeros, which change no result.
struct Block {
  std::size_t first_pixel, pixels, values;
  double a[kBlockValues], b[kBlockValues];          // radiances
  double own_a[kBlockValues], own_b[kBlockValues];  // each side's own B
  double bound[kBlockValues];                       // B of the pair
  double difference[kBlockValues], magnitude[kBlockValues];
  double en[kBlockValues];
  std::uint8_t outside[kBlockValues];               // |a − b| > B, or not known to be within
  std::uint32_t pixel[kBlockValues];                // which pixel a value belongs to, once some are left out (`leave_out`)
  std::size_t padded() const { return (values + kLanes - 1) / kLanes * kLanes; }
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
  for (std::size_t i = 0; i < block.values; ++i) {
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
  block.values = 3 * block.pixels;
  const std::size_t first = 3 * first_pixel, count = block.values;
  load(job.a, first, count, block.a);
  load(job.b, first, count, block.b);
  hard_bound(job.a, first, count, block.a, block.own_a);
  hard_bound(job.b, first, count, block.b, block.own_b);
  for (std::size_t i = 0; i < count; ++i) block.bound[i] = block.own_a[i] + block.own_b[i];
  if (job.a.sigma != nullptr || job.b.sigma != nullptr) add_sampled(job, block);
  for (std::size_t i = 0; i < count; ++i) {
    block.difference[i] = block.a[i] - block.b[i];
    block.magnitude[i] = std::fabs(block.difference[i]);
    block.outside[i] = !(block.magnitude[i] <= block.bound[i]);
  }
  // Equal values agree whatever B is; different ones with B = 0 are infinitely far apart.
  for (std::size_t i = 0; i < count; ++i) {
    const double quotient = block.difference[i] / block.bound[i];
    block.en[i] = block.magnitude[i] == 0 ? 0.0 : quotient;
  }
  for (std::size_t i = count; i < block.padded(); ++i)
    block.a[i] = block.b[i] = block.own_a[i] = block.own_b[i] = block.bound[i] = block.difference[i] = block.magnitude[i] = block.en[i] = 0;
}

bool is_finite(double value) { return std::fabs(value) <= kLargest; }

/// Whether some radiance or bound may be not finite or too negative: x − x is NaN unless x is finite, and NaN stays in a sum.
bool any_suspect(const Block& block) {
  double nothing[kLanes] = {}, lowest[kLanes] = {};
  for (std::size_t i = 0; i < block.padded(); i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double a = block.a[i + lane], b = block.b[i + lane], bound = block.bound[i + lane];
      nothing[lane] += (a - a) + (b - b) + (bound - bound);
      const double room_a = a + block.own_a[i + lane], room_b = b + block.own_b[i + lane];
      const double room = room_a < room_b ? room_a : room_b;
      const double low = room < bound ? room : bound;
      lowest[lane] = low < lowest[lane] ? low : lowest[lane];
    }
  bool suspect = false;
  for (std::size_t lane = 0; lane < kLanes; ++lane) suspect |= !(nothing[lane] == 0 && lowest[lane] == 0);
  return suspect;
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
  std::vector<std::uint32_t> magnitudes = std::vector<std::uint32_t>(kBuckets);  // of |a − b|
  std::vector<std::uint64_t> en_counts;
};

/// What one chunk gathers: maxima and places, merged in the order of the chunks.
struct Extremes {
  double max_abs = 0, max_rel = -1, edge_max_abs = 0;
  double en_max = -1;
  std::int64_t worst_pixel = -1, farthest_pixel = -1, first_invalid = -1;
};

/// Bin of |E_n|: a table over the leading bits gives the lowest bin possible; edges lie far enough apart that at most one is left to ask.
class EnBins {
 public:
  explicit EnBins(std::span<const double> edges) : first_(kBuckets), upper_(edges.begin() + 1, edges.end()) {
    for (std::size_t i = 0; i + 1 < upper_.size(); ++i)
      if (!(upper_[i] > 0 && upper_[i + 1] >= upper_[i] * 1.125)) throw std::invalid_argument("edges of E_n must ascend by an eighth at least");
    upper_.back() = kInfinity;
    std::size_t bin = 0;
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
      while (std::bit_cast<double>(static_cast<std::uint64_t>(bucket) << 48) > upper_[bin]) ++bin;
      first_[bucket] = static_cast<std::uint16_t>(bin);
    }
  }
  std::size_t bins() const { return upper_.size(); }
  std::size_t operator()(double magnitude) const {
    const std::size_t bin = first_[bucket_of(magnitude)];
    return bin + (magnitude > upper_[bin]);
  }

 private:
  std::vector<std::uint16_t> first_;
  std::vector<double> upper_;
};

PixelClass classify_suspect(const Job& job, const Block& block, std::size_t pixel, Tally& tally) {
  const std::size_t v = 3 * pixel;
  const bool bad_a = count_kinds(block.a + v, block.own_a + v, tally.invalid_a);
  const bool bad_b = count_kinds(block.b + v, block.own_b + v, tally.invalid_b);
  for (std::size_t i = v; i < v + 3; ++i)
    if (is_finite(block.a[i]) && is_finite(block.b[i]) && !(block.bound[i] >= 0 && block.bound[i] <= kLargest))
      throw std::domain_error("the uncertainty of a pixel is negative, NaN or infinite");
  if (bad_a || bad_b) return PixelClass::invalid;
  if ((block.outside[v] | block.outside[v + 1] | block.outside[v + 2]) == 0) return PixelClass::agree;
  const bool excused = job.edge != nullptr && job.edge[block.first_pixel + pixel] != 0;
  return excused ? PixelClass::edge : PixelClass::diverge;
}

/// Writes the classes of a block; true if all its pixels are to be scored.
bool classify(const Job& job, const Block& block, Tally& tally, Extremes& extremes) {
  std::uint8_t* classes = job.classes + block.first_pixel;
  if (job.edge == nullptr && !any_suspect(block)) {
    std::uint64_t diverging = 0;
    for (std::size_t pixel = 0; pixel < block.pixels; ++pixel) {
      classes[pixel] = block.outside[3 * pixel] | block.outside[3 * pixel + 1] | block.outside[3 * pixel + 2];
      diverging += classes[pixel];
    }
    tally.counts[0] += block.pixels - diverging;
    tally.counts[1] += diverging;
    return true;
  }
  bool all_scored = true;
  for (std::size_t pixel = 0; pixel < block.pixels; ++pixel) {
    const PixelClass kind = classify_suspect(job, block, pixel, tally);
    classes[pixel] = static_cast<std::uint8_t>(kind);
    ++tally.counts[classes[pixel]];
    all_scored &= kind == PixelClass::agree || kind == PixelClass::diverge;
    if (kind == PixelClass::invalid && extremes.first_invalid < 0)
      extremes.first_invalid = static_cast<std::int64_t>(block.first_pixel + pixel);
    if (kind == PixelClass::edge)
      for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i)
        extremes.edge_max_abs = std::max(extremes.edge_max_abs, block.magnitude[i]);
  }
  return all_scored;
}

bool is_scored(std::uint8_t kind) {
  return static_cast<PixelClass>(kind) == PixelClass::agree || static_cast<PixelClass>(kind) == PixelClass::diverge;
}

/// Moves the values of the pixels to be scored to the front of what the statistics read, and notes whose they are.
void leave_out(const std::uint8_t* classes, Block& block) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < block.values; ++i) {
    if (!is_scored(classes[i / 3])) continue;
    block.b[kept] = block.b[i];
    block.own_b[kept] = block.own_b[i];
    block.difference[kept] = block.difference[i];
    block.magnitude[kept] = block.magnitude[i];
    block.en[kept] = block.en[i];
    block.pixel[kept++] = static_cast<std::uint32_t>(i / 3);
  }
  block.values = kept;
  for (std::size_t i = kept; i < block.padded(); ++i)
    block.b[i] = block.own_b[i] = block.difference[i] = block.magnitude[i] = block.en[i] = 0;
}

double larger(double one, double other) { return one > other ? one : other; }

/// Sums and maxima over a block.
struct Reduction {
  double sum = 0, squares = 0, max_abs = 0, max_rel = -1, max_en = 0;
  std::uint64_t zeros = 0;
};

Reduction reduce(const Block& block) {
  double sum[kLanes] = {}, squares[kLanes] = {}, max_abs[kLanes] = {}, max_en[kLanes] = {}, zeros[kLanes] = {};
  double max_rel[kLanes];
  std::fill(max_rel, max_rel + kLanes, -1.0);
  for (std::size_t i = 0; i < block.padded(); i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double magnitude = block.magnitude[i + lane], reference = std::fabs(block.b[i + lane]);
      sum[lane] += block.difference[i + lane];
      squares[lane] += magnitude * magnitude;
      max_abs[lane] = larger(magnitude, max_abs[lane]);
      zeros[lane] += magnitude == 0 ? 1.0 : 0.0;
      max_en[lane] = larger(std::fabs(block.en[i + lane]), max_en[lane]);
      const double relative = magnitude / reference;
      max_rel[lane] = larger(reference > block.own_b[i + lane] ? relative : -1.0, max_rel[lane]);
    }
  Reduction out;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    out.sum += sum[lane];
    out.squares += squares[lane];
    out.max_abs = larger(max_abs[lane], out.max_abs);
    out.max_rel = larger(max_rel[lane], out.max_rel);
    out.max_en = larger(max_en[lane], out.max_en);
    out.zeros += static_cast<std::uint64_t>(zeros[lane]);
  }
  out.zeros -= block.padded() - block.values;
  return out;
}

/// The values at the front of a block, `block.values` of them; `moved`: after `leave_out`.
Reduction score(const Block& block, bool moved, const EnBins& bins, Tally& tally, Extremes& extremes) {
  const Reduction reduced = reduce(block);
  for (std::size_t i = 0; i < block.values; ++i) {
    ++tally.magnitudes[bucket_of(block.magnitude[i])];
    ++tally.en_counts[bins(std::fabs(block.en[i]))];
  }
  tally.scored += block.values;
  tally.zeros += reduced.zeros;
  const auto place = [&](std::size_t at) { return static_cast<std::int64_t>(block.first_pixel + (moved ? block.pixel[at] : at / 3)); };
  if (block.values > 0 && (extremes.farthest_pixel < 0 || reduced.max_abs > extremes.max_abs)) {
    std::size_t at = 0;
    while (block.magnitude[at] != reduced.max_abs) ++at;
    extremes.farthest_pixel = place(at);
  }
  extremes.max_abs = larger(reduced.max_abs, extremes.max_abs);
  extremes.max_rel = larger(reduced.max_rel, extremes.max_rel);
  if (reduced.max_en > kLargest)
    for (std::size_t i = 0; i < block.values; ++i) tally.en_infinite += std::fabs(block.en[i]) > kLargest;
  if (reduced.max_en > extremes.en_max && block.values > 0) {
    extremes.en_max = reduced.max_en;
    std::size_t at = 0;
    while (std::fabs(block.en[at]) != reduced.max_en) ++at;
    extremes.worst_pixel = place(at);
  }
  return reduced;
}

/// |E_n| ≤ 1 in the plane exactly where the band agrees: a value just above 1 must not be rounded down to it.
float plane_en(double en) {
  const float rounded = static_cast<float>(en);
  if (std::fabs(en) > 1 && std::fabs(rounded) <= 1) return std::copysign(std::nextafter(1.0f, 2.0f), rounded);
  return rounded;
}

void write_planes(const Job& job, const Block& block) {
  const std::size_t first = 3 * block.first_pixel, count = 3 * block.pixels;
  if (job.difference != nullptr)
    for (std::size_t i = 0; i < count; ++i) job.difference[first + i] = static_cast<float>(block.difference[i]);
  if (job.normalised_error == nullptr) return;
  for (std::size_t i = 0; i < count; ++i) job.normalised_error[first + i] = static_cast<float>(block.en[i]);
  for (std::size_t i = 0; i < count; ++i)
    if (block.outside[i] != 0)
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
  const bool all_scored = classify(job, block, tally, extremes);
  write_planes(job, block);
  if (!all_scored) leave_out(job.classes + block.first_pixel, block);
  const Reduction reduced = score(block, !all_scored, bins, tally, extremes);
  pass.sums[index] = reduced.sum;
  pass.squares[index] = reduced.squares;
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
    if (result.farthest_pixel < 0 || part.max_abs > result.max_abs) result.farthest_pixel = part.farthest_pixel;
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

using Candidates = std::array<std::vector<double>, 3>;

/// All |a − b| of scored pixels that lie in one of the wanted buckets; a bucket wanted twice is filled once.
Candidates gather(const Job& job, const std::array<std::size_t, 3>& buckets, unsigned threads, std::size_t chunks) {
  std::vector<Candidates> found(threads);
  parallel_chunks(chunks, threads, [&](std::size_t chunk, unsigned thread) {
    double a[kBlockValues], b[kBlockValues];
    const std::size_t end = std::min(job.pixels, (chunk + 1) * kChunkPixels);
    for (std::size_t first = chunk * kChunkPixels; first < end; first += kBlockPixels) {
      const std::size_t pixels = std::min(kBlockPixels, end - first);
      load(job.a, 3 * first, 3 * pixels, a);
      load(job.b, 3 * first, 3 * pixels, b);
      for (std::size_t i = 0; i < 3 * pixels; ++i) a[i] = std::fabs(a[i] - b[i]);
      for (std::size_t i = 0; i < 3 * pixels; ++i) {
        const std::size_t bucket = bucket_of(a[i]);
        if (bucket != buckets[0] && bucket != buckets[1] && bucket != buckets[2]) continue;
        if (a[i] == 0 || !is_scored(job.classes[first + i / 3])) continue;
        const std::size_t which = bucket == buckets[0] ? 0 : bucket == buckets[1] ? 1 : 2;
        found[thread][which].push_back(a[i]);
      }
    }
  });
  for (unsigned thread = 1; thread < threads; ++thread)
    for (std::size_t which = 0; which < 3; ++which)
      found[0][which].insert(found[0][which].end(), found[thread][which].begin(), found[thread][which].end());
  return std::move(found[0]);
}

void percentiles(const Job& job, const FirstPass& pass, unsigned threads, std::size_t chunks, Result& result) {
  if (result.max_abs == 0) return;  // all percentiles are 0
  constexpr std::array<unsigned, 3> percents{50, 95, 99};
  std::uint64_t zeros = 0;
  std::vector<std::uint32_t> histogram(kBuckets);
  for (const Tally& tally : pass.tallies) {
    zeros += tally.zeros;
    for (std::size_t i = 0; i < kBuckets; ++i) histogram[i] += tally.magnitudes[i];
  }
  histogram[0] -= static_cast<std::uint32_t>(zeros);
  std::array<Place, 3> places{};
  std::array<std::size_t, 3> buckets{kBuckets, kBuckets, kBuckets};  // no value has this one
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint64_t rank = rank_of_percentile(result.scored_values, percents[i]);
    if (rank < zeros) continue;  // the percentile is 0: equal pixels come by the million, and are not gathered
    places[i] = place_of_rank(histogram, rank - zeros);
    buckets[i] = places[i].bucket;
  }
  Candidates candidates = gather(job, buckets, threads, chunks);
  std::array<std::ptrdiff_t, 3> settled{};  // values before this place are no larger than those after it
  for (std::size_t i = 0; i < 3; ++i) {
    if (buckets[i] == kBuckets) continue;
    const auto which = static_cast<std::size_t>(std::find(buckets.begin(), buckets.end(), buckets[i]) - buckets.begin());
    std::vector<double>& values = candidates[which];
    const auto rank = static_cast<std::ptrdiff_t>(places[i].rank);  // no smaller than that of a lower percentile in the same bucket
    std::nth_element(values.begin() + settled[which], values.begin() + rank, values.end());
    settled[which] = rank;
    result.percentiles[i] = values[places[i].rank];
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
