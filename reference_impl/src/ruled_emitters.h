// Model reflection_equation under changed rules. Delta lights follow the local formulas of ruled_light.h. Of the integrals over emitters
// these rules are known: the side and direction of N and V, occlusion, vertex lighting, light from behind (|N·ω| in place of max(0, N·ω);
// the highlight without a gate, or about −N: one and the same, since R about −N is R about N), and the highlight's cosine. The others
// (half_vector, specular_floor, shadow_bias_m) leave emitters alone.
#pragma once

#include "direct_light.h"
#include "ruled_light.h"
#include "ruled_shadow.h"

namespace equilux {

inline Bands specular_coefficient(const MaterialDescription& material) {
  return material.brdf == Brdf::lambert ? Bands{} : material.specular;
}

// A phong_cosine highlight has its cosine already, and gets no second one.
inline bool highlight_has_cosine(const Rules& rules, const MaterialDescription& material) {
  return material.brdf == Brdf::phong_cosine || rules.highlight_cosine;
}

inline bool ruled_visibility(ShadowRays& shadows, const World& world, const Light& light, const SurfacePoint& place,
                             const Arriving& arriving) {
  const Rules& rules = world.description.rules;
  return !rules.occlusion || biased_shadow(shadows, world, light, place, arriving).share.any();
}

inline Reflecting ruled_reflecting(const Rules& rules, const ShadedPoint& point, const Vec3d& to_viewer,
                                   const MaterialDescription& material) {
  Reflecting at;
  at.point = point;
  at.specular = specular_coefficient(material).any();
  if (at.specular) {
    const Vec3d mirrored = unit(point.normal * (2 * dot(point.normal, to_viewer)) - to_viewer);
    at.lobe = Lobe(mirrored, point.normal, material.exponent, highlight_has_cosine(rules, material));
  }
  return at;
}

inline ShadedPoint shaded_point(const SurfacePoint& place) {
  return {place.position, to_double(place.normal), place.object, normal_is_outward(place)};
}

// The integrals over one emitter, about N, and about −N where light from behind counts.
inline Integral ruled_integral(DirectLight& direct, int emitter, const Rules& rules, const Reflecting& at, Terms weight,
                               double error_target) {
  Integral total = direct.from(emitter, at, weight, error_target);
  const Terms behind{rules.diffuse_two_sided ? weight.diffuse : 0,
                     rules.highlight_two_sided || rules.highlight_ungated ? weight.specular : 0};
  if (behind.diffuse > 0 || behind.specular > 0) {
    Reflecting other = at;
    other.point.normal = -at.point.normal;
    other.point.outside = !at.point.outside;
    if (at.specular) other.lobe = Lobe(at.lobe.mirrored, other.point.normal, at.lobe.exponent, at.lobe.with_cosine);
    const Integral from_behind = direct.from(emitter, other, behind, error_target);
    total.value = total.value + from_behind.value;
    total.error = total.error + from_behind.error;
    total.reached = total.reached && from_behind.reached;
  }
  // With R below the horizon a lobe's tail is all that is left, and its quadrature may leave −1e-35.
  total.value = {std::fmax(0, total.value.diffuse), std::fmax(0, total.value.specular)};
  return total;
}

}  // namespace equilux
