// One sample of model raytraced by itself: its first surface, and every ray that follows from there.
#pragma once

#include "path.h"

namespace equilux {

template <class F> void write_sample(Tracing& tracing, const SurfacePoint& point, std::size_t i) {
  const Outputs& out = tracing.out;
  const Bands radiance = shown(tracing.radiance);
  if (out.radiance) write(out.radiance, i, radiance);
  if constexpr (F::channels) {
    const World& world = tracing.world;
    const MaterialDescription& material = material_of(world, point.object);
    if (out.emission) write(out.emission, i, material.emission);
    if (out.ambient) write(out.ambient, i, material.ambient * world.description.ambient);
    for (std::size_t k = 0; k < world.lights.size(); ++k) {
      if (out.light_ambient) write(out.light_ambient, i * world.lights.size() + k, Bands{});
    }
    if (out.reflected) write(out.reflected, i, tracing.reflected);
    if (out.transmitted) write(out.transmitted, i, tracing.transmitted);
    const Bands rounding = tracing.rounding + radiance * static_cast<double>(tracing.terms);
    if (out.rounding) write(out.rounding, i, stated(rounding, radiance, point.undecided || tracing.undecided()));
    if (out.signature) out.signature[i] = tracing.signature.value();
    write_geometry(world, point, out, i);
  }
}

// Samples one by one; one per thread.
template <class F> class OneByOne {
 public:
  OneByOne(const World& world, const Outputs& out) : world_(world), out_(out), tracing_(world, out) { search_.world = &world; }

  // find(search, point): whether the eye's ray meets a surface, and where. False: cancelled.
  template <class Find> bool render(std::size_t i, const Find& find, const Stopped& stopped) {
    if (!find(search_, point_)) {
      write_miss<F>(world_, out_, i);
      return true;
    }
    tracing_.begin();
    Journey journey;
    if constexpr (F::ruled) journey = first_journey(tracing_, search_.film_ray, point_);
    shade<F>(tracing_, {point_, material_of(world_, point_.object), {1, 1, 1}, 0, Branch::none, i, {}, journey});
    if constexpr (F::secondary) {
      if (!follow_all<F>(tracing_, i, stopped)) return false;
    }
    write_sample<F>(tracing_, point_, i);
    return true;
  }

 private:
  const World& world_;
  const Outputs& out_;
  Search search_;
  SurfacePoint point_;
  Tracing tracing_;
};

}  // namespace equilux
