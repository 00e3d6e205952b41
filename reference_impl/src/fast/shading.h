// The lighting model of packets, in float: the same formulas as phong.h and raytraced.h.
//
// Where the digits go: as derived in phong.h, with u = 2^-24 for 2^-53. Beyond that: 1/√ has 3 units instead of 1 (|δL| ≤ 9 u, N·L 15 u,
// δ = |δ(R − V)| ≤ 50 u), and lobe.h adds 2^-21 = 8 u at the peak. So, in units of u:
//   diffuse 35, lobe 30 √p + 25, the cone likewise.
// Besides, the geometry is found in float, too (strayed.h). With δP, δN, δV of the point, δL = δP / r:
//   E            2 δP / r, no attenuation falls off faster than r^-2; a cone's cos^e: √(e/e) δL.
//   diffuse      δN + δL.
//   T − V        the same with the bend of the refraction for 1: T turns by bend δL + (bend + 1) δN.
//   R − V        δ = 4 δN + 3 δL + δV (+ 50 u): the lobe moves by √(p/e) δ. p < 1: |a^p − b^p| ≤ |a − b|^p, so by δ^p.
#pragma once

#include "lobe.h"
#include "packet.h"
#include "shape_packet.h"
#include "strayed.h"

namespace equilux::fast {

template <int W> struct Colours {
  Floats<W> r{}, g{}, b{};
};
template <int W> inline Colours<W> operator+(const Colours<W>& a, const Colours<W>& b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
template <int W> inline Colours<W> operator*(const Colours<W>& a, const Colours<W>& b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
template <int W> inline Colours<W> scaled(const Colours<W>& a, Floats<W> s) { return {a.r * s, a.g * s, a.b * s}; }
template <int W> inline Colours<W> one_colour(const float* c) { return {all_of<W>(c[0]), all_of<W>(c[1]), all_of<W>(c[2])}; }
template <int W> inline Colours<W> masked(Mask<W> mask, const Colours<W>& a) {
  return {mask ? a.r : Floats<W>{}, mask ? a.g : Floats<W>{}, mask ? a.b : Floats<W>{}};
}
template <int W> inline Mask<W> shines(const Colours<W>& a) { return (a.r != 0.0f) | (a.g != 0.0f) | (a.b != 0.0f); }

// Everything about W surface points that their lights do not change.
template <int W> struct Points {
  Mask<W> found;
  Vectors<W> position, normal, to_viewer;  // N on the viewer's side
  Vectors<W> across;                       // the geometric normal, of any length and sign
  Mask<W> outside;                         // the viewer is on the side of the outward normal
  Ints<W> rows;
  bool uniform;                            // all of one surface
  Floats<W> reach;
  MovedPoint<W> moved;                     // with F::rounding only, as the curvature
  Floats<W> curvature;

  // The lengths that were added up to find the position.
  Floats<W> size() const { return larger<W>(larger<W>(magnitude<W>(position.x), magnitude<W>(position.y)), magnitude<W>(position.z)) + reach; }
  Floats<W> material(const Tables& scene, int index) const { return column<W>(scene, rows, uniform, index); }
  Colours<W> colour(const Tables& scene, int index) const {
    return {material(scene, index), material(scene, index + 1), material(scene, index + 2)};
  }
};

template <int W> inline Vectors<W> row_of(const float* table, Ints<W> index) {
  return {gathered<W>(table, index), gathered<W>(table + 1, index), gathered<W>(table + 2, index)};
}

// The interpolated vertex normals; the geometric normal where they cancel out.
template <int W> inline Vectors<W> interpolated(const Tables& scene, Ints<W> triangle, const Hits<W>& hits, const Vectors<W>& geometric) {
  const Ints<W> at = triangle * 3;
  const Ints<W> a = gathered<W>(scene.corners, at), b = gathered<W>(scene.corners + 1, at), c = gathered<W>(scene.corners + 2, at);
  const Floats<W> rest = 1.0f - hits.u - hits.v;
  const Vectors<W> sum = times<W>(row_of<W>(scene.vertex_normals, a), rest) + times<W>(row_of<W>(scene.vertex_normals, b), hits.u) +
                         times<W>(row_of<W>(scene.vertex_normals, c), hits.v);
  const Mask<W> cancelled = !(dot<W>(sum, sum) > 1e-30f);
  return any<W>(cancelled) ? chosen<W>(cancelled, geometric, sum) : sum;
}

template <class F, int W> inline void find_normals(const Tables& scene, const Hits<W>& hits, Points<W>& point) {
  Vectors<W> normal = hits.across, outward = hits.across;
  for (unsigned left = packed<W>(hits.geometry >= 0); left != 0;) {
    const std::int32_t id = hits.geometry[first_of(left)];
    const Geometry& geometry = scene.geometries[id];
    Mask<W> here = hits.geometry == id;
    left &= ~packed<W>(here);
    const Ints<W> primitive = here ? hits.primitive + geometry.first : Ints<W>{};
    switch (geometry.facing) {
      case Facing::stored: {
        const Vectors<W> stored = row_of<W>(scene.stored_normals, primitive * 4);
        normal = chosen<W>(here, stored, normal);
        outward = chosen<W>(here, stored, outward);
        break;
      }
      case Facing::interpolated:
        if constexpr (F::meshes) {
          const Vectors<W> wound = times<W>(hits.across, all_of<W>(-1.0f));  // Embree's, in a frame of the other hand
          normal = chosen<W>(here, interpolated<W>(scene, primitive, hits, wound), normal);
          outward = chosen<W>(here, wound, outward);
          if constexpr (F::rounding) point.curvature = here ? gathered<W>(scene.curvatures, primitive) : point.curvature;
        }
        break;
      case Facing::sphere: break;  // Embree's own leads from the centre
      case Facing::round: break;   // so does the callback's
    }
  }
  point.outside = dot<W>(outward, point.to_viewer) > 0.0f;
  const Mask<W> beside = (dot<W>(normal, outward) < 0.0f) ^ ~point.outside;  // N·Ng > 0, Ng on the viewer's side
  const Vectors<W> unit = made_unit<W>(normal);
  const Floats<W> turn = beside ? all_of<W>(-1.0f) : all_of<W>(1.0f);
  point.normal = times<W>(unit, turn);
  point.across = outward;
}

template <class F, int W>
inline Points<W> points_met(const Tables& scene, const Rays<W>& rays, const Hits<W>& hits, const Strayed<W>& strayed) {
  Points<W> point;
  point.found = hits.found;
  const Floats<W> t = hits.found ? hits.t : Floats<W>{};
  point.position = rays.origin + times<W>(rays.direction, t);
  point.to_viewer = times<W>(rays.direction, -reciprocal_root<W>(dot<W>(rays.direction, rays.direction)));
  point.rows = surfaces_met<W>(scene, hits);
  const unsigned found = packed<W>(hits.found);
  const std::int32_t first = point.rows[first_of(found)];
  point.uniform = (packed<W>(point.rows == first) & found) == found;
  if (point.uniform) point.rows = all_of<W>(first);
  point.reach = point.material(scene, column_reach);
  if constexpr (F::rounding) point.curvature = point.material(scene, column_curvature);
  find_normals<F, W>(scene, hits, point);
  if constexpr (F::rounding) {
    const Floats<W> along = t * root<W>(dot<W>(rays.direction, rays.direction));
    const Floats<W> slope = magnitude<W>(dot<W>(made_unit<W>(point.across), point.to_viewer));
    point.moved = moved_point<W>(strayed, along, 2.0f * point.size(), slope, point.curvature);
  }
  return point;
}

// What arrives of a lamp, before its shadow, as a share of its strength.
template <class F, int W> inline Floats<W> arriving_share(const Lamp& lamp, const Way<W>& way) {
  if constexpr (!F::lamps) return way.reciprocal * way.reciprocal;
  if (lamp.kind == LampKind::directional) return all_of<W>(1.0f);
  Floats<W> share = 1.0f / (lamp.constant + way.distance * (lamp.linear + way.distance * lamp.quadratic));
  if (lamp.kind == LampKind::spot) {
    const Vectors<W> away = times<W>(way.direction, all_of<W>(-1.0f)), axis = everywhere<W>(lamp.axis);
    const Mask<W> inside = dot<W>(away, axis) >= lamp.cone_cosine;
    if (lamp.exponent > 0) share *= lobe<W>(away, axis, all_of<W>(lamp.exponent));
    share = inside ? share : Floats<W>{};
  }
  return share;
}

constexpr int crossings_at_most = 4096;  // of transparent surfaces by one shadow ray

// τ of the lanes in `wanted`: what is left of the lamp's light. `sent`: which lanes had to ask.
template <class F, int W>
inline Colours<W> shadow_of(const Tables& scene, embree::PacketQueries& queries, const Points<W>& point, const Way<W>& way, Mask<W> wanted) {
  const Floats<W> one = all_of<W>(1.0f);
  Colours<W> share{one, one, one};
  const Floats<W> far = way.distance * before_the_lamp;
  Rays<W> rays{beside<W>(point.position, point.reach, point.across, way.direction), way.direction, wanted};
  const Mask<W> blocked = find_blocked<W, F::planes>(scene, queries, rays, far, mask_opaque);
  share = masked<W>(~blocked, share);
  if constexpr (F::secondary) {
    if (!scene.transparent_shadows) return share;
    rays.active = wanted & ~blocked;
    Floats<W> left = far;
    for (int k = 0; any<W>(rays.active); ++k) {  // from one transparent surface to the next
      if (k == crossings_at_most) refuse_crossings(crossings_at_most);
      Hits<W> hits;
      find_nearest<W, F::planes>(scene, queries, rays, mask_transparent, hits);
      rays.active = hits.found & (hits.t < left);
      if (!any<W>(rays.active)) break;
      hits.geometry = rays.active ? hits.geometry : all_of<W>(std::int32_t{-1});
      hits.on_plane &= rays.active;
      const Ints<W> rows = surfaces_met<W>(scene, hits);
      const Colours<W> crossed{column<W>(scene, rows, false, column_shadow), column<W>(scene, rows, false, column_shadow + 1),
                               column<W>(scene, rows, false, column_shadow + 2)};
      const Colours<W> after = share * crossed;
      share = {rays.active ? after.r : share.r, rays.active ? after.g : share.g, rays.active ? after.b : share.b};
      const Floats<W> step = rays.active ? hits.t : Floats<W>{};
      const Vectors<W> at = rays.origin + times<W>(rays.direction, step);
      rays.origin = chosen<W>(rays.active, beside<W>(at, column<W>(scene, rows, false, column_reach), hits.across, rays.direction), rays.origin);
      left -= step;
      rays.active &= shines<W>(share);
    }
  }
  return share;
}

// How the direction d goes on through a surface with normal n, from index `from` into `into`; total: it does not (raytraced.h).
template <int W> struct Bent {
  Vectors<W> direction;
  Mask<W> total;
};
template <int W> inline Bent<W> refracted(const Vectors<W>& d, const Vectors<W>& n, Floats<W> from, Floats<W> into) {
  const Floats<W> eta = from / into, c = dot<W>(n, d);
  const Floats<W> rest = 1.0f - eta * eta * (1.0f - c * c);
  const Mask<W> total = rest < 0.0f;
  const Floats<W> size = root<W>(total ? Floats<W>{} : rest), signed_size = c < 0.0f ? -size : size;
  const Vectors<W> onward = times<W>(d, eta) + times<W>(n, signed_size - eta * c);
  return {chosen<W>(from == into, d, made_unit<W>(onward)), total & (from != into)};
}

// What one lamp may add to the error, in units of u; irradiance: with its shadow, where there is one.
template <int W>
inline Colours<W> rounding_of_lamp(const Lamp& lamp, const Way<W>& way, const Points<W>& point, Floats<W> cosine, const Colours<W>& irradiance,
                                   const Colours<W>& diffuse, const Colours<W>& specular, Floats<W> exponent, Floats<W> bend,
                                   Mask<W> both_sides) {
  const Floats<W> to_light = point.moved.position * way.reciprocal;  // δL
  const Floats<W> turned = (bend + 1.0f) * (2.0f * point.moved.normal + 1.5f * to_light + 25 * unit_roundoff) + point.moved.view;
  const Floats<W> share = 2.0f * to_light + (lamp.kind == LampKind::spot && lamp.exponent > 0
                                                 ? (to_light + 50 * unit_roundoff) * (__builtin_sqrtf(lamp.exponent) + 1.0f)
                                                 : Floats<W>{});
  const Floats<W> of_diffuse = point.moved.normal + to_light + share + 35 * unit_roundoff;
  const Floats<W> small = exponential<W>(exponent * log1p_of_minus<W>(1.0f - smaller<W>(turned, all_of<W>(0.5f))));
  const Floats<W> steep = exponent < 1.0f ? small : 0.61f * root<W>(exponent) * turned;
  const Floats<W> of_lobe = steep + share + 25 * unit_roundoff;
  const Mask<W> may_shine = point.found & (both_sides | (cosine > -turned));
  const Colours<W> sum = scaled<W>(diffuse, of_diffuse) + scaled<W>(specular, of_lobe);
  return scaled<W>(masked<W>(may_shine, irradiance * sum), all_of<W>(1 / unit_roundoff));
}

// How many times as much the light from behind turns at the surface as it turned before, at most (raytraced.h); 1 for light from in front.
template <int W> inline Floats<W> bend_of_light(const Tables& scene, const Points<W>& point, Floats<W> cosine) {
  const Floats<W> one = all_of<W>(1.0f), ior = point.material(scene, column_ior);
  const Floats<W> eta = point.outside ? ior : one / ior, rest = 1.0f - eta * eta * (1.0f - cosine * cosine);
  const Floats<W> slope = larger<W>(root<W>(larger<W>(rest, Floats<W>{})), all_of<W>(least_slope));
  return (cosine < 0.0f) & (ior != 1.0f) ? larger<W>(eta, (one + eta * magnitude<W>(cosine)) / slope) : one;
}

// Emission, ambient and the lights, on both sides where something is transparent.
template <class F, int W>
inline Colours<W> local_light(const Tables& scene, embree::PacketQueries& queries, const Points<W>& point, std::uint32_t* sent,
                              Colours<W>& rounding) {
  Colours<W> sum = point.colour(scene, column_constant);
  const Colours<W> diffuse = point.colour(scene, column_diffuse);
  Colours<W> specular;
  Floats<W> exponent{};
  if constexpr (F::specular) {
    specular = point.colour(scene, column_specular);
    exponent = point.material(scene, column_exponent);
  }
  const int lamps = F::lamps ? scene.lamp_count : 1;
  for (int k = 0; k < lamps; ++k) {
    // 1. What arrives, from which side, and how much that side counts
    const Lamp& lamp = scene.lamps[k];
    const Way<W> way = way_to<W>(lamp, point.position);
    const Floats<W> cosine = dot<W>(point.normal, way.direction);
    Floats<W> share = arriving_share<F, W>(lamp, way);
    Mask<W> lit = point.found & (cosine > 0.0f) & (share > 0.0f);
    Floats<W> steepness = cosine;
    if constexpr (F::secondary) {
      const Floats<W> side = cosine > 0.0f ? point.material(scene, column_front) : point.material(scene, column_behind);
      lit = point.found & (cosine != 0.0f) & (share * side > 0.0f);
      share *= side;
      steepness = magnitude<W>(cosine);
    }
    Colours<W> irradiance = scaled<W>(one_colour<W>(lamp.strength), share);
    // 2. What its shadow leaves
    if constexpr (F::shadows) {
      if (sent != nullptr) sent[k] = packed<W>(lit);
      if (!F::rounding && !any<W>(lit)) continue;
      if constexpr (F::secondary) {
        irradiance = irradiance * shadow_of<F, W>(scene, queries, point, way, lit);
      } else {
        const Rays<W> rays{beside<W>(point.position, point.reach, point.across, way.direction), way.direction, lit};
        lit &= ~find_blocked<W, F::planes>(scene, queries, rays, way.distance * before_the_lamp, mask_opaque);
      }
    }

    if constexpr (F::rounding) {
      Floats<W> bend = all_of<W>(1.0f);
      Mask<W> both_sides{};
      Colours<W> possible = irradiance;
      if constexpr (F::secondary) {
        bend = bend_of_light<W>(scene, point, cosine);
        both_sides = point.material(scene, column_behind) > 0.0f;
        const Floats<W> open = larger<W>(point.material(scene, column_front), point.material(scene, column_behind));
        const Mask<W> unlit = ~lit & point.found & (magnitude<W>(cosine) < 0x1p-10f);  // rounding may have shut the gate
        const Colours<W> opened = scaled<W>(one_colour<W>(lamp.strength), arriving_share<F, W>(lamp, way) * open);
        possible = {unlit ? opened.r : possible.r, unlit ? opened.g : possible.g, unlit ? opened.b : possible.b};
      }
      rounding = rounding + rounding_of_lamp<W>(lamp, way, point, cosine, possible, diffuse, specular, exponent, bend, both_sides);
    }

    // 3. The two terms
    irradiance = masked<W>(lit, irradiance);
    sum = sum + scaled<W>(irradiance * diffuse, steepness);
    if constexpr (F::specular) {
      const Vectors<W> mirrored = times<W>(point.normal, 2.0f * cosine) - way.direction;
      Vectors<W> brightest = mirrored;
      Mask<W> has_lobe = lit;
      if constexpr (F::secondary) {
        const Mask<W> from_behind = lit & (cosine < 0.0f);
        if (any<W>(from_behind)) {
          const Floats<W> ior = point.material(scene, column_ior), one = all_of<W>(1.0f);
          const Bent<W> light = refracted<W>(times<W>(way.direction, all_of<W>(-1.0f)), point.normal, point.outside ? ior : one,
                                             point.outside ? one : ior);
          brightest = chosen<W>(from_behind, light.direction, mirrored);
          has_lobe &= ~(from_behind & light.total);
        }
      }
      const Floats<W> height = lobe<W>(brightest, point.to_viewer, exponent);
      sum = sum + scaled<W>(irradiance * specular, has_lobe ? height : Floats<W>{});
    }
  }
  return sum;
}

}  // namespace equilux::fast
