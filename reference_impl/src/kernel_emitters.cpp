// Model reflection-equation: direct light of emitters that have an extent, of the environment and of delta lights, with what stands between.
//
//     L(V) = K_emit + Σ_i E_i f_r cosθ_i [N·L_i > 0, visible] + Σ_emitters L_e ∫ f_r cosθ dω over what is seen of them
//
// The integrals are direct_light.h's. Their error is a channel of its own, `quadrature`; `rounding` holds the delta lights' arithmetic and
// that of the final sum.
#include "direct_light.h"
#include "first_surface.h"
#include "kernels.h"
#include "ruled_emitters.h"
#include "stated.h"
#include "transport.h"

namespace equilux {
namespace {

template <bool TermChannels, bool ChangedRules> struct Compiled {
  using Precision = Exact;
  static constexpr bool channels = TermChannels, ruled = ChangedRules;
};

// One per thread.
struct Shading {
  const World& world;
  const Outputs& out;
  DirectLight direct;
  ShadowRays shadows;
};

// What one delta light may add to the error, lit or not, in units of Rounding::unit; as for model phong.
template <class F>
Bands rounding_of_light(const World& world, const SurfacePoint& point, const Light& light, const Arriving& arriving,
                        const MaterialDescription& material) {
  if (!arriving.in_cone) return {};
  const double spot = light.given.kind == LightKind::spot ? Rounding::cone(light.given.exponent) : 0;
  const double cosine = material.brdf == Brdf::phong_cosine || F::ruled ? Rounding::diffuse : 0;  // a rule may add one
  const Bands specular = specular_coefficient(material);
  const Bands local = material.diffuse * Rounding::diffuse + specular * (Rounding::lobe(material.exponent) + cosine);
  const Bands reflected = material.diffuse + specular;
  const Bands shading = light.given.strength * (local * arriving.share + reflected * (spot * arriving.attenuated));
  return completed(shading, light, arriving, reflected, moved_by_camera(world, point));
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

bool is_visible(Shading& shading, const Light& light, const SurfacePoint& point, const Arriving& arriving) {
  const bool at_infinity = light.given.kind == LightKind::directional;
  const Vec3dd direction = at_infinity ? arriving.toward : unit(arriving.toward);
  const double distance = at_infinity ? std::numeric_limits<double>::infinity() : arriving.distance;
  return shading.shadows.shadow(leaving(shading.world, point, direction), distance).share.any();
}

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
    visible = is_visible(shading, light, point, arriving);
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
    sums.rounding = sums.rounding + rounding_of_light<F>(world, point, light, arriving, material);
    signature.add_light(in_front, arriving.in_cone, mirrored && material.exponent < 1);
    signature.add(visible ? 1 : 0);
  }
}

// What one light does at one place, under changed rules.
struct LightTerms {
  Bands diffuse, specular, rounding, quadrature;
};

template <class F>
LightTerms ruled_delta_light(Shading& shading, const Formula& formula, const SurfacePoint& place, const MaterialDescription& material,
                             std::size_t k, Signature& signature) {
  const Light& light = shading.world.lights[k];
  const RuledLight lit = ruled_light(formula, light, place, {});
  const bool counts = lit.shares.diffuse > 0 || lit.shares.specular > 0;
  const bool visible = counts && ruled_visibility(shading.shadows, shading.world, light, place, lit.arriving);
  LightTerms terms;
  if (visible) {
    const Bands irradiance = light.given.strength * lit.arriving.share;
    terms.diffuse = irradiance * material.diffuse * lit.shares.diffuse;
    terms.specular = irradiance * specular_coefficient(material) * lit.shares.specular;
  }
  if constexpr (F::channels) {
    terms.rounding = rounding_of_light<F>(shading.world, place, light, lit.arriving, material);
    signature.add_light(lit.gate(formula.rules), lit.arriving.in_cone, lit.shares.highlit && material.exponent < 1);
    signature.add(visible ? 1 : 0);
  }
  return terms;
}

LightTerms ruled_emitter(Shading& shading, const SurfacePoint& place, const MaterialDescription& material, int emitter) {
  const World& world = shading.world;
  const Rules& rules = world.description.rules;
  const Bands emitted = emitter < 0 ? world.description.background : world.description.emitters[static_cast<std::size_t>(emitter)].radiance;
  const Bands diffuse = emitted * material.diffuse, specular = emitted * specular_coefficient(material);
  const Reflecting at = ruled_reflecting(rules, shaded_point(place), to_double(place.to_viewer), material);
  const Terms weight{largest(diffuse), largest(specular)};
  const Integral seen = ruled_integral(shading.direct, emitter, rules, at, weight, world.description.error_target);
  return {diffuse * seen.value.diffuse, specular * seen.value.specular, {}, diffuse * seen.error.diffuse + specular * seen.error.specular};
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

// Delta lights, emitters and environment under changed rules, at each of the lit places.
template <class F>
void add_ruled_lights(Shading& shading, const SurfacePoint& point, const MaterialDescription& material, std::size_t first,
                      Signature& signature, Sums& sums) {
  const World& world = shading.world;
  const Outputs& out = shading.out;
  const std::size_t deltas = world.lights.size(), emitters = world.description.emitters.size();
  const Formula formula(world, material);
  LitPlaces places;
  find_lit_places(world, point, true, places);
  signature.add_normal(point);
  for (std::size_t k = 0; k < world.light_count(); ++k) {
    Bands diffuse, specular;
    for (int j = 0; j < places.count; ++j) {
      const SurfacePoint& place = places.at[j];
      const LightTerms terms = k < deltas ? ruled_delta_light<F>(shading, formula, place, material, k, signature)
                                          : ruled_emitter(shading, place, material, k < deltas + emitters ? static_cast<int>(k - deltas) : -1);
      diffuse = diffuse + terms.diffuse * places.weight[j];
      specular = specular + terms.specular * places.weight[j];
      sums.rounding = sums.rounding + terms.rounding * places.weight[j];
      sums.quadrature = sums.quadrature + terms.quadrature * places.weight[j];
    }
    sums.radiance = sums.radiance + (diffuse + specular);
    if constexpr (F::channels) {
      if (out.diffuse) write(out.diffuse, first + k, diffuse);
      if (out.specular) write(out.specular, first + k, specular);
    }
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
  shading.shadows.undecided() = false;
  const bool reflects = material.diffuse.any() || specular_coefficient(material).any();
  if constexpr (F::channels) {
    for (std::size_t k = 0; k < lights; ++k) write_light(out, first + k, {}, {}, {});
  }
  if (reflects && F::ruled) {
    if constexpr (F::ruled) add_ruled_lights<F>(shading, point, material, first, signature, sums);
  } else if (reflects) {
    for (std::size_t k = 0; k < deltas; ++k) add_delta_light<F>(shading, point, material, k, first + k, signature, sums);
    const Reflecting at = reflecting_at(point, material);
    const std::size_t emitters = world.description.emitters.size();
    for (std::size_t k = 0; k < emitters; ++k) add_emitter<F>(shading, at, material, static_cast<int>(k), first + deltas + k, sums);
    if (world.description.has_environment) add_emitter<F>(shading, at, material, -1, first + deltas + emitters, sums);
  }
  sums.radiance = shown(sums.radiance);
  if (out.radiance) write(out.radiance, i, sums.radiance);
  if constexpr (F::channels) {
    const Bands rounding = sums.rounding + sums.radiance * (2 * static_cast<double>(lights) + 6);
    const Bands error = stated(rounding, sums.radiance, point.undecided || shading.shadows.undecided());
    write_surface(world, point, out, i, emission, {}, error, signature);
    if (out.quadrature) write(out.quadrature, i, sums.quadrature);
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
        if constexpr (F::ruled) turn_normal(world.description.rules, point);
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
  const bool ruled = world.description.rules.changed(), channels = !outputs.only_radiance();
  const auto kernel = ruled ? (channels ? render_with<Compiled<true, true>> : render_with<Compiled<false, true>>)
                            : (channels ? render_with<Compiled<true, false>> : render_with<Compiled<false, false>>);
  return kernel(world, samples, outputs, threads, cancel, interrupted);
}

}  // namespace equilux
