// Models phong and opengl under changed rules. What they have in common: of a light in model phong the ambient share is 0, the others 1.
#include "first_surface.h"
#include "kernels.h"
#include "ruled_light.h"
#include "stated.h"

namespace equilux {
namespace {

template <bool TermChannels> struct Compiled {
  using Precision = Exact;
  static constexpr bool channels = TermChannels;
};

// What one light may add to the error, in units of Rounding::unit: opengl.h's bound with the factor |N·L| that a rule may add to the
// highlight.
Bands rounding_of_light(const Light& light, const Arriving& arriving, const MaterialDescription& material, const Moved& moved) {
  if (!arriving.in_cone) return {};
  const LightDescription& given = light.given;
  const double spot = given.kind == LightKind::spot ? Rounding::cone(given.exponent) : 0;
  const Bands ambient = material.ambient * given.ambient, diffuse = material.diffuse * given.diffuse,
              specular = material.specular * given.specular;
  const Bands local = ambient * OpenglRounding::ambient + diffuse * OpenglRounding::diffuse +
                      specular * (OpenglRounding::lobe(material.exponent) + Rounding::diffuse);
  const Bands reflected = ambient + diffuse + specular;
  const Bands shading = given.strength * (local * arriving.share + reflected * (spot * arriving.attenuated));
  return completed(shading, light, arriving, reflected, moved);
}

template <class F> void shade(const World& world, SurfacePoint point, const Outputs& out, std::size_t i) {
  const Rules& rules = world.description.rules;
  const MaterialDescription& material = material_of(world, point.object);
  const Formula formula(world, material);
  turn_normal(rules, point);
  LitPlaces places;
  find_lit_places(world, point, true, places);
  const Bands global = material.ambient * world.description.ambient;
  Bands radiance = material.emission + global;
  Bands rounding;
  Moved moved;
  if constexpr (F::channels) moved = moved_by_camera(world, point);
  Signature signature(point);
  signature.add_normal(point);
  const std::size_t lights = world.lights.size();

  for (std::size_t k = 0; k < lights; ++k) {
    const Light& light = world.lights[k];
    Bands ambient, diffuse, specular;
    for (int j = 0; j < places.count; ++j) {
      const RuledLight lit = ruled_light(formula, light, places.at[j], {});
      const Bands irradiance = light.given.strength * (lit.arriving.share * places.weight[j]);
      ambient = ambient + irradiance * light.given.ambient * material.ambient;
      diffuse = diffuse + irradiance * light.given.diffuse * material.diffuse * lit.shares.diffuse;
      specular = specular + irradiance * light.given.specular * material.specular * lit.shares.specular;
      if constexpr (F::channels) {
        rounding = rounding + rounding_of_light(light, lit.arriving, material, moved) * std::fabs(places.weight[j]);
        signature.add_light(lit.gate(rules), lit.arriving.in_cone, lit.shares.highlit && material.exponent < 1);
      }
    }
    radiance = radiance + (ambient + diffuse + specular);
    if constexpr (F::channels) {
      write_light(out, i * lights + k, ambient, diffuse, specular);
    }
  }
  radiance = shown(radiance);
  if (out.radiance) write(out.radiance, i, radiance);
  if constexpr (F::channels) {
    const Bands error = stated(rounding + radiance * (3 * static_cast<double>(lights) + 4), radiance, point.undecided);
    write_surface(world, point, out, i, material.emission, global, error, signature);
  }
}

template <class F>
bool render_with(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  return render_first_surface<F>(world, samples, out, threads, cancel, interrupted,
                                 [&](const SurfacePoint& point, std::size_t i) { shade<F>(world, point, out, i); });
}

}  // namespace

bool render_ruled(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                  const Interrupted& interrupted) {
  const auto kernel = outputs.only_radiance() ? render_with<Compiled<false>> : render_with<Compiled<true>>;
  return kernel(world, samples, outputs, threads, cancel, interrupted);
}

}  // namespace equilux
