// Model reflection-equation: direct light of emitters that have an extent, of the environment and of delta lights, with what stands between.
//
//     L(V) = K_emit + Σ_i E_i f_r cosθ_i [N·L_i > 0, visible] + Σ_emitters L_e ∫ f_r cosθ dω over what is seen of them
//
// The integrals are direct_light.h's. Their error is a channel of its own, `quadrature`; `rounding` holds the delta lights' arithmetic and
// that of the final sum.
#include "direct_light.h"
#include "first_surface.h"
#include "kernels.h"
#include "phong.h"
#include "transport.h"

namespace equilux {
namespace {

template <bool TermChannels> struct Compiled {
  using Precision = Exact;
  static constexpr bool channels = TermChannels;
};

// One per thread.
struct Shading {
  const World& world;
  const Outputs& out;
  DirectLight direct;
  ShadowRays shadows;
};

Bands specular_coefficient(const MaterialDescription& material) {
  return material.brdf == Brdf::lambert ? Bands{} : material.specular;
}

// What one delta light may add to the error, lit or not, in units of Rounding::unit; as for model phong.
Bands rounding_of_light(const Light& light, const Arriving& arriving, const MaterialDescription& material) {
  if (!arriving.in_cone) return {};
  const double spot = light.given.kind == LightKind::spot ? Rounding::cone(light.given.exponent) : 0;
  const double cosine = material.brdf == Brdf::phong_cosine ? Rounding::diffuse : 0;
  const Bands specular = specular_coefficient(material);
  const Bands local = material.diffuse * Rounding::diffuse + specular * (Rounding::lobe(material.exponent) + cosine);
  return light.given.strength * (local * arriving.share + (material.diffuse + specular) * (spot * arriving.attenuated));
}

Reflecting reflecting_at(const SurfacePoint& point, const MaterialDescription& material) {
  Reflecting at;
  const Vec3d normal = to_double(point.normal);
  at.point = {point.position, normal, point.object, point.outside};
  at.specular = specular_coefficient(material).any();
  if (at.specular) {
    const Vec3dd mirrored = point.normal * (dot(point.normal, point.to_viewer) * 2.0) - point.to_viewer;
    at.lobe = Lobe(to_double(unit(mirrored)), normal, material.exponent, material.brdf == Brdf::phong_cosine);
  }
  return at;
}

struct Sums {
  Bands radiance, rounding, quadrature;
};

template <class F>
void add_delta_light(Shading& shading, const SurfacePoint& point, const MaterialDescription& material, std::size_t k, std::size_t slot,
                     Signature& signature, Sums& sums) {
  const World& world = shading.world;
  const Outputs& out = shading.out;
  const Light& light = world.lights[k];
  const Vec3d normal = to_double(point.normal);
  const Arriving arriving = arriving_light<true>(light, point);
  const double cosine = cosine_to_light(point, normal, arriving);
  const bool in_front = cosine > 0;
  bool visible = false, mirrored = false;
  Bands diffuse, specular;
  if (in_front && arriving.in_cone) {
    const bool at_infinity = light.given.kind == LightKind::directional;
    const Vec3dd direction = at_infinity ? arriving.toward : unit(arriving.toward);
    const double distance = at_infinity ? std::numeric_limits<double>::infinity() : arriving.distance;
    visible = shading.shadows.shadow(leaving(world, point, direction), distance).share.any();
  }
  if (visible) {
    const Bands irradiance = light.given.strength * arriving.share;
    diffuse = irradiance * material.diffuse * cosine;
    const Bands coefficient = specular_coefficient(material);
    if (coefficient.any()) {
      const double lobe = highlight(point, normal, to_double(point.to_viewer), arriving, cosine, material.exponent);
      specular = irradiance * coefficient * (material.brdf == Brdf::phong_cosine ? lobe * cosine : lobe);
      mirrored = lobe > 0;
    }
  }
  sums.radiance = sums.radiance + (diffuse + specular);
  if constexpr (F::channels) {
    if (out.diffuse) write(out.diffuse, slot, diffuse);
    if (out.specular) write(out.specular, slot, specular);
    sums.rounding = sums.rounding + rounding_of_light(light, arriving, material);
    signature.add_light(in_front, arriving.in_cone, mirrored && material.exponent < 1);
    signature.add(visible ? 1 : 0);
  }
}

template <class F>
void add_emitter(Shading& shading, const Reflecting& at, const MaterialDescription& material, int emitter, std::size_t slot, Sums& sums) {
  const World& world = shading.world;
  const Outputs& out = shading.out;
  const Bands emitted = emitter < 0 ? world.description.background : world.description.emitters[static_cast<std::size_t>(emitter)].radiance;
  const Bands diffuse = emitted * material.diffuse, specular = emitted * specular_coefficient(material);
  const Integral seen = shading.direct.from(emitter, at, {largest(diffuse), largest(specular)}, world.description.error_target);
  sums.radiance = sums.radiance + (diffuse * seen.value.diffuse + specular * seen.value.specular);
  if constexpr (F::channels) {
    if (out.diffuse) write(out.diffuse, slot, diffuse * seen.value.diffuse);
    if (out.specular) write(out.specular, slot, specular * seen.value.specular);
    sums.quadrature = sums.quadrature + diffuse * seen.error.diffuse + specular * seen.error.specular;
  }
}

template <class F> void shade(Shading& shading, const SurfacePoint& point, std::size_t i) {
  const World& world = shading.world;
  const Outputs& out = shading.out;
  const MaterialDescription& material = material_of(world, point.object);
  const bool emitter = point.object >= world.first_emitter();
  // Disc and rectangle shine on their normal's side, a sphere outward: all where the viewer is outside.
  const Bands emission = emitter && !point.outside ? Bands{} : material.emission;
  Signature signature(point);
  Sums sums;
  sums.radiance = emission;
  const std::size_t deltas = world.lights.size(), lights = world.light_count(), first = i * lights;
  const bool reflects = material.diffuse.any() || specular_coefficient(material).any();
  if constexpr (F::channels) {
    for (std::size_t k = 0; k < lights; ++k) {
      if (out.light_ambient) write(out.light_ambient, first + k, Bands{});
      if (out.diffuse) write(out.diffuse, first + k, Bands{});
      if (out.specular) write(out.specular, first + k, Bands{});
    }
  }
  if (reflects) {
    for (std::size_t k = 0; k < deltas; ++k) add_delta_light<F>(shading, point, material, k, first + k, signature, sums);
    const Reflecting at = reflecting_at(point, material);
    const std::size_t emitters = world.description.emitters.size();
    for (std::size_t k = 0; k < emitters; ++k) add_emitter<F>(shading, at, material, static_cast<int>(k), first + deltas + k, sums);
    if (world.description.has_environment) add_emitter<F>(shading, at, material, -1, first + deltas + emitters, sums);
  }
  if (out.radiance) write(out.radiance, i, sums.radiance);
  if constexpr (F::channels) {
    if (out.emission) write(out.emission, i, emission);
    if (out.ambient) write(out.ambient, i, Bands{});
    if (out.rounding) write(out.rounding, i, (sums.rounding + sums.radiance * (2 * static_cast<double>(lights) + 6)) * Rounding::unit);
    if (out.quadrature) write(out.quadrature, i, sums.quadrature);
    if (out.signature) out.signature[i] = signature.value();
    write_no_secondary(out, i);
    write_geometry(world, point, out, i);
  }
}

template <class F>
bool render_with(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  const Obstacles obstacles(world);
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    Search search;
    search.world = &world;
    SurfacePoint point;
    Shading shading{world, out, DirectLight(obstacles), ShadowRays(world)};
    for (std::size_t i = begin; i < end && !stopped(); ++i) {
      double x, y;
      samples.position(i, x, y);
      if (Exact::find(world, search, x, y, point)) {
        shade<F>(shading, point, i);
      } else {
        write_miss<F>(world, out, i);
      }
    }
  });
}

}  // namespace

bool render_emitters(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                     const Interrupted& interrupted) {
  const auto kernel = outputs.only_radiance() ? render_with<Compiled<false>> : render_with<Compiled<true>>;
  return kernel(world, samples, outputs, threads, cancel, interrupted);
}

}  // namespace equilux
