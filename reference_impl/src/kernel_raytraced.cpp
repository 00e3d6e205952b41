// Model raytraced: what is seen, mirrored and refracted, to the recursion limit.
#include <memory>

#include "kernels.h"
#include "packets/render_packets.h"
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

// Samples one by one; one per thread.
template <class F> class OneByOne {
 public:
  OneByOne(const World& world, const Samples& samples, const Outputs& out)
      : world_(world), samples_(samples), out_(out), tracing_(world, out) {
    search_.world = &world;
  }

  // False: cancelled.
  bool render(std::size_t i, const Stopped& stopped) {
    double x, y;
    samples_.position(i, x, y);
    if (!Exact::find(world_, search_, x, y, point_)) {
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
  const Samples& samples_;
  const Outputs& out_;
  Search search_;
  SurfacePoint point_;
  Tracing tracing_;
};

// Where no ray is followed further and only radiance is asked for, packets do what is plain.
template <class F>
bool render_in_packets(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                       const Interrupted& interrupted) {
  const auto one_by_one = [&] {
    return packets::Sampler([single = std::make_shared<OneByOne<F>>(world, samples, out)](std::size_t i) { single->render(i, {}); });
  };
  return packets::render(world, samples, out, threads, cancel, interrupted, one_by_one);
}

template <class F>
bool render_with(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  if constexpr (!F::secondary && !F::channels) {
    if (packets::suit(world, out)) return render_in_packets<F>(world, samples, out, threads, cancel, interrupted);
  }
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    OneByOne<F> single(world, samples, out);
    for (std::size_t i = begin; i < end; ++i) {
      if (!single.render(i, stopped)) return;
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
