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

// A miss shows the background, which is none of the terms.
template <class F> void write_miss(const World& world, const Outputs& out, std::size_t i) {
  if (out.radiance) write(out.radiance, i, world.description.background);
  if constexpr (F::channels) {
    const std::size_t lights = world.light_count();
    if (out.emission) write(out.emission, i, Bands{});
    if (out.ambient) write(out.ambient, i, Bands{});
    for (std::size_t k = 0; k < lights; ++k) {
      if (out.light_ambient) write(out.light_ambient, i * lights + k, Bands{});
      if (out.diffuse) write(out.diffuse, i * lights + k, Bands{});
      if (out.specular) write(out.specular, i * lights + k, Bands{});
    }
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

// The local models mirror and let through nothing.
inline void write_no_secondary(const Outputs& out, std::size_t i) {
  if (out.reflected) write(out.reflected, i, Bands{});
  if (out.transmitted) write(out.transmitted, i, Bands{});
}

inline void write_geometry(const World& world, const SurfacePoint& point, const Outputs& out, std::size_t i) {
  if (out.object_id) out.object_id[i] = point.object;
  if (out.depth) out.depth[i] = point.distance;
  if (out.normal) write(out.normal, i, to_double(point.normal));
  if (out.position) write(out.position, i, to_double(point.position + exactly(world.camera.eye)));
}

}  // namespace equilux
