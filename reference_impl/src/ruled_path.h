// Model raytraced under changed rules: its local terms, its secondary rays, the media that they are in.
#pragma once

#include "path_state.h"
#include "ruled_light.h"
#include "ruled_shadow.h"

namespace equilux {

// --- media and limits -----------------------------------------------------------------------------------------------------

inline bool follows_media(const Rules& rules) { return rules.nested_media || rules.media_counted; }

// Whether the ray goes into the object rather than out of it: by the side that was hit, or under `media_counted` by what it is in.
inline bool enters(const Rules& rules, const Media& media, int medium, const SurfacePoint& point) {
  return rules.media_counted ? !media.contains(medium, point.object) : point.outside;
}

// Under `nested_media` entering an object leads from the innermost of the media that the ray is in into the object, leaving it from the
// innermost into what is innermost without it. An object that was not entered (the eye is in it) has its own index all the same.
inline Indices ruled_indices_at(const Tracing& tracing, const Visit& visit) {
  const World& world = tracing.world;
  const SurfacePoint& point = visit.point;
  const int object = point.object, medium = visit.journey.medium;
  const Rules& rules = world.description.rules;
  if (!follows_media(rules)) {
    const Indices own = own_indices(point, visit.material);
    return rules.always_entering && !point.outside ? Indices{own.beyond, own.here} : own;
  }
  const double innermost = tracing.media.index(world, medium);
  if (!is_medium(world, object)) return {innermost, innermost};
  if (enters(rules, tracing.media, medium, point)) return {innermost, index_inside(world, object)};
  if (!tracing.media.contains(medium, object)) return {visit.material.ior, innermost};
  return {innermost, tracing.media.index_without(world, medium, object)};
}

// Whether the eye is inside the mesh that its ray met first.
inline bool seen_from_inside(const World& world, const SurfacePoint& point) {
  if (point.mesh < 0 || !is_medium(world, point.object)) return false;
  return point.outside == world.meshes[static_cast<std::size_t>(point.mesh)].inside_out;
}

// Of a camera ray: what there is to know before its first surface is shaded. The point gets the rules' N.
inline Journey first_journey(Tracing& tracing, const FilmRay& ray, SurfacePoint& point) {
  const World& world = tracing.world;
  Journey journey;
  const Rules& rules = world.description.rules;
  if (follows_media(rules)) {
    tracing.media.clear();
    journey.medium = tracing.media.around(world, world.camera.origin(ray));
    if (rules.media_counted && seen_from_inside(world, point)) journey.medium = tracing.media.entered(journey.medium, point.object);
  }
  turn_normal(rules, point);
  return journey;
}

inline Journey journey_beyond(const World& world, Media& media, const Visit& visit, const Onward::Ray& ray) {
  Journey journey = visit.journey;
  const bool through = ray.branch == Branch::transmitted;
  if (!through || world.description.rules.transmission_counted) ++journey.counted;
  const Rules& rules = world.description.rules;
  if (through && follows_media(rules) && is_medium(world, visit.point.object)) {
    const int object = visit.point.object, medium = journey.medium;
    journey.medium = enters(rules, media, medium, visit.point) ? media.entered(medium, object) : media.left(medium, object);
  }
  return journey;
}

// Whether no ray at all goes on from here. Rays that do not count go on where others have come to their limit.
inline bool beyond_ruled_limit(const World& world, const Visit& visit) {
  if (!world.description.rules.transmission_counted) return visit.used >= most_uncounted;
  return visit.journey.counted >= world.description.recursion_limit;
}

// Takes out the rays that are not followed: whose weight (on the whole path, or alone) is below the cut, or that are beyond the limit.
inline void keep_followed(const World& world, const Visit& visit, const Bands& path_weight, Onward& onward) {
  const Rules& rules = world.description.rules;
  int kept = 0;
  for (int i = 0; i < onward.count; ++i) {
    const Onward::Ray& ray = onward.rays[i];
    const bool counts = ray.branch != Branch::transmitted || rules.transmission_counted;
    if (counts && visit.journey.counted >= world.description.recursion_limit) continue;
    if (largest(rules.weight_cut_alone ? ray.weight : path_weight * ray.weight) < rules.weight_cut) continue;
    onward.rays[kept++] = ray;
  }
  onward.count = kept;
}

// --- secondary rays -------------------------------------------------------------------------------------------------------

// What a totally reflected ray counts.
inline Bands total_weight(const Rules& rules, const MaterialDescription& material, const Bands& mirrored, const Bands& through) {
  const double t = material.transparency;
  switch (rules.total_reflection) {
    case TotalReflection::one: break;
    case TotalReflection::mirror: return mirrored;
    case TotalReflection::transmitted: return mirrored + through;
    case TotalReflection::none: return {};
    case TotalReflection::k_refl: return material.reflection;
    case TotalReflection::one_minus_t: return {1 - t, 1 - t, 1 - t};
    case TotalReflection::through: return through;
    case TotalReflection::k_trans: return material.transmission;
    case TotalReflection::t: return {t, t, t};
    case TotalReflection::mirror_and_t: return mirrored + Bands{t, t, t};
  }
  return {1, 1, 1};
}

// The indices by which the transmitted ray bends.
inline Indices indices_of_view(const Rules& rules, const SurfacePoint& point, const Indices& indices) {
  switch (rules.transmitted_ray) {
    case TransmittedRay::straight: return {};
    case TransmittedRay::inverted: return {indices.beyond, indices.here};
    case TransmittedRay::entering: return point.outside ? indices : Indices{indices.beyond, indices.here};
    default: return indices;
  }
}

inline Onward ruled_onward(const Rules& rules, const SurfacePoint& point, const MaterialDescription& material, const Indices& indices) {
  Onward onward;
  const double t = material.transparency;
  const Bands mirrored = material.reflection * (rules.front_weighted ? 1 - t : 1);
  const Vec3dd mirror = mirrored_about(point.normal, point.to_viewer);
  if (has_behind(rules, material)) {
    const Bands through = material.transmission * (rules.behind_weighted ? t : 1);
    const Indices of_view = indices_of_view(rules, point, indices);
    const Refraction refraction = refracted(-point.to_viewer, point.normal, of_view.here, of_view.beyond);
    if (refraction.total) {
      onward.total = true;
      onward.add(mirror, total_weight(rules, material, mirrored, through), Branch::reflected, mirror_bend);
      return onward;
    }
    if (rules.transmitted_ray != TransmittedRay::none) onward.add(refraction.direction, through, Branch::transmitted, refraction.bend);
  }
  if (mirrored.any()) onward.add(mirror, mirrored, Branch::reflected, mirror_bend);
  return onward;
}

// --- local terms ----------------------------------------------------------------------------------------------------------

// As shadow_of, by the rules.
inline Shadow ruled_shadow_of(Tracing& tracing, const Light& light, const SurfacePoint& place, const Arriving& arriving) {
  const Rules& rules = tracing.world.description.rules;
  if (!rules.occlusion) return {};
  if (!(rules.shadow_bias_m > 0)) return shadow_of(tracing, light, place, arriving);
  return biased_shadow(tracing.shadows, tracing.world, light, place, arriving);
}

// As the model's, at each of the lit places.
template <class F> Bands ruled_local_terms(Tracing& tracing, const Visit& visit, const Moved& moved, Bands& rounding) {
  const World& world = tracing.world;
  const MaterialDescription& material = visit.material;
  const Formula formula(world, material);
  const Indices indices = ruled_indices_at(tracing, visit);
  LitPlaces places;
  find_lit_places(world, visit.point, visit.used == 0, places);
  const std::size_t lights = world.lights.size();
  const double most = formula.weights.front + formula.weights.front_highlight + formula.weights.behind;
  Bands sum = material.emission + material.ambient * world.description.ambient;

  for (std::size_t k = 0; k < lights; ++k) {
    const Light& light = world.lights[k];
    Bands diffuse, specular;
    for (int j = 0; j < places.count; ++j) {
      const RuledLight lit = ruled_light(formula, light, places.at[j], indices);
      const bool counts = (lit.shares.diffuse > 0 && material.diffuse.any()) || lit.shares.specular > 0;
      Shadow shadow;
      if (counts) {
        shadow = ruled_shadow_of(tracing, light, places.at[j], lit.arriving);
        const Bands irradiance = light.given.strength * shadow.share * (lit.arriving.share * places.weight[j]);
        diffuse = diffuse + irradiance * material.diffuse * lit.shares.diffuse;
        specular = specular + irradiance * material.specular * lit.shares.specular;
      }
      if constexpr (F::channels) {
        if (F::rounding && lit.arriving.in_cone) {
          const double share = most * places.weight[j] * (1 + Rounding::diffuse / Rounding::lobe(material.exponent));
          rounding = rounding + rounding_of_path_light(light, lit.arriving, material, share, shadow, moved);
        }
        tracing.signature.add_light(lit.in_front(), lit.arriving.in_cone, lit.shares.highlit && material.exponent < 1);
        if (counts) tracing.signature.add(shadow.crossed * 2 + (lit.total ? 1 : 0));
      }
    }
    sum = sum + (diffuse + specular);
    if constexpr (F::channels) {
      if (visit.used == 0) {
        if (tracing.out.diffuse) write(tracing.out.diffuse, visit.sample * lights + k, diffuse);
        if (tracing.out.specular) write(tracing.out.specular, visit.sample * lights + k, specular);
      }
    }
  }
  return sum;
}

}  // namespace equilux
