// Model phong: nothing but the first surface and the lights.
#include "first_surface.h"
#include "kernels.h"
#include "packets/render_packets.h"
#include "stated.h"

namespace equilux {
namespace {

// What the kernel is compiled for. Anything that is false here leaves no code behind.
template <class PrecisionPolicy, bool SpecularTerm, bool SpotLights, bool TermChannels>
struct Compiled {
  using Precision = PrecisionPolicy;
  static constexpr bool specular = SpecularTerm, spot = SpotLights, channels = TermChannels;
};

// What one light may add to the error, lit or not, in units of Rounding::unit.
Bands rounding_of_light(const Light& light, const Arriving& arriving, const MaterialDescription& material, const Moved& moved) {
  if (!arriving.in_cone) return {};
  const double spot = light.given.kind == LightKind::spot ? Rounding::cone(light.given.exponent) : 0;
  const Bands reflected = material.diffuse + material.specular;
  const Bands local = material.diffuse * Rounding::diffuse + material.specular * Rounding::lobe(material.exponent);
  const Bands shading = light.given.strength * (local * arriving.share + reflected * (spot * arriving.attenuated));
  return completed(shading, light, arriving, reflected, moved);
}

template <class F> void shade(const World& world, const SurfacePoint& point, const Outputs& out, std::size_t i) {
  const MaterialDescription& material = material_of(world, point.object);
  const Vec3d normal = to_double(point.normal), to_viewer = to_double(point.to_viewer);
  const Bands ambient = material.ambient * world.description.ambient;
  Bands radiance = material.emission + ambient;
  Bands rounding;
  Moved moved;
  if constexpr (F::channels) moved = moved_by_camera(world, point);
  Signature signature(point);
  const std::size_t lights = world.lights.size();

  for (std::size_t k = 0; k < lights; ++k) {
    // 1. What arrives, and whether it arrives from in front
    const Arriving arriving = arriving_light<F::spot>(world.lights[k], point);
    const double cosine = cosine_to_light(point, normal, arriving);
    const bool in_front = cosine > 0;
    const Bands irradiance = world.lights[k].given.strength * arriving.share;

    // 2. The two terms
    Bands diffuse, specular;
    bool mirrored = false;
    if (in_front && arriving.in_cone) {
      diffuse = irradiance * material.diffuse * cosine;
      if constexpr (F::specular) {
        if (material.specular.any()) {
          const double lobe = highlight(point, normal, to_viewer, arriving, cosine, material.exponent);
          specular = irradiance * material.specular * lobe;
          mirrored = lobe > 0;
        }
      }
    }
    radiance = radiance + (diffuse + specular);

    // 3. Channels
    if constexpr (F::channels) {
      write_light(out, i * lights + k, {}, diffuse, specular);
      rounding = rounding + rounding_of_light(world.lights[k], arriving, material, moved);
      signature.add_light(in_front, arriving.in_cone, mirrored && material.exponent < 1);
    }
  }
  radiance = shown(radiance);
  if (out.radiance) write(out.radiance, i, radiance);
  if constexpr (F::channels) {
    const Bands error = stated(rounding + radiance * (static_cast<double>(lights) + 3), radiance, point.undecided);
    write_surface(world, point, out, i, material.emission, ambient, error, signature);
  }
}

// Without channels, packets do what is plain.
template <class F>
bool render_in_packets(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                       const Interrupted& interrupted) {
  const auto one_by_one = [&] {
    return packets::Sampler([&, search = Search{}, point = SurfacePoint{}](std::size_t i, const Primitive&) mutable {
      render_one<F>(world, samples, out, search, point, i, [&](const SurfacePoint& at, std::size_t k) { shade<F>(world, at, out, k); });
    });
  };
  return packets::render(world, samples, out, nullptr, threads, cancel, interrupted, one_by_one);
}

template <class F>
bool render_with(const World& world, const Samples& samples, const Outputs& out, int threads, const Cancel* cancel,
                 const Interrupted& interrupted) {
  if constexpr (!F::channels) {
    if (packets::suit(world, out)) return render_in_packets<F>(world, samples, out, threads, cancel, interrupted);
  }
  return render_first_surface<F>(world, samples, out, threads, cancel, interrupted,
                                 [&](const SurfacePoint& point, std::size_t i) { shade<F>(world, point, out, i); });
}

using RenderFunction = bool (*)(const World&, const Samples&, const Outputs&, int, const Cancel*, const Interrupted&);

// 2 × 2 × 2 instantiations per precision.
template <class Precision> RenderFunction choose(bool specular, bool spot, bool channels) {
  static constexpr RenderFunction table[8] = {
      render_with<Compiled<Precision, false, false, false>>, render_with<Compiled<Precision, false, false, true>>,
      render_with<Compiled<Precision, false, true, false>>,  render_with<Compiled<Precision, false, true, true>>,
      render_with<Compiled<Precision, true, false, false>>,  render_with<Compiled<Precision, true, false, true>>,
      render_with<Compiled<Precision, true, true, false>>,   render_with<Compiled<Precision, true, true, true>>,
  };
  return table[(specular ? 4 : 0) + (spot ? 2 : 0) + (channels ? 1 : 0)];
}

}  // namespace

bool render_local(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                  const Interrupted& interrupted) {
  const RenderFunction kernel = choose<Exact>(world.features.specular, world.features.spot, !outputs.only_radiance());
  return kernel(world, samples, outputs, threads, cancel, interrupted);
}

}  // namespace equilux
