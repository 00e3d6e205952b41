// Refined precision: float packets say which primitive each eye ray meets first; its crossing, and all that follows from there, is that of
// the exact mode. Model phong is model raytraced without shadows and secondary rays, so that one kernel does for both.
#include "../path.h"
#include "float_mode.h"
#include "flushed.h"

namespace equilux::fast {
namespace {

// The point where the ray meets what the packet found; where it does not, the exact search's. False: a miss.
bool refined_point(const World& world, const FloatScene::Found& found, Search& search, double x, double y, SurfacePoint& point) {
  if (found.object < 0) return false;
  search.film_ray = world.camera.ray(x, y);
  search.triangle_ray = {search.film_ray.x_rounded, search.film_ray.y_rounded, world.camera.perspective()};
  search.undecided = false;
  search.candidates.clear(0);
  if (found.mesh >= 0) {
    try_triangle(search, found.mesh, found.triangle);
  } else {
    try_object(search, found.object);
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

template <class F> void write_refined(Tracing& tracing, const SurfacePoint& point, std::size_t i) {
  const Bands radiance = shown(tracing.radiance);
  if (tracing.out.radiance) write(tracing.out.radiance, i, radiance);
  if constexpr (F::channels) {
    const Bands rounding = tracing.rounding + radiance * static_cast<double>(tracing.terms);
    if (tracing.out.rounding) write(tracing.out.rounding, i, stated(rounding, radiance, point.undecided || tracing.undecided()));
  }
}

struct Primitives {
  std::vector<std::int32_t> geometry, primitive;
};

template <class F>
bool refine_with(const FloatScene& scene, const Primitives& found, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  const World& world = scene.world();
  const Samples samples{nullptr, found.geometry.size(), world.description.width};
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    Search search;
    search.world = &world;
    SurfacePoint point;
    Tracing tracing(world, out);
    for (std::size_t i = begin; i < end; ++i) {
      double x, y;
      samples.position(i, x, y);
      if (!refined_point(world, scene.found(found.geometry[i], found.primitive[i]), search, x, y, point)) {
        write_miss<F>(world, out, i);
        continue;
      }
      tracing.begin();
      shade<F>(tracing, {point, material_of(world, point.object), {1, 1, 1}, 0, Branch::none, i, {}, {}});
      if constexpr (F::secondary) {
        if (!follow_all<F>(tracing, i, stopped)) return;
      }
      write_refined<F>(tracing, point, i);
    }
  });
}

using RefineFunction = bool (*)(const FloatScene&, const Primitives&, const Outputs&, int, const Cancel*, const Interrupted&);

template <bool Channels> RefineFunction choose(const World& world) {
  if (world.description.model == Model::phong) return refine_with<PathFeatures<false, false, false, Channels>>;
  if (world.features.transparency) return refine_with<PathFeatures<true, true, true, Channels>>;
  if (world.features.reflection) return refine_with<PathFeatures<true, true, false, Channels>>;
  if (world.features.occlusion) return refine_with<PathFeatures<true, false, false, Channels>>;
  return refine_with<PathFeatures<false, false, false, Channels>>;
}

}  // namespace

bool FloatMode::refine(double* radiance, double* rounding, int threads, const Cancel* cancel, const Interrupted& interrupted) const {
  const Tables& tables = scene_.tables();
  const Kernels& kernels = scene_.kernels();
  Primitives found{std::vector<std::int32_t>(pixels()), std::vector<std::int32_t>(pixels())};
  const bool complete = for_each_chunk(kernels.block_count(tables), threads, cancel, interrupted, [&](std::size_t begin, std::size_t end) {
    const FlushedToZero flushed;
    kernels.find(tables, begin, end, found.geometry.data(), found.primitive.data());
  });
  if (!complete) return false;
  Outputs out;
  out.radiance = radiance;
  out.rounding = rounding;
  const RefineFunction kernel = rounding != nullptr ? choose<true>(scene_.world()) : choose<false>(scene_.world());
  return kernel(scene_, found, out, threads, cancel, interrupted);
}

}  // namespace equilux::fast
