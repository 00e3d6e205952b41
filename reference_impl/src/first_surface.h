// The loop of the local models: each sample's first surface is found and shaded, and that is all.
#pragma once

#include "outputs.h"
#include "precision.h"

namespace equilux {

// One sample: shade(point, i) writes it. F::Precision finds the surface, F::channels says whether anything but radiance is asked for.
template <class F, class Shade>
void render_one(const World& world, const Samples& samples, const Outputs& out, Search& search, SurfacePoint& point, std::size_t i,
                const Shade& shade) {
  search.world = &world;
  double x, y;
  samples.position(i, x, y);
  if (F::Precision::find(world, search, x, y, point)) {
    shade(point, i);
  } else {
    write_miss<F>(world, out, i);
  }
}

// All of them.
template <class F, class Shade>
bool render_first_surface(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                          const Interrupted& interrupted, const Shade& shade) {
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end) {
    Search search;
    SurfacePoint point;
    for (std::size_t i = begin; i < end; ++i) render_one<F>(world, samples, out, search, point, i, shade);
  });
}

}  // namespace equilux
