// Model raytraced: what is seen, mirrored and refracted, to the recursion limit.
#include "kernels.h"
#include "path.h"
#include "precision.h"

namespace equilux {
namespace {

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

template <class F>
bool render_with(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    Search search;
    search.world = &world;
    SurfacePoint point;
    Tracing tracing(world, out);
    for (std::size_t i = begin; i < end; ++i) {
      double x, y;
      samples.position(i, x, y);
      if (!Exact::find(world, search, x, y, point)) {
        write_miss<F>(world, out, i);
        continue;
      }
      tracing.begin();
      Journey journey;
      if constexpr (F::ruled) journey = first_journey(tracing, search.film_ray, point);
      shade<F>(tracing, {point, material_of(world, point.object), {1, 1, 1}, 0, Branch::none, i, {}, journey});
      if constexpr (F::secondary) {
        if (!follow_all<F>(tracing, i, stopped)) return;
      }
      write_sample<F>(tracing, point, i);
    }
  });
}

using RenderFunction = bool (*)(const World&, const Samples&, const Outputs&, int, const Cancel*, const Interrupted&);

template <bool Channels> RenderFunction choose(const Features& needed, bool ruled) {
  if (ruled) return render_with<PathFeatures<true, true, true, Channels, Channels, true>>;
  if (needed.transparency) return render_with<PathFeatures<true, true, true, Channels>>;
  if (needed.reflection) return render_with<PathFeatures<true, true, false, Channels>>;
  if (needed.occlusion) return render_with<PathFeatures<true, false, false, Channels>>;
  return render_with<PathFeatures<false, false, false, Channels>>;
}

}  // namespace

bool render_raytraced(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                      const Interrupted& interrupted) {
  const bool ruled = world.description.rules.changed();
  const RenderFunction kernel = outputs.only_radiance() ? choose<false>(world.features, ruled) : choose<true>(world.features, ruled);
  return kernel(world, samples, outputs, threads, cancel, interrupted);
}

}  // namespace equilux
