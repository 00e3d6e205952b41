// Model raytraced: what is seen, mirrored and refracted, to the recursion limit.
//
// Secondary rays wait on a stack of their own, so that no recursion limit can exhaust the thread's: where each hit sends one, it never
// holds more than one; where each sends two, as many as the limit.
#include "kernels.h"
#include "outputs.h"
#include "precision.h"
#include "raytraced.h"

namespace equilux {
namespace {

// What the kernel is compiled for. Anything that is false here leaves no code behind. Of the combinations that scenes ask for, four are
// compiled (twice, with and without channels): nothing but the lights; with shadows; with mirrors too; with everything. A scene gets the
// least one that has all it needs.
template <bool Shadows, bool Mirrors, bool Glass, bool TermChannels>
struct Compiled {
  static constexpr bool occlusion = Shadows, reflection = Mirrors, transparency = Glass, channels = TermChannels;
  static constexpr bool secondary = Mirrors || Glass;
};

// How the first surface sent the ray whose contribution is being summed up.
enum class Branch { none, reflected, transmitted };

// A ray to be followed, and what its radiance counts.
struct Pending {
  Ray ray;
  Bands weight;
  int used = 0;  // of the recursion limit, this ray included
  Branch branch = Branch::none;
};

// What one thread has to itself. The sums are one sample's.
struct Tracing {
  const World& world;
  const Outputs& out;
  Traversal traversal;
  ShadowRays shadows;
  std::vector<Pending> pending;
  Bands radiance, reflected, transmitted, rounding;
  Signature signature;
  int hits = 0;

  Tracing(const World& world, const Outputs& out) : world(world), out(out), traversal(world), shadows(world) {}

  void begin() {
    radiance = reflected = transmitted = rounding = {};
    signature = {};
    hits = 0;
    pending.clear();
  }

