// The local formulas under changed rules: what one light's E K_diff and E K_spec are multiplied with.
//
//     phong, opengl:  diffuse (N·L)⁺,  highlight [gate] (R·V)⁺^p or (N·H)⁺^p
//     raytraced:      L_1 and L_2 with what they count, front and behind below: (1 − t) and t
//
// Each rule is one line here. Rounding: every formula is one of phong.h's or opengl.h's lobes at N or −N, times at most |N·L|, so that
// their bounds added up hold.
#pragma once

#include "raytraced.h"
#include "ruled_point.h"

namespace equilux {

// What the two sums of model raytraced count; in the other models, which have but one, 1 and 0.
struct SideWeights {
  double front = 1, front_highlight = 1, behind = 0, behind_highlight = 0;

  bool has_front() const { return front > 0 || front_highlight > 0; }
};

// opaque_behind: L_2 also where t = 0. That says nothing unless its weight t is ignored.
inline bool has_behind(const Rules& rules, const MaterialDescription& material) {
  return material.transparency > 0 || (rules.opaque_behind && !rules.behind_weighted);
}

inline SideWeights side_weights(const World& world, const MaterialDescription& material) {
  SideWeights weights;
  if (world.description.model != Model::raytraced) return weights;
  const Rules& rules = world.description.rules;
  const double t = material.transparency;
  weights.front = rules.front_weighted ? 1 - t : 1;
  weights.front_highlight = rules.highlight_weighted ? weights.front : 1;
  weights.behind = !has_behind(rules, material) ? 0 : rules.behind_weighted ? t : 1;
  weights.behind_highlight = rules.transmitted_highlight ? weights.behind : 0;
  return weights;
}

// The indices on the viewer's side and beyond; the model's own: 1 outside the object that was hit, ior inside.
struct Indices {
  double here = 1, beyond = 1;
};

inline Indices own_indices(const SurfacePoint& point, const MaterialDescription& material) {
  return {index_in_front(point, material), index_behind(point, material)};
}

// What does not depend on the light. Made once per place, from what is there before anything moves.
struct Formula {
  const Rules& rules;
  SideWeights weights;
  double exponent;
  bool specular;     // there is a highlight at all
  bool cosine;       // which carries the receiver's cosine
  bool half_vector;  // N·H in place of R·V
  bool even;         // opengl.h: a highlight of exponent 0 is 1 wherever its gate is open

  Formula(const World& world, const MaterialDescription& material)
      : rules(world.description.rules),
        weights(side_weights(world, material)),
        exponent(material.exponent),
        specular(material.specular.any() && !(equation(world) && material.brdf == Brdf::lambert)),
        cosine(rules.highlight_cosine || (equation(world) && material.brdf == Brdf::phong_cosine)),
        half_vector((world.description.model == Model::opengl) != rules.half_vector),
        even(world.description.model == Model::opengl && material.exponent == 0) {}

  static bool equation(const World& world) { return world.description.model == Model::reflection_equation; }

