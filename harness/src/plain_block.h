#pragma once
// Scoring a whole block of pixels in one sweep, where nothing in it needs a second look: all radiances and bounds are sane, no pixel
// is excused as an edge, nothing was sampled. That is nearly every block of nearly every pair.

#include "block.h"
#include "compare.h"

namespace equilux {

/// What the sweep leaves for the histograms and the classes, and what it found.
struct PlainBlock {
  double magnitude[kBlockValues];        // |a − b|
  double en[kBlockValues];               // |E_n|
  std::uint64_t outside[kBlockValues];   // non-zero: |a − b| > B
  Reduction reduced;                     // max_rel: −1 unless it may exceed the caller's
  bool suspect;                          // some radiance or bound is not sane: nothing of this counts, the block is to be scored with care
  bool any_outside;
};

/// Scores the kBlockPixels pixels from `first_pixel` on, and writes their differences and normalised errors where the job wants
/// them. max_rel: the largest |a − b|/|b| found so far, −1 for none; smaller ones are not worth a division.
void sweep(const Job& job, std::size_t first_pixel, double max_rel, PlainBlock& block);

}  // namespace equilux
