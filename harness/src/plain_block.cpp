#include "plain_block.h"

#include <cmath>

#include "clones.h"
#include "widen.h"

namespace equilux {
namespace {

/// One side of a block: radiances and, where they vary per pixel, bounds.
struct Values {
  double radiance[kBlockValues], own[kBlockValues];
};

[[gnu::always_inline]] inline void load(const Side& side, std::size_t first, Values& out) {
  widen(side, first, kBlockValues, out.radiance);
  for (std::size_t i = 0; i < kBlockValues; ++i) out.own[i] = side.abs + side.rel * std::fabs(out.radiance[i]);
  if (side.per_pixel != nullptr)
    for (std::size_t i = 0; i < kBlockValues; ++i) out.own[i] += side.per_pixel[first + i];
}

/// Running values of one lane of the sweep.
struct Lanes {
  double sum[kLanes] = {}, squares[kLanes] = {}, max_abs[kLanes] = {}, max_en[kLanes] = {}, zeros[kLanes] = {};
  double nothing[kLanes] = {}, lowest[kLanes] = {};  // x − x is NaN unless x is finite, and NaN stays in a sum
  double beyond[kLanes] = {}, relative[kLanes] = {};  // how many |a − b| > B; how many quotients |a − b|/|b| may be the largest
};

[[gnu::always_inline]] inline Reduction total(const Lanes& lanes, PlainBlock& block, bool& relative) {
  Reduction out;
  bool suspect = false, beyond = false;
  relative = false;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    out.sum += lanes.sum[lane];
    out.squares += lanes.squares[lane];
    out.max_abs = larger(lanes.max_abs[lane], out.max_abs);
    out.max_en = larger(lanes.max_en[lane], out.max_en);
    out.zeros += static_cast<std::uint64_t>(lanes.zeros[lane]);
    suspect |= !(lanes.nothing[lane] == 0 && lanes.lowest[lane] == 0);
    beyond |= lanes.beyond[lane] != 0;
    relative |= lanes.relative[lane] != 0;
  }
  block.suspect = suspect;
  block.any_outside = beyond;
  return out;
}

[[gnu::always_inline]] inline double largest_relative(const Values& b, const double* magnitude) {
  double highest[kLanes];
  for (double& lane : highest) lane = -1;
  for (std::size_t i = 0; i < kBlockValues; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double reference = std::fabs(b.radiance[i + lane]), relative = magnitude[i + lane] / reference;
      highest[lane] = larger(reference > b.own[i + lane] ? relative : -1.0, highest[lane]);
    }
  double out = -1;
  for (const double lane : highest) out = larger(lane, out);
  return out;
}

}  // namespace

EQUILUX_CLONES
void sweep(const Job& job, std::size_t first_pixel, double max_rel, PlainBlock& block) {
  const std::size_t first = 3 * first_pixel;
  Values a, b;
  load(job.a, first, a);
  load(job.b, first, b);
  double signed_en[kBlockValues];
  Lanes lanes;
  // No quotient that rounds to more than max_rel belongs to a magnitude below this share of |b|: rounding is monotonic.
  const double share = max_rel * (1 - 0x1p-50);
  for (std::size_t i = 0; i < kBlockValues; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t at = i + lane;
      const double radiance_a = a.radiance[at], radiance_b = b.radiance[at], own_a = a.own[at], own_b = b.own[at];
      const double bound = own_a + own_b, difference = radiance_a - radiance_b, magnitude = std::fabs(difference);
      const double quotient = difference / bound;
      const double en = magnitude == 0 ? 0.0 : quotient;  // equal values agree whatever B is
      block.magnitude[at] = magnitude;
      signed_en[at] = en;
      block.en[at] = std::fabs(en);
      const bool within = magnitude <= bound;
      block.outside[at] = within ? 0 : 1;
      lanes.beyond[lane] += within ? 0.0 : 1.0;
      lanes.nothing[lane] += (radiance_a - radiance_a) + (radiance_b - radiance_b) + (bound - bound);
      const double room_a = radiance_a + own_a, room_b = radiance_b + own_b;
      const double room = room_a < room_b ? room_a : room_b;
      const double low = room < bound ? room : bound;
      lanes.lowest[lane] = low < lanes.lowest[lane] ? low : lanes.lowest[lane];
      lanes.sum[lane] += difference;
      lanes.squares[lane] += magnitude * magnitude;
      lanes.max_abs[lane] = larger(magnitude, lanes.max_abs[lane]);
      lanes.zeros[lane] += magnitude == 0 ? 1.0 : 0.0;
      lanes.max_en[lane] = larger(std::fabs(en), lanes.max_en[lane]);
      const double reference = std::fabs(radiance_b);
      const double wanted = magnitude >= share * reference ? 1.0 : 0.0;
      lanes.relative[lane] += (reference > own_b ? 1.0 : 0.0) * (magnitude > 0 ? wanted : 0.0);
    }
  bool relative;
  block.reduced = total(lanes, block, relative);
  if (block.suspect) return;
  if (relative || max_rel < 0) block.reduced.max_rel = largest_relative(b, block.magnitude);
  if (job.difference != nullptr)
    for (std::size_t i = 0; i < kBlockValues; ++i)
      job.difference[first + i] = static_cast<float>(a.radiance[i] - b.radiance[i]);
  if (job.normalised_error != nullptr)
    for (std::size_t i = 0; i < kBlockValues; ++i) job.normalised_error[first + i] = plane_en(signed_en[i]);
}

}  // namespace equilux