  bool shines(bool in_front, bool behind) const {
    return (in_front && weights.has_front()) || (behind && weights.behind > 0) || (rules.diffuse_two_sided && behind) ||
           ((rules.highlight_ungated || rules.highlight_two_sided) && specular);
  }
};

struct LightShares {
  double diffuse = 0, specular = 0;
  bool highlit = false;  // some lobe is above 0
};

// |N·L| where light from behind counts, else max(0, N·L).
inline double diffuse_share(const Formula& formula, double cosine) {
  const SideWeights& weights = formula.weights;
  if (formula.rules.diffuse_two_sided) {
    const double behind = formula.rules.two_sided_behind ? std::fabs(cosine) : std::fmax(0, -cosine);
    return std::fabs(cosine) * weights.front + behind * weights.behind;
  }
  return cosine > 0 ? cosine * weights.front : -cosine * weights.behind;
}

// max(floor, cos)^p, of a lobe max(0, cos)^p.
inline double floored(const Formula& formula, double lobe) {
  const double floor = formula.rules.specular_floor;
  return floor > 0 ? std::fmax(lobe, std::pow(floor, formula.exponent)) : lobe;
}

// What the highlights are multiplied with under `highlight_cosine`, and by brdf phong_cosine.
inline double highlight_cosine(const Formula& formula, double cosine, bool behind) {
  if (!formula.cosine) return 1;
  return behind || formula.rules.highlight_ungated ? std::fabs(cosine) : std::fmax(0, cosine);
}

// in_front, behind: the gates, which a sensitivity holds while N·L moves. lobe(side): (R·V)⁺^p or (N·H)⁺^p about side × N, side ±1.
// transmitted(): (T·V)⁺^p.
template <class Lobe, class Transmitted>
LightShares light_shares(const Formula& formula, double cosine, bool in_front, bool behind, const Lobe& lobe,
                         const Transmitted& transmitted) {
  const Rules& rules = formula.rules;
  const SideWeights& weights = formula.weights;
  LightShares shares;
  shares.diffuse = diffuse_share(formula, cosine);
  if (!formula.specular) return shares;
  const bool about_back = behind && rules.highlight_two_sided;
  const double incidence = highlight_cosine(formula, cosine, behind);
  if (weights.front_highlight > 0 && (in_front || about_back || rules.highlight_ungated)) {
    const double mirrored = formula.even ? 1 : lobe(about_back ? -1.0 : 1.0);
    shares.highlit |= mirrored > 0;
    shares.specular += weights.front_highlight * floored(formula, mirrored) * incidence;
  }
  if (weights.behind_highlight > 0 && behind) {
    const double through = transmitted();
    shares.highlit |= through > 0;
    shares.specular += weights.behind_highlight * floored(formula, through) * (rules.cosine_behind ? incidence : 1);
  }
  return shares;
}

// (N·H)⁺^p about side × N, by opengl.h's H.
inline double half_vector_lobe(const SurfacePoint& place, const Arriving& arriving, double side, double exponent) {
  const Vec3d halfway = half_vector(arriving, place.to_viewer);
  if (!(largest(halfway) > 0)) return 0;
  return power_of_cosine(to_double(place.normal) * side, halfway, exponent, [&] {
    return side * to_double(dot(place.normal, direction_of(unit(arriving.toward) + place.to_viewer)));
  });
}

// T of a light behind N, out of the medium behind N: as raytraced.h's, with the indices on N's sides, whichever side is seen.
inline Refraction ruled_refracted_light(const SurfacePoint& place, const Indices& indices, const Arriving& arriving) {
  const bool seen_in_front = normal_is_outward(place) == place.outside;  // N on the viewer's side
  const double front = seen_in_front ? indices.here : indices.beyond, behind = seen_in_front ? indices.beyond : indices.here;
  return refracted(-unit(arriving.toward), place.normal, behind, front);
}

// One light at a place of find_lit_places, to the digits of phong.h.
struct RuledLight {
  Arriving arriving;
  double cosine = 0;
  LightShares shares;
  bool total = false;  // its T is totally reflected

  bool in_front() const { return cosine > 0; }
  // What the signature must tell apart: without a gate, N·L = 0 is no discontinuity.
  bool gate(const Rules& rules) const { return rules.highlight_ungated || in_front(); }
};

inline RuledLight ruled_light(const Formula& formula, const Light& light, const SurfacePoint& place, const Indices& indices) {
  RuledLight result;
  result.arriving = arriving_light<true>(light, place);
  const Vec3d normal = to_double(place.normal), to_viewer = to_double(place.to_viewer);
  const Arriving& arriving = result.arriving;
  const double cosine = result.cosine = cosine_to_light(place, normal, arriving);
  if (!arriving.in_cone || !(arriving.share > 0) || !formula.shines(cosine > 0, cosine < 0)) return result;
  const auto lobe = [&](double side) {
    if (formula.half_vector) return half_vector_lobe(place, arriving, side, formula.exponent);
    return highlight(place, normal, to_viewer, arriving, cosine, formula.exponent);  // R about −N is R about N
  };
  const auto transmitted = [&] {
    const Refraction through = ruled_refracted_light(place, indices, arriving);
    result.total = through.total;
    return transmitted_highlight(place, to_viewer, through, formula.exponent);
  };
  result.shares = light_shares(formula, cosine, cosine > 0, cosine < 0, lobe, transmitted);
  return result;
}

}  // namespace equilux
