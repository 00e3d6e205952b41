#include "compare.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "block.h"
#include "histograms.h"
#include "parallel.h"
#include "percentiles.h"
#include "plain_block.h"
#include "select.h"
#include "widen.h"

namespace equilux {
namespace {


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
  widen(job.a, first, count, block.a);
  widen(job.b, first, count, block.b);
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

/// What one thread gathers: only integers, which add up alike in any order; max_rel is but what is worth a division (`sweep`).
struct Tally {
  explicit Tally(std::span<const double> en_edges) : histograms(en_edges) {}
  std::array<std::uint64_t, 4> counts{};
  InvalidKinds invalid_a, invalid_b;
  std::uint64_t zeros = 0, scored = 0, en_infinite = 0;
  Histograms histograms;
  double max_rel = -1;
};

/// What one chunk gathers: maxima and places, merged in the order of the chunks.
struct Extremes {
  double max_abs = 0, max_rel = -1, edge_max_abs = 0;
  double en_max = -1;
  std::int64_t worst_pixel = -1, farthest_pixel = -1, first_invalid = -1;
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

/// Adds the values of a block, `values` of them; pixel_of(i) tells which pixel of the image value i belongs to.
template <class PixelOf>
void score(const double* magnitude, const double* en, std::size_t values, const Reduction& reduced, Tally& tally,
           Extremes& extremes, PixelOf&& pixel_of) {
  tally.histograms.count(magnitude, en, values);
  tally.scored += values;
  tally.zeros += reduced.zeros;
  tally.max_rel = larger(reduced.max_rel, tally.max_rel);
  if (values > 0 && (extremes.farthest_pixel < 0 || reduced.max_abs > extremes.max_abs)) {
    std::size_t at = 0;
    while (magnitude[at] != reduced.max_abs) ++at;
    extremes.farthest_pixel = static_cast<std::int64_t>(pixel_of(at));
  }
  extremes.max_abs = larger(reduced.max_abs, extremes.max_abs);
  extremes.max_rel = larger(reduced.max_rel, extremes.max_rel);
  if (reduced.max_en > kLargest)
    for (std::size_t i = 0; i < values; ++i) tally.en_infinite += std::fabs(en[i]) > kLargest;
  if (reduced.max_en > extremes.en_max && values > 0) {
    extremes.en_max = reduced.max_en;
    std::size_t at = 0;
    while (std::fabs(en[at]) != reduced.max_en) ++at;
    extremes.worst_pixel = static_cast<std::int64_t>(pixel_of(at));
  }
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

/// A thread, with its histograms, costs about as much as scoring so many chunks.
constexpr std::size_t kChunksPerThread = 8;

struct FirstPass {
  std::vector<Tally> tallies;      // per thread
  std::vector<Extremes> extremes;  // per chunk
  std::vector<double> sums, squares;  // per block
};

/// A block with something in it that needs a second look, or the last one.
Reduction score_with_care(const Job& job, std::size_t first_pixel, Block& block, Tally& tally, Extremes& extremes) {
  fill(job, first_pixel, block);
  const bool all_scored = classify(job, block, tally, extremes);
  write_planes(job, block);
  if (!all_scored) leave_out(job.classes + first_pixel, block);
  const Reduction reduced = reduce(block);
  score(block.magnitude, block.en, block.values, reduced, tally, extremes,
        [&](std::size_t at) { return first_pixel + (all_scored ? at / 3 : block.pixel[at]); });
  return reduced;
}

/// Classes of a block all of whose pixels are sane and none excused.
void classify_plain(const Job& job, std::size_t first_pixel, const PlainBlock& block, Tally& tally) {
  std::uint8_t* const classes = job.classes + first_pixel;
  std::uint64_t diverging = 0;
  if (!block.any_outside) std::fill(classes, classes + kBlockPixels, std::uint8_t{0});
  else
    for (std::size_t pixel = 0; pixel < kBlockPixels; ++pixel) {
      const std::uint64_t* const outside = block.outside + 3 * pixel;
      classes[pixel] = static_cast<std::uint8_t>(outside[0] | outside[1] | outside[2]);
      diverging += classes[pixel];
    }
  tally.counts[0] += kBlockPixels - diverging;
  tally.counts[1] += diverging;
}

/// Whether some pixel of a whole block is excused as an edge.
bool excuses_any(const Job& job, std::size_t first_pixel) {
  if (job.edge == nullptr) return false;
  const std::uint8_t* const marks = job.edge + first_pixel;
  return std::any_of(marks, marks + kBlockPixels, [](std::uint8_t mark) { return mark != 0; });
}

/// careful, plain: room to work in.
Reduction score_block(const Job& job, std::size_t first_pixel, Block& careful, PlainBlock& plain, Tally& tally,
                      Extremes& extremes) {
  const bool is_whole = first_pixel + kBlockPixels <= job.pixels;
  const bool is_plain = is_whole && job.a.sigma == nullptr && job.b.sigma == nullptr && !excuses_any(job, first_pixel);
  if (is_plain) sweep(job, first_pixel, tally.max_rel, plain);
  if (!is_plain || plain.suspect) return score_with_care(job, first_pixel, careful, tally, extremes);
  classify_plain(job, first_pixel, plain, tally);
  score(plain.magnitude, plain.en, kBlockValues, plain.reduced, tally, extremes,
        [&](std::size_t at) { return first_pixel + at / 3; });
  return plain.reduced;
}

FirstPass first_pass(const Job& job, unsigned threads, std::size_t chunks, std::size_t blocks) {
  FirstPass pass;
  pass.tallies.resize(threads, Tally(job.en_edges));
  pass.extremes.resize(chunks);
  pass.sums.resize(blocks);
  pass.squares.resize(blocks);
  parallel_chunks(chunks, threads, [&](std::size_t chunk, unsigned thread) {
    Block careful;
    PlainBlock plain;
    const std::size_t end = std::min(blocks, (chunk + 1) * kChunkBlocks);
    for (std::size_t index = chunk * kChunkBlocks; index < end; ++index) {
      const Reduction reduced =
          score_block(job, index * kBlockPixels, careful, plain, pass.tallies[thread], pass.extremes[chunk]);
      pass.sums[index] = reduced.sum;
      pass.squares[index] = reduced.squares;
    }
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
    const std::vector<std::uint64_t> errors = tally.histograms.errors();
    for (std::size_t i = 0; i < bins; ++i) result.en_counts[i] += errors[i];
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

Magnitudes magnitudes_of(const FirstPass& pass, const Result& result) {
  Magnitudes out{std::vector<std::uint64_t>(kBuckets), 0, result.scored_values, result.counts[2] + result.counts[3] == 0};
  for (const Tally& tally : pass.tallies) {
    out.zeros += tally.zeros;
    for (std::size_t i = 0; i < kBuckets; ++i) out.by_bucket[i] += tally.histograms.magnitudes(i);
  }
  return out;
}

}  // namespace

Result compare(const Job& job) {
  const std::size_t blocks = (job.pixels + kBlockPixels - 1) / kBlockPixels;
  const std::size_t chunks = (job.pixels + kChunkPixels - 1) / kChunkPixels;
  const unsigned threads = thread_count(job.threads, chunks / kChunksPerThread);
  const FirstPass pass = first_pass(job, threads, chunks, blocks);
  Result result = merge(pass, job.en_edges.size() - 1);
  result.percentiles = percentiles(job, magnitudes_of(pass, result), threads);
  return result;
}

}  // namespace equilux
