// Writing samples: what every model's kernel does in the same way.
#pragma once

#include <limits>

#include "kernel.h"
#include "signature.h"
#include "surface.h"

namespace equilux {

inline void write(double* out, std::size_t index, const Bands& value) {
  out[3 * index] = value.r;
  out[3 * index + 1] = value.g;
  out[3 * index + 2] = value.b;
}

inline void write(double* out, std::size_t index, const Vec3d& value) { write(out, index, Bands{value.x, value.y, value.z}); }

// The terms of one light; index: sample × lights + light.
inline void write_light(const Outputs& out, std::size_t index, const Bands& ambient, const Bands& diffuse, const Bands& specular) {
  if (out.light_ambient) write(out.light_ambient, index, ambient);
  if (out.diffuse) write(out.diffuse, index, diffuse);
  if (out.specular) write(out.specular, index, specular);
}

// A miss shows the background, which is none of the terms.
template <class F> void write_miss(const World& world, const Outputs& out, std::size_t i) {
  if (out.radiance) write(out.radiance, i, world.description.background);
  if constexpr (F::channels) {
    const std::size_t lights = world.light_count();
    if (out.emission) write(out.emission, i, Bands{});
    if (out.ambient) write(out.ambient, i, Bands{});
    for (std::size_t k = 0; k < lights; ++k) write_light(out, i * lights + k, {}, {}, {});
    if (out.reflected) write(out.reflected, i, Bands{});
    if (out.transmitted) write(out.transmitted, i, Bands{});
    if (out.rounding) write(out.rounding, i, Bands{});
    if (out.quadrature) write(out.quadrature, i, Bands{});
    if (out.object_id) out.object_id[i] = -1;
    if (out.depth) out.depth[i] = std::numeric_limits<double>::infinity();
    if (out.normal) write(out.normal, i, Vec3d{});
    constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
    if (out.position) write(out.position, i, Vec3d{nowhere, nowhere, nowhere});
    if (out.signature) out.signature[i] = signature_of_a_miss;
  }
}

inline void write_geometry(const World& world, const SurfacePoint& point, const Outputs& out, std::size_t i) {
  if (out.object_id) out.object_id[i] = point.object;
  if (out.depth) out.depth[i] = point.distance;
  if (out.normal) write(out.normal, i, to_double(point.normal));
  if (out.position) write(out.position, i, to_double(point.position + exactly(world.camera.eye)));
}

// All of a surface but its radiance and its lights, in the models that mirror and let through nothing. rounding: in W/(m²·sr).
inline void write_surface(const World& world, const SurfacePoint& point, const Outputs& out, std::size_t i, const Bands& emission,
                          const Bands& ambient, const Bands& rounding, const Signature& signature) {
  if (out.emission) write(out.emission, i, emission);
  if (out.ambient) write(out.ambient, i, ambient);
  if (out.reflected) write(out.reflected, i, Bands{});
  if (out.transmitted) write(out.transmitted, i, Bands{});
  if (out.rounding) write(out.rounding, i, rounding);
  if (out.signature) out.signature[i] = signature.value();
  write_geometry(world, point, out, i);
}

}  // namespace equilux
