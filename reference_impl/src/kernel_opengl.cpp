// Model opengl: the fixed-function rules, at every point.
#include "first_surface.h"
#include "kernels.h"
#include "opengl.h"
#include "stated.h"

namespace equilux {
namespace {

template <bool SpotLights, bool TermChannels>
struct Compiled {
  using Precision = Exact;
  static constexpr bool spot = SpotLights, channels = TermChannels;
};

// What one light may add to the error, in units of Rounding::unit.
Bands rounding_of_light(const Light& light, const Arriving& arriving, const MaterialDescription& material, const Moved& moved) {
  if (!arriving.in_cone) return {};
  const LightDescription& given = light.given;
  const double spot = given.kind == LightKind::spot ? Rounding::cone(given.exponent) : 0;
  const Bands ambient = material.ambient * given.ambient, diffuse = material.diffuse * given.diffuse,
              specular = material.specular * given.specular;
  const Bands local =
      ambient * OpenglRounding::ambient + diffuse * OpenglRounding::diffuse + specular * OpenglRounding::lobe(material.exponent);
  const Bands reflected = ambient + diffuse + specular;
  const Bands shading = given.strength * (local * arriving.share + reflected * (spot * arriving.attenuated));
  return completed(shading, light, arriving, reflected, moved);
}

template <class F> void shade(const World& world, const SurfacePoint& point, const Outputs& out, std::size_t i) {
  const MaterialDescription& material = material_of(world, point.object);
  const Vec3d normal = to_double(point.normal);
  const Vec3dd to_viewer = opengl_viewer(world, point);
  const Bands global = material.ambient * world.description.ambient;
  Bands radiance = material.emission + global;
  Bands rounding;
  Moved moved;
  if constexpr (F::channels) moved = moved_by_camera(world, point);
  Signature signature(point);
  const std::size_t lights = world.lights.size();

  for (std::size_t k = 0; k < lights; ++k) {
    const LightDescription& given = world.lights[k].given;
    const Arriving arriving = arriving_light<F::spot>(world.lights[k], point);
    const double cosine = cosine_to_light(point, normal, arriving);
    const bool in_front = cosine > 0;
    const Bands irradiance = given.strength * arriving.share;  // 0 outside the cone

    const Bands ambient = irradiance * given.ambient * material.ambient;
    Bands diffuse, specular;
    bool highlit = false;
    if (in_front && arriving.in_cone) {
      diffuse = irradiance * given.diffuse * material.diffuse * cosine;
      if (material.specular.any()) {
        const double lobe = half_vector_highlight(point, normal, arriving, to_viewer, material.exponent);
        specular = irradiance * given.specular * material.specular * lobe;
        highlit = lobe > 0;
      }
    }
    radiance = radiance + (ambient + diffuse + specular);

    if constexpr (F::channels) {
      write_light(out, i * lights + k, ambient, diffuse, specular);
      rounding = rounding + rounding_of_light(world.lights[k], arriving, material, moved);
      signature.add_light(in_front, arriving.in_cone, highlit && material.exponent < 1);
    }
  }
  radiance = shown(radiance);
  if (out.radiance) write(out.radiance, i, radiance);
  if constexpr (F::channels) {
    const Bands error = stated(rounding + radiance * (static_cast<double>(lights) + 4), radiance, point.undecided);
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

bool render_opengl(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                   const Interrupted& interrupted) {
  const bool spot = world.features.spot, channels = !outputs.only_radiance();
  const auto kernel = spot ? (channels ? render_with<Compiled<true, true>> : render_with<Compiled<true, false>>)
                           : (channels ? render_with<Compiled<false, true>> : render_with<Compiled<false, false>>);
  return kernel(world, samples, outputs, threads, cancel, interrupted);
}

}  // namespace equilux
