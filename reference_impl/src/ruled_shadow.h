// Shadow rays that miss what is near the surface: the rule `shadow_bias_m`.
#pragma once

#include <limits>

#include "phong.h"
#include "transport.h"

namespace equilux {

// With no bias at all: the model's own shadow.
inline Shadow biased_shadow(ShadowRays& shadows, const World& world, const Light& light, const SurfacePoint& place,
                            const Arriving& arriving) {
  const Rules& rules = world.description.rules;
  const bool at_infinity = light.given.kind == LightKind::directional;
  const double infinity = std::numeric_limits<double>::infinity();
  if (rules.shadow_bias == ShadowBias::before_light && !at_infinity) {
    const double end = std::fmax(0, arriving.distance - rules.shadow_bias_m);
    return shadows.shadow(leaving(world, place, unit(arriving.toward)), end);
  }
  if (rules.shadow_bias != ShadowBias::along_normal || !(rules.shadow_bias_m > 0)) {
    Ray ray = leaving(world, place, at_infinity ? light.to_light : unit(arriving.toward));
    if (rules.shadow_bias_m > 0 && rules.shadow_bias == ShadowBias::along_ray) {
      ray.from.displaced = true;
      ray.from.start = std::fmax(ray.from.start, rules.shadow_bias_m);
    }
    return shadows.shadow(ray, at_infinity ? infinity : arriving.distance);
  }
  const Vec3dd off = place.normal * DoubleDouble(rules.shadow_bias_m), toward = arriving.toward - off;
  SurfacePoint start = place;
  start.position = place.position + off;
  start.position_size += rules.shadow_bias_m;
  Ray ray = leaving(world, start, at_infinity ? light.to_light : unit(toward));
  ray.from = {};  // it leaves no surface any more
  return shadows.shadow(ray, at_infinity ? infinity : length(to_double(toward)));
}

}  // namespace equilux
