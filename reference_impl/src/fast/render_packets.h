// The loops over packets: rendering, and the bare traversal of the same rays that its speed is measured against.
#pragma once

#include "kernel.h"
#include "shading.h"

namespace equilux::fast {

template <bool Specular, bool Shadows, bool Lamps, bool Meshes, bool Planes, bool Secondary = false, bool Rounding = false>
struct Compiled {
  static constexpr bool specular = Specular, shadows = Shadows, lamps = Lamps, meshes = Meshes, planes = Planes;
  static constexpr bool secondary = Secondary, rounding = Rounding;
};

// Rays that wait to be followed, and what their radiance counts.
template <int W> struct Waiting {
  Rays<W> rays;
  Colours<W> weight;
  int used;
  Strayed<W> strayed;  // with F::rounding only
};

// The mirrored and the refracted rays of W points, put on the stack; the sum of their weights' zero lanes is not followed.
template <class F, int W>
inline Waiting<W>* send_onward(const Tables& scene, const Points<W>& point, const Colours<W>& weight, int used, Waiting<W>* top) {
  const Vectors<W>& N = point.normal;
  const Floats<W> one = all_of<W>(1.0f), cosine = dot<W>(N, point.to_viewer);
  Colours<W> mirrored = point.colour(scene, column_mirrored);
  const Mask<W> transparent = point.found & (point.material(scene, column_behind) > 0.0f);
  if (any<W>(transparent)) {
    const Floats<W> ior = point.material(scene, column_ior);
    const Bent<W> through = refracted<W>(times<W>(point.to_viewer, all_of<W>(-1.0f)), N, point.outside ? one : ior, point.outside ? ior : one);
    const Mask<W> total = transparent & through.total;
    mirrored = {total ? one : mirrored.r, total ? one : mirrored.g, total ? one : mirrored.b};
    const Colours<W> left = masked<W>(transparent & ~through.total, weight * point.colour(scene, column_through));
    const Mask<W> goes = shines<W>(left);
    if (any<W>(goes)) {
      *top = {{beside<W>(point.position, point.reach, point.across, through.direction), through.direction, goes}, left, used, {}};
      if constexpr (F::rounding) {
        const Floats<W> eta = point.outside ? one / ior : ior, slope = magnitude<W>(dot<W>(N, through.direction));
        const Floats<W> bend = ior == 1.0f ? one : larger<W>(eta, (one + eta * magnitude<W>(cosine)) / larger<W>(slope, all_of<W>(least_slope)));
        top->strayed = strayed_beyond<W>(point.moved, point.size(), bend, slope);
      }
      ++top;
    }
  }
  const Colours<W> left = masked<W>(point.found, weight * mirrored);
  const Mask<W> goes = shines<W>(left);
  if (any<W>(goes)) {
    const Vectors<W> direction = made_unit<W>(times<W>(N, 2.0f * cosine) - point.to_viewer);
    *top = {{beside<W>(point.position, point.reach, point.across, direction), direction, goes}, left, used, {}};
    if constexpr (F::rounding) top->strayed = strayed_beyond<W>(point.moved, point.size(), one, Floats<W>{});
    ++top;
  }
  return top;
}

template <class F, int W> struct Accumulated {
  Colours<W> radiance, rounding;
};

// Adds what the rays' first surfaces show, times `weight`. Returns what they met.
template <class F, int W>
inline Accumulated<F, W> seen_first(const Tables& scene, embree::PacketQueries& queries, const Rays<W>& rays, const Strayed<W>& strayed,
                                    std::uint32_t* sent, Points<W>& point) {
  Hits<W> hits;
  find_nearest<W, F::planes>(scene, queries, rays, mask_all, hits);
  Accumulated<F, W> seen;
  seen.radiance = one_colour<W>(scene.background);
  point.found = hits.found;
  if constexpr (F::rounding) seen.rounding = scaled<W>(seen.radiance, all_of<W>(2.0f));
  if (!any<W>(hits.found)) return seen;
  if constexpr (F::rounding) seen.rounding = {};
  point = points_met<F, W>(scene, rays, hits, strayed);
  const Colours<W> local = local_light<F, W>(scene, queries, point, sent, seen.rounding);
  seen.radiance = {hits.found ? local.r : seen.radiance.r, hits.found ? local.g : seen.radiance.g, hits.found ? local.b : seen.radiance.b};
  if constexpr (F::rounding) {
    seen.rounding = masked<W>(hits.found, seen.rounding) + scaled<W>(seen.radiance, all_of<W>(static_cast<float>(scene.lamp_count + 4)));
  }
  return seen;
}

// Follows every waiting ray to its end.
template <class F, int W>
inline void follow_all(const Tables& scene, embree::PacketQueries& queries, Waiting<W>* stack, Waiting<W>* top, Accumulated<F, W>& sum) {
  while (top != stack) {
    const Waiting<W> next = *--top;
    Points<W> point;
    const Accumulated<F, W> seen = seen_first<F, W>(scene, queries, next.rays, next.strayed, nullptr, point);
    sum.radiance = sum.radiance + masked<W>(next.rays.active, next.weight * seen.radiance);
    if constexpr (F::rounding) {
      const Colours<W> more = scaled<W>(seen.radiance, all_of<W>(static_cast<float>(8 * next.used)));
      sum.rounding = sum.rounding + masked<W>(next.rays.active, next.weight * (seen.rounding + more));
    }
    if (next.used < scene.recursion_limit && any<W>(point.found)) top = send_onward<F, W>(scene, point, next.weight, next.used + 1, top);
  }
}

template <int W> inline void write_block(const Tables& scene, PixelAt block, const Colours<W>& value, float scale, float* out) {
  constexpr int columns = Blocks<W>::columns, rows = Blocks<W>::rows;
  alignas(64) float r[W], g[W], b[W];
  store<W>(r, value.r * scale);
  store<W>(g, value.g * scale);
  store<W>(b, value.b * scale);
  const int wide = scene.width - block.column < columns ? scene.width - block.column : columns;
  const int high = scene.height - block.row < rows ? scene.height - block.row : rows;
  for (int j = 0; j < high; ++j) {
    float* to = out + 3 * (static_cast<std::size_t>(block.row + j) * static_cast<std::size_t>(scene.width) + static_cast<std::size_t>(block.column));
    for (int i = 0; i < wide; ++i, to += 3) {
      to[0] = r[j * columns + i];
      to[1] = g[j * columns + i];
      to[2] = b[j * columns + i];
    }
  }
}

template <class F, int W> void render_blocks(const Tables& scene, std::size_t begin, std::size_t end, const PacketOutputs& out, void* scratch) {
  embree::PacketQueries coherent(true), scattered(false);
  Waiting<W>* const stack = static_cast<Waiting<W>*>(scratch);
  for (std::size_t i = begin; i < end; ++i) {
    const PixelAt block = block_at(W, scene.width, i);
    if (block.column >= scene.width || block.row >= scene.height) continue;
    const Rays<W> rays = rays_of_eye<W>(scene, block);
    std::uint32_t* const sent = out.shadowed == nullptr ? nullptr : out.shadowed + i * static_cast<std::size_t>(scene.lamp_count);
    Points<W> point;
    Accumulated<F, W> sum = seen_first<F, W>(scene, coherent, rays, of_the_eye<W>(), sent, point);
    if constexpr (F::secondary) {
      if (scene.recursion_limit > 0 && any<W>(point.found)) {
        const Floats<W> one = all_of<W>(1.0f);
        Waiting<W>* const top = send_onward<F, W>(scene, point, {one, one, one}, 1, stack);
        follow_all<F, W>(scene, scattered, stack, top, sum);
      }
    }
    write_block<W>(scene, block, sum.radiance, 1, out.radiance);
    if constexpr (F::rounding) write_block<W>(scene, block, sum.rounding, 0x1p-24f, out.rounding);
  }
}

// Made only of what rays need: neither normals to shade with nor materials.
template <int W, bool Planes>
inline void traverse_blocks_with(const Tables& scene, std::size_t begin, std::size_t end, const std::uint32_t* shadowed) {
  embree::PacketQueries coherent(true);
  for (std::size_t i = begin; i < end; ++i) {
    const PixelAt block = block_at(W, scene.width, i);
    if (block.column >= scene.width || block.row >= scene.height) continue;
    const Rays<W> rays = rays_of_eye<W>(scene, block);
    Hits<W> hits;
    find_nearest<W, Planes>(scene, coherent, rays, mask_all, hits);
    if (!any<W>(hits.found)) continue;
    const Floats<W> t = hits.found ? hits.t : Floats<W>{};
    const Vectors<W> position = rays.origin + times<W>(rays.direction, t);
    Floats<W> reach{};
    for (int k = 0; k < scene.lamp_count; ++k) {
      const Mask<W> sent = unpacked<W>(shadowed[i * static_cast<std::size_t>(scene.lamp_count) + static_cast<std::size_t>(k)]);
      if (!any<W>(sent)) continue;
      if (k == 0) reach = column<W>(scene, surfaces_met<W>(scene, hits), false, column_reach);
      const Way<W> way = way_to<W>(scene.lamps[k], position);
      const Rays<W> shadow{beside<W>(position, reach, hits.across, way.direction), way.direction, sent};
      find_blocked<W, Planes>(scene, coherent, shadow, way.distance * before_the_lamp, mask_opaque);
    }
  }
}
template <int W> void traverse_blocks(const Tables& scene, std::size_t begin, std::size_t end, const std::uint32_t* shadowed) {
  (scene.plane_count > 0 ? traverse_blocks_with<W, true> : traverse_blocks_with<W, false>)(scene, begin, end, shadowed);
}

// What one lane met.
template <int W> inline Primitive primitive_met(const Tables& scene, const Hits<W>& hits, int lane) {
  const std::int32_t primitive = hits.primitive[lane];
  if (hits.on_plane[lane] != 0) return {scene.planes[primitive].surface, -1, 0};
  if (hits.geometry[lane] < 0) return {};
  const Geometry& geometry = scene.geometries[hits.geometry[lane]];
  if (geometry.surface >= 0) return {geometry.surface, geometry.mesh, static_cast<std::uint32_t>(primitive)};
  return {scene.surfaces_of_primitives[geometry.first_surface + primitive], -1, 0};
}

template <int W> void find_blocks(const Tables& scene, std::size_t begin, std::size_t end, Primitive* met) {
  embree::PacketQueries coherent(true);
  for (std::size_t i = begin; i < end; ++i) {
    const PixelAt block = block_at(W, scene.width, i);
    if (block.column >= scene.width || block.row >= scene.height) continue;
    Hits<W> hits;
    find_nearest<W, true>(scene, coherent, rays_of_eye<W>(scene, block), mask_all, hits);
    for (int lane = 0; lane < W; ++lane) met[(i - begin) * W + static_cast<std::size_t>(lane)] = primitive_met<W>(scene, hits, lane);
  }
}

template <int W> std::size_t count_blocks(const Tables& scene) { return block_count(W, scene.width, scene.height); }

// Depth first, one taken and up to two put: never more than the limit and one.
template <int W> std::size_t scratch_bytes(int recursion_limit) { return sizeof(Waiting<W>) * (static_cast<std::size_t>(recursion_limit) + 2); }

// What is compiled: the 32 that scenes without secondary rays need, one with everything, and two with the bound of the
// rounding.
template <int W> RenderBlocks choose(const FloatFeatures& needed, bool rounding) {
  if (rounding && !needed.shadows && !needed.secondary) return render_blocks<Compiled<true, false, true, true, true, false, true>, W>;
  if (rounding) return render_blocks<Compiled<true, true, true, true, true, true, true>, W>;
  if (needed.secondary) return render_blocks<Compiled<true, true, true, true, true, true>, W>;
#define EQUILUX_GEOMETRY(SPECULAR, SHADOWS, LAMPS)                                                                     \
  (needed.meshes ? needed.planes ? render_blocks<Compiled<SPECULAR, SHADOWS, LAMPS, true, true>, W>                  \
                                 : render_blocks<Compiled<SPECULAR, SHADOWS, LAMPS, true, false>, W>                 \
   : needed.planes ? render_blocks<Compiled<SPECULAR, SHADOWS, LAMPS, false, true>, W>                               \
                   : render_blocks<Compiled<SPECULAR, SHADOWS, LAMPS, false, false>, W>)
#define EQUILUX_LAMPS(SPECULAR, SHADOWS) (needed.lamps ? EQUILUX_GEOMETRY(SPECULAR, SHADOWS, true) : EQUILUX_GEOMETRY(SPECULAR, SHADOWS, false))
  if (needed.specular) return needed.shadows ? EQUILUX_LAMPS(true, true) : EQUILUX_LAMPS(true, false);
  return needed.shadows ? EQUILUX_LAMPS(false, true) : EQUILUX_LAMPS(false, false);
#undef EQUILUX_LAMPS
#undef EQUILUX_GEOMETRY
}

template <int W> const Kernels* kernels() {
  static constexpr Kernels table{W,           count_blocks<W>,  choose<W>,           traverse_blocks<W>,
                                 find_blocks<W>, scratch_bytes<W>, intersect_shapes<W>, occlude_shapes<W>};
  return &table;
}

}  // namespace equilux::fast
