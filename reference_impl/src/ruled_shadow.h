// Shadow rays that miss what is near the surface, or near the light: the rule `shadow_bias_m`.
#pragma once

#include <limits>

#include "phong.h"
#include "transport.h"

namespace equilux {

// From the surface itself, and what is near one of its ends is missed.
inline Shadow shortened_shadow(ShadowRays& shadows, const World& world, const Light& light, const SurfacePoint& place,
                               const Arriving& arriving) {
  const Rules& rules = world.description.rules;
  const bool at_infinity = light.given.kind == LightKind::directional;
  Ray ray = leaving(world, place, at_infinity ? light.to_light : unit(arriving.toward));
  if (rules.shadow_bias_m > 0 && rules.shadow_bias != ShadowBias::before_light) {
    ray.from.displaced = true;
    ray.from.start = std::fmax(ray.from.start, rules.shadow_bias_m);
  }
  if (at_infinity) return shadows.shadow(ray, std::numeric_limits<double>::infinity());
  const double missed = rules.shadow_bias == ShadowBias::along_ray ? 0 : rules.shadow_bias_m;
  return shadows.shadow(ray, std::fmax(0, arriving.distance - missed));
}

// The way from the surface to where the shadow ray starts.
inline Vec3dd off_the_surface(const Rules& rules, const SurfacePoint& place, const Vec3dd& to_light) {
  const bool face = rules.shadow_bias == ShadowBias::along_lit_face;
  const Vec3dd normal = face ? direction_of(exactly(place.geometric)) : place.normal;
  const bool away = rules.shadow_bias != ShadowBias::along_normal && to_double(dot(normal, to_light)) < 0;
  return normal * DoubleDouble(away ? -rules.shadow_bias_m : rules.shadow_bias_m);
}

// With no bias at all: the model's own shadow.
inline Shadow biased_shadow(ShadowRays& shadows, const World& world, const Light& light, const SurfacePoint& place,
                            const Arriving& arriving) {
  const Rules& rules = world.description.rules;
  const ShadowBias bias = rules.shadow_bias;
  const bool from_surface = bias == ShadowBias::along_ray || bias == ShadowBias::before_light || bias == ShadowBias::both_ends;
  if (from_surface || !(rules.shadow_bias_m > 0)) {
    return shortened_shadow(shadows, world, light, place, arriving);
  }
  const bool at_infinity = light.given.kind == LightKind::directional;
  const Vec3dd to_light = at_infinity ? light.to_light : unit(arriving.toward);
  const Vec3dd off = off_the_surface(rules, place, to_light), toward = arriving.toward - off;
  SurfacePoint start = place;
  start.position = place.position + off;
  start.position_size += rules.shadow_bias_m;
  const bool aimed = !at_infinity && bias != ShadowBias::not_aimed;
  Ray ray = leaving(world, start, aimed ? unit(toward) : to_light);
  ray.from = {};  // it leaves no surface any more
  if (at_infinity) return shadows.shadow(ray, std::numeric_limits<double>::infinity());
  return shadows.shadow(ray, aimed ? length(to_double(toward)) : arriving.distance);
}

}  // namespace equilux