  void add(const Bands& light, Branch branch) {
    radiance = radiance + light;
    if (branch == Branch::reflected) reflected = reflected + light;
    if (branch == Branch::transmitted) transmitted = transmitted + light;
  }
};

// A surface point on a path: the sample it belongs to, what its radiance counts, and how often the path has turned.
struct Visit {
  const SurfacePoint& point;
  const MaterialDescription& material;
  Bands weight{1, 1, 1};
  int used = 0;
  Branch branch = Branch::none;
  std::size_t sample = 0;
};

constexpr double infinity = std::numeric_limits<double>::infinity();

Shadow shadow_of(Tracing& tracing, const Light& light, const SurfacePoint& point, const Arriving& arriving) {
  const bool at_infinity = light.given.kind == LightKind::directional;
  const Vec3dd direction = at_infinity ? light.to_light : unit(arriving.toward);
  return tracing.shadows.shadow(leaving(tracing.world, point, direction), at_infinity ? infinity : arriving.distance);
}

// What one light may add to the error, in units of Rounding::unit.
Bands rounding_of_light(const Light& light, const Arriving& arriving, const MaterialDescription& material, double side,
                        const Shadow& shadow) {
  const double spot = light.given.kind == LightKind::spot ? Rounding::cone(light.given.exponent) : 0;
  const double factors = 2 * shadow.crossings + 2;
  const Bands reflected = material.diffuse + material.specular;
  const Bands local = material.diffuse * (Rounding::diffuse + factors) + material.specular * (Rounding::lobe(material.exponent) + factors);
  return light.given.strength * shadow.share * (local * arriving.share + reflected * (spot * arriving.attenuated)) * side;
}

// The local terms: emission, ambient, and the lights on both sides. Returns them, not weighted.
template <class F> Bands local_terms(Tracing& tracing, const Visit& visit, Bands& rounding) {
  const World& world = tracing.world;
  const SurfacePoint& point = visit.point;
  const MaterialDescription& material = visit.material;
  const Vec3d normal = to_double(point.normal), to_viewer = to_double(point.to_viewer);
  const std::size_t lights = world.lights.size();
  const bool shines = material.diffuse.any() || material.specular.any();
  Bands sum = material.emission + material.ambient * world.description.ambient;

  for (std::size_t k = 0; k < lights; ++k) {
    // 1. What arrives, from which side, and how much that side counts
    const Arriving arriving = arriving_light<true>(world.lights[k], point);
    const double cosine = cosine_to_light(point, normal, arriving);
    double side = cosine > 0 ? 1 : 0;
    if constexpr (F::transparency) side = cosine > 0 ? 1 - material.transparency : cosine < 0 ? material.transparency : 0;
    const bool counts = side > 0 && arriving.in_cone && shines;

    // 2. The two terms
    Bands diffuse, specular;
    Shadow shadow;
    bool lobe_shines = false, total = false;
    if (counts) {
      if constexpr (F::occlusion) shadow = shadow_of(tracing, world.lights[k], point, arriving);
      const Bands irradiance = world.lights[k].given.strength * arriving.share * shadow.share * side;
      diffuse = irradiance * material.diffuse * std::fabs(cosine);
      if (material.specular.any() && irradiance.any()) {
        double lobe = 0;
        if (cosine > 0) {
          lobe = highlight(point, normal, to_viewer, arriving, cosine, material.exponent);
        } else {
          lobe = transmitted_highlight(point, to_viewer, arriving, material, total);
        }
        specular = irradiance * material.specular * lobe;
        lobe_shines = lobe > 0;
      }
    }
    sum = sum + (diffuse + specular);

    // 3. Channels
    if constexpr (F::channels) {
      if (visit.used == 0) {
        if (tracing.out.diffuse) write(tracing.out.diffuse, visit.sample * lights + k, diffuse);
        if (tracing.out.specular) write(tracing.out.specular, visit.sample * lights + k, specular);
      }
      if (counts) rounding = rounding + rounding_of_light(world.lights[k], arriving, material, side, shadow);
      tracing.signature.add_light(cosine > 0, arriving.in_cone, lobe_shines && material.exponent < 1);
      if (counts) tracing.signature.add(shadow.crossed * 2 + (total ? 1 : 0));
    }
  }
  return sum;
}

// Puts the secondary rays of a visit on the stack.
template <class F> void send_secondary(Tracing& tracing, const Visit& visit) {
  const SurfacePoint& point = visit.point;
  const MaterialDescription& material = visit.material;
  if (visit.used >= tracing.world.description.recursion_limit) return;
  const auto send = [&](const Vec3dd& direction, const Bands& weight, Branch branch) {
    if (!weight.any()) return;
    tracing.pending.push_back({leaving(tracing.world, point, direction), weight, visit.used + 1,
                               visit.branch == Branch::none ? branch : visit.branch});
  };
  if constexpr (F::transparency) {
    if (material.transparency > 0) {
      Vec3dd onward;
      double cosine;
      const bool total = !refracted(-point.to_viewer, point.normal, index_in_front(point, material), index_behind(point, material),
                                    onward, cosine);
      if constexpr (F::channels) tracing.signature.add(total ? 3 : 4);
      if (total) {
        send(mirrored_about(point.normal, point.to_viewer), visit.weight, Branch::reflected);
        return;
      }
      send(onward, visit.weight * (material.transmission * material.transparency), Branch::transmitted);
    }
  }
  send(mirrored_about(point.normal, point.to_viewer), visit.weight * (material.reflection * (1 - material.transparency)),
       Branch::reflected);
}

template <class F> void shade(Tracing& tracing, const Visit& visit) {
  if constexpr (F::channels) tracing.signature.add_surface(visit.point);
  Bands rounding;
  const Bands local = local_terms<F>(tracing, visit, rounding);
  tracing.add(visit.weight * local, visit.branch);
  if constexpr (F::channels) {
    const double factors = 4 * visit.used + static_cast<double>(tracing.world.lights.size()) + 3;
    tracing.rounding = tracing.rounding + visit.weight * (rounding + local * factors);
    ++tracing.hits;
  }
  if constexpr (F::secondary) send_secondary<F>(tracing, visit);
}

constexpr int rays_between_questions = 1024;  // whether the render has been cancelled

// Follows every ray on the stack to its end. False: cancelled.
template <class F> bool follow_all(Tracing& tracing, std::size_t sample, const Stopped& stopped) {
  int followed = 0;
  while (!tracing.pending.empty()) {
    if (++followed % rays_between_questions == 0 && stopped()) return false;
    const Pending next = tracing.pending.back();
    tracing.pending.pop_back();
    if constexpr (F::channels) tracing.signature.add(static_cast<std::uint64_t>(next.used));
    Candidate hit;
    if (!tracing.traversal.nearest(next.ray, hit)) {
      if constexpr (F::channels) tracing.signature.add(signature_of_a_miss);
      const Bands& background = tracing.world.description.background;
      tracing.add(next.weight * background, next.branch);
      if constexpr (F::channels) tracing.rounding = tracing.rounding + next.weight * background * (4 * next.used + 1.0);
      continue;
    }
    const SurfacePoint point = surface_point(tracing.world, next.ray, hit);
    shade<F>(tracing, {point, material_of(tracing.world, point.object), next.weight, next.used, next.branch, sample});
  }
  return true;
}

template <class F> void write_sample(const Tracing& tracing, const SurfacePoint& point, std::size_t i) {
  const Outputs& out = tracing.out;
  if (out.radiance) write(out.radiance, i, tracing.radiance);
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
    if (out.rounding) write(out.rounding, i, (tracing.rounding + tracing.radiance * static_cast<double>(tracing.hits)) * Rounding::unit);
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
      shade<F>(tracing, {point, material_of(world, point.object), {1, 1, 1}, 0, Branch::none, i});
      if constexpr (F::secondary) {
        if (!follow_all<F>(tracing, i, stopped)) return;
      }
      write_sample<F>(tracing, point, i);
    }
  });
}

using RenderFunction = bool (*)(const World&, const Samples&, const Outputs&, int, const Cancel*, const Interrupted&);

template <bool Channels> RenderFunction choose(const Features& needed) {
  if (needed.transparency) return render_with<Compiled<true, true, true, Channels>>;
  if (needed.reflection) return render_with<Compiled<true, true, false, Channels>>;
  if (needed.occlusion) return render_with<Compiled<true, false, false, Channels>>;
  return render_with<Compiled<false, false, false, Channels>>;
}

}  // namespace

bool render_raytraced(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                      const Interrupted& interrupted) {
  const RenderFunction kernel = outputs.only_radiance() ? choose<false>(world.features) : choose<true>(world.features);
  return kernel(world, samples, outputs, threads, cancel, interrupted);
}

}  // namespace equilux
