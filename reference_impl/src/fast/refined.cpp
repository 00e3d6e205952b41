// Refined precision: float packets say which primitive each eye ray meets first; its crossing, and all that follows from there, is that of
// the exact mode. Model phong is model raytraced without shadows and secondary rays, so that one kernel does for both. Where nothing but
// radiance is asked for, the exact mode's packets do what is plain; block by block, so that what was found is still in the cache.
#include <algorithm>
#include <memory>
#include <vector>

#include "../blocks.h"
#include "../packets/render_packets.h"
#include "../path_sample.h"
#include "float_mode.h"
#include "flushed.h"

namespace equilux::fast {
namespace {

// The point where the ray meets what the packet found; where it does not, the exact search's. False: a miss.
bool refined_point(const World& world, const Primitive& met, Search& search, double x, double y, SurfacePoint& point) {
  if (met.object < 0) return false;
  search.film_ray = world.camera.ray(x, y);
  search.triangle_ray = {search.film_ray.x_rounded, search.film_ray.y_rounded, world.camera.perspective()};
  search.undecided = false;
  search.candidates.clear(0);
  if (met.mesh >= 0) {
    try_triangle(search, met.mesh, met.triangle);
  } else {
    try_object(search, met.object);
  }
  Candidate hit;
  if (!search.candidates.found().empty()) {
    hit = search.candidates.found().front();
  } else if (!nearest_crossing(search, hit)) {
    return false;
  }
  point = surface_point(world, search.film_ray, hit);
  point.undecided = search.undecided;
  return true;
}

// The same, of one sample.
struct Refined {
  const World& world;
  const Samples& samples;
  std::size_t i;
  const Primitive& met;

  bool operator()(Search& search, SurfacePoint& point) const {
    double x, y;
    samples.position(i, x, y);
    return refined_point(world, met, search, x, y, point);
  }
};

template <class F>
bool refine_in_packets(const World& world, const packets::Finder& finder, const Samples& samples, const Outputs& out, int threads,
                       const Cancel* cancel, const Interrupted& interrupted) {
  const auto one_by_one = [&] {
    return packets::Sampler([&, single = std::make_shared<OneByOne<F>>(world, out)](std::size_t i, const Primitive& met) {
      single->render(i, Refined{world, samples, i, met}, {});
    });
  };
  return packets::render(world, samples, out, &finder, threads, cancel, interrupted, one_by_one);
}

template <class F>
bool refine_with(const World& world, const packets::Finder& finder, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  const int width = world.description.width, height = world.description.height, lanes = finder.lanes;
  const Samples samples{nullptr, static_cast<std::size_t>(width) * static_cast<std::size_t>(height), width};
  if constexpr (!F::secondary && !F::channels) {
    if (packets::suit(world, out) && packets::widest(lanes) == lanes) {
      return refine_in_packets<F>(world, finder, samples, out, threads, cancel, interrupted);
    }
  }
  const std::size_t per_block = static_cast<std::size_t>(lanes), count = block_count(lanes, width, height) * per_block;
  return for_each_chunk(count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    std::vector<Primitive> met(end - begin);
    finder.find(begin / per_block, end / per_block, met.data());  // chunks are whole blocks
    OneByOne<F> single(world, out);
    for (std::size_t i = begin; i < end; ++i) {
      const PixelAt at = pixel_of_lane(lanes, block_at(lanes, width, i / per_block), static_cast<int>(i % per_block));
      if (at.column >= width || at.row >= height) continue;
      const std::size_t sample = static_cast<std::size_t>(at.row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(at.column);
      if (!single.render(sample, Refined{world, samples, sample, met[i - begin]}, stopped)) return;
    }
  });
}

using RefineFunction = bool (*)(const World&, const packets::Finder&, const Outputs&, int, const Cancel*, const Interrupted&);

template <bool Channels> RefineFunction choose(const World& world) {
  if (world.description.model == Model::phong) return refine_with<PathFeatures<false, false, false, Channels>>;
  if (world.features.transparency) return refine_with<PathFeatures<true, true, true, Channels>>;
  if (world.features.reflection) return refine_with<PathFeatures<true, true, false, Channels>>;
  if (world.features.occlusion) return refine_with<PathFeatures<true, false, false, Channels>>;
  return refine_with<PathFeatures<false, false, false, Channels>>;
}

// Whether exact packets find a scene's surfaces in less time than Embree's float traversal, which is the faster one for meshes, boxes and
// cylinders alone. Then the picture is the exact one, whatever else is asked for.
bool exact_is_faster(const World& world) {
  const auto crossed_by_packets = [&](int object) {
    const Solid solid = world.objects[static_cast<std::size_t>(object)].solid;
    return solid == Solid::sphere || solid == Solid::disc || solid == Solid::rectangle;
  };
  return packets::know(world) && std::any_of(world.bounded.begin(), world.bounded.end(), crossed_by_packets);
}

}  // namespace

bool FloatMode::refine(double* radiance, double* rounding, int threads, const Cancel* cancel, const Interrupted& interrupted) const {
  const World& world = scene_.world();
  Outputs out;
  out.radiance = radiance;
  out.rounding = rounding;
  if (exact_is_faster(world)) return equilux::render(world, {nullptr, pixels(), world.description.width}, out, threads, cancel, interrupted);
  const Tables& tables = scene_.tables();
  const Kernels& kernels = scene_.kernels();
  const packets::Finder finder{kernels.width, [&](std::size_t begin, std::size_t end, Primitive* met) {
                                 const FlushedToZero flushed;
                                 kernels.find(tables, begin, end, met);
                               }};
  const RefineFunction kernel = rounding != nullptr ? choose<true>(world) : choose<false>(world);
  return kernel(world, finder, out, threads, cancel, interrupted);
}

}  // namespace equilux::fast
