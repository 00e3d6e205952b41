// Model raytraced: what is seen, mirrored and refracted, to the recursion limit.
#include <memory>

#include "kernels.h"
#include "packets/render_packets.h"
#include "path_sample.h"
#include "precision.h"

namespace equilux {
namespace {

// What the exact search finds.
struct Searched {
  const World& world;
  const Samples& samples;
  std::size_t i;

  bool operator()(Search& search, SurfacePoint& point) const {
    double x, y;
    samples.position(i, x, y);
    return Exact::find(world, search, x, y, point);
  }
};

// Where no ray is followed further and only radiance is asked for, packets do what is plain.
template <class F>
bool render_in_packets(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                       const Interrupted& interrupted) {
  const auto one_by_one = [&] {
    return packets::Sampler([&, single = std::make_shared<OneByOne<F>>(world, out)](std::size_t i, const Primitive&) {
      single->render(i, Searched{world, samples, i}, {});
    });
  };
  return packets::render(world, samples, out, nullptr, threads, cancel, interrupted, one_by_one);
}

template <class F>
bool render_with(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  if constexpr (!F::secondary && !F::channels) {
    if (packets::suit(world, out)) return render_in_packets<F>(world, samples, out, threads, cancel, interrupted);
  }
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    OneByOne<F> single(world, out);
    for (std::size_t i = begin; i < end; ++i) {
      if (!single.render(i, Searched{world, samples, i}, stopped)) return;
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
