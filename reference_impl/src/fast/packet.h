// W rays through a FloatScene's tables: planes first, the rest by Embree.
#pragma once

#include "../blocks.h"
#include "lanes.h"
#include "tables.h"

namespace equilux::fast {

template <int W> struct EmbreeRays;
template <> struct EmbreeRays<4> {
  using RayHit = RTCRayHit4;
};
template <> struct EmbreeRays<8> {
  using RayHit = RTCRayHit8;
};
template <> struct EmbreeRays<16> {
  using RayHit = RTCRayHit16;
};

// P(t) = origin + t direction.
template <int W> struct Rays {
  Vectors<W> origin, direction;
  Mask<W> active;
};

template <int W> struct Hits {
  Mask<W> found, on_plane;
  Floats<W> t, u, v;
  Vectors<W> across;       // of the surface that Embree met: normal to it, any length and sign; of a plane: its outward normal
  Ints<W> geometry, primitive;  // Embree's; of a plane: −1 and its number
};

template <int W> inline Floats<W> infinity() { return all_of<W>(__builtin_inff()); }

// Where rays meet a plane; infinite where they do not.
template <int W> inline Floats<W> crossing_of(const Plane& plane, const Rays<W>& rays) {
  const Vectors<W> n = everywhere<W>(plane.normal);
  const Floats<W> t = (plane.level - dot<W>(n, rays.origin)) / dot<W>(n, rays.direction);
  return t > 0.0f ? t : infinity<W>();
}

template <int W> inline void put(float* x, float* y, float* z, const Vectors<W>& v) {
  store<W>(x, v.x);
  store<W>(y, v.y);
  store<W>(z, v.z);
}

template <int W, class Ray> inline void place_rays(Ray& ray, const Rays<W>& rays, Floats<W> far, std::uint32_t mask) {
  put<W>(ray.org_x, ray.org_y, ray.org_z, rays.origin);
  put<W>(ray.dir_x, ray.dir_y, ray.dir_z, rays.direction);
  store<W>(ray.tnear, Floats<W>{});
  store<W>(ray.time, Floats<W>{});
  store<W>(ray.tfar, far);
  const Ints<W> masks = all_of<W>(static_cast<std::int32_t>(mask));
  __builtin_memcpy(ray.mask, &masks, sizeof(masks));
}

// The nearest crossing of each active ray.
template <int W, bool Planes>
inline void find_nearest(const Tables& scene, embree::PacketQueries& queries, const Rays<W>& rays, std::uint32_t mask, Hits<W>& hits) {
  Floats<W> far = infinity<W>();
  Ints<W> plane_met = all_of<W>(std::int32_t{-1});
  if constexpr (Planes) {
    for (int k = 0; k < scene.plane_count; ++k) {
      if ((scene.planes[k].mask & mask) == 0) continue;
      const Floats<W> t = crossing_of<W>(scene.planes[k], rays);
      const Mask<W> nearer = t < far;
      far = nearer ? t : far;
      plane_met = nearer ? all_of<W>(std::int32_t{k}) : plane_met;
    }
  }
  hits.on_plane = (plane_met >= 0) & rays.active;
  hits.geometry = all_of<W>(std::int32_t{-1});
  hits.t = far;
  if (scene.embree != nullptr) {
    alignas(4 * W) typename EmbreeRays<W>::RayHit query;
    alignas(4 * W) Mask<W> valid = rays.active;
    place_rays<W>(query.ray, rays, far, mask);
    __builtin_memcpy(query.hit.geomID, &hits.geometry, sizeof(hits.geometry));
    queries.intersect(reinterpret_cast<const int*>(&valid), scene.embree, query);
    __builtin_memcpy(&hits.geometry, query.hit.geomID, sizeof(hits.geometry));
    __builtin_memcpy(&hits.primitive, query.hit.primID, sizeof(hits.primitive));
    hits.t = loaded<W>(query.ray.tfar);
    hits.u = loaded<W>(query.hit.u);
    hits.v = loaded<W>(query.hit.v);
    hits.across = {loaded<W>(query.hit.Ng_x), loaded<W>(query.hit.Ng_y), loaded<W>(query.hit.Ng_z)};
    hits.geometry = rays.active ? hits.geometry : all_of<W>(std::int32_t{-1});
    hits.on_plane &= hits.geometry < 0;
  }
  hits.found = (hits.geometry >= 0) | hits.on_plane;
  if constexpr (Planes) {
    hits.primitive = hits.on_plane ? plane_met : hits.primitive;
    if (any<W>(hits.on_plane)) {
      for (int k = 0; k < scene.plane_count; ++k) {
        hits.across = chosen<W>(hits.on_plane & (plane_met == k), everywhere<W>(scene.planes[k].normal), hits.across);
      }
    }
  }
}

// Which of the active rays meet something of `mask` before `far`.
template <int W, bool Planes>
inline Mask<W> find_blocked(const Tables& scene, embree::PacketQueries& queries, const Rays<W>& rays, Floats<W> far, std::uint32_t mask) {
  Mask<W> blocked{};
  if constexpr (Planes) {
    for (int k = 0; k < scene.plane_count; ++k) {
      if ((scene.planes[k].mask & mask) != 0) blocked |= crossing_of<W>(scene.planes[k], rays) < far;
    }
  }
  const Mask<W> open = rays.active & ~blocked;
  if (scene.embree == nullptr || !any<W>(open)) return blocked & rays.active;
  alignas(4 * W) decltype(EmbreeRays<W>::RayHit::ray) query;
  alignas(4 * W) Mask<W> valid = open;
  place_rays<W>(query, rays, far, mask);
  queries.occluded(reinterpret_cast<const int*>(&valid), scene.embree, query);
  return (blocked | (open & (loaded<W>(query.tfar) < 0.0f))) & rays.active;
}

// The rows of `surfaces`, as places of their first column.
template <int W> inline Ints<W> surfaces_met(const Tables& scene, const Hits<W>& hits) {
  Ints<W> rows{};
  for (unsigned left = packed<W>(hits.geometry >= 0); left != 0;) {
    const std::int32_t id = hits.geometry[first_of(left)];
    const Geometry& geometry = scene.geometries[id];
    const Mask<W> here = hits.geometry == id;
    left &= ~packed<W>(here);
    if (geometry.surface >= 0) {
      rows = here ? all_of<W>(geometry.surface * surface_stride) : rows;
    } else {
      const Ints<W> primitive = here ? hits.primitive + geometry.first_surface : Ints<W>{};
      rows = here ? gathered<W>(scene.surfaces_of_primitives, primitive) * surface_stride : rows;
    }
  }
  for (int k = 0; k < scene.plane_count; ++k) {
    rows = hits.on_plane & (hits.primitive == k) ? all_of<W>(scene.planes[k].surface * surface_stride) : rows;
  }
  return rows;
}

// One column of the surfaces; `uniform`: all lanes look at the same row.
template <int W> inline Floats<W> column(const Tables& scene, Ints<W> rows, bool uniform, int index) {
  if (uniform) return all_of<W>(scene.surfaces[rows[0] + index]);
  return gathered<W>(scene.surfaces + index, rows);
}

// A ray that leaves a surface starts beside it, on the side that it goes to: by 2^-19 of the lengths that were added up to find the
// point, some ten times what rounding can have moved it off the surface, so that the surface is not met again at any angle.
// `across` is of any length: it is brought to a largest component of 1.
template <int W> inline Vectors<W> beside(const Vectors<W>& at, Floats<W> reach, const Vectors<W>& across, const Vectors<W>& direction) {
  const Floats<W> size = larger<W>(larger<W>(magnitude<W>(at.x), magnitude<W>(at.y)), magnitude<W>(at.z)) + reach;
  const Floats<W> longest = larger<W>(larger<W>(magnitude<W>(across.x), magnitude<W>(across.y)), magnitude<W>(across.z));
  const Floats<W> step = size * 0x1p-19f / longest;
  const Floats<W> towards = dot<W>(across, direction) < 0.0f ? -step : step;
  return at + times<W>(across, towards);
}

constexpr float before_the_lamp = 1 - 0x1p-20f;

// The way to a lamp: unit direction, distance (infinite: directional) and its reciprocal.
template <int W> struct Way {
  Vectors<W> direction;
  Floats<W> distance, reciprocal;
};

template <int W> inline Way<W> way_to(const Lamp& lamp, const Vectors<W>& at) {
  if (lamp.kind == LampKind::directional) return {everywhere<W>(lamp.position), infinity<W>(), Floats<W>{}};
  const Vectors<W> toward = everywhere<W>(lamp.position) - at;
  const Floats<W> square = dot<W>(toward, toward), reciprocal = reciprocal_root<W>(square);
  return {times<W>(toward, reciprocal), square * reciprocal, reciprocal};
}

template <int W> struct Blocks {
  static constexpr int columns = block_columns(W), rows = block_rows(W);
};

// The eye's rays through the centres of a block's pixels. 2 i + 1 − width is exact, so x has two roundings.
template <int W> inline Rays<W> rays_of_eye(const Tables& scene, PixelAt block) {
  Ints<W> lane;
  for (int i = 0; i < W; ++i) lane[i] = i;
  const Ints<W> column = block.column + (lane & (Blocks<W>::columns - 1)), row = block.row + lane / Blocks<W>::columns;
  const Floats<W> x = as_floats<W>(2 * column + (1 - scene.width)) * scene.film_step;
  const Floats<W> y = as_floats<W>((scene.height - 1) - 2 * row) * scene.film_step;
  const Floats<W> zero{}, one = all_of<W>(1.0f);
  const Mask<W> active = (column < scene.width) & (row < scene.height);
  if (scene.perspective) return {{zero, zero, zero}, {x, y, one}, active};
  return {{x, y, zero}, {zero, zero, one}, active};
}

}  // namespace equilux::fast
