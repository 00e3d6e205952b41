// What W surface points emit and reflect: phong.h and path.h in the same operations, for point and directional lights.
#pragma once

#include <cmath>

#include "surface_packet.h"

namespace equilux::packets {

template <int W> struct Colours {
  Doubles<W> r{}, g{}, b{};
};
template <int W> inline Colours<W> product_of(const Colours<W>& a, const Colours<W>& b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
template <int W> inline Colours<W> product_of(const Colours<W>& a, Doubles<W> s) { return {a.r * s, a.g * s, a.b * s}; }
template <int W> inline Colours<W> sum_of(const Colours<W>& a, const Colours<W>& b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
template <int W> inline Colours<W> where(Longs<W> mask, const Colours<W>& a) {
  return {mask ? a.r : Doubles<W>{}, mask ? a.g : Doubles<W>{}, mask ? a.b : Doubles<W>{}};
}
template <int W> inline Longs<W> any_of(const Colours<W>& a) { return (a.r != 0.0) | (a.g != 0.0) | (a.b != 0.0); }
template <int W> inline Colours<W> all(const Bands& bands) { return {all<W>(bands.r), all<W>(bands.g), all<W>(bands.b)}; }

// The materials of W lanes.
template <int W> struct Materials {
  Colours<W> diffuse, specular, own;  // own: K_emit + K_amb L_amb
  Doubles<W> exponent;

  Materials(const World& world, Longs<W> lanes, Longs<W> object) {
    constexpr std::int64_t stride = sizeof(MaterialDescription) / sizeof(double);
    static_assert(sizeof(MaterialDescription) % sizeof(double) == 0);
    Longs<W> place;
    for (int i = 0; i < W; ++i) {
      place[i] = lanes[i] != 0 ? world.objects[static_cast<std::size_t>(object[i])].material * stride : 0;
    }
    const MaterialDescription& first = world.description.materials.front();
    const auto colours = [&](const Bands& part) -> Colours<W> {
      return {gathered<W>(&part.r, place), gathered<W>(&part.g, place), gathered<W>(&part.b, place)};
    };
    diffuse = colours(first.diffuse);
    specular = colours(first.specular);
    exponent = gathered<W>(&first.exponent, place);
    own = sum_of<W>(colours(first.emission), product_of<W>(colours(first.ambient), all<W>(world.description.ambient)));
  }
};

// One light as W points see it: Arriving, and N·L.
template <int W> struct Arrivals {
  ExactPoint<W> toward;      // unit: the shadow ray's direction
  Point<W> to_light;
  Doubles<W> distance, share, cosine;  // distance: infinite for a directional light
  Longs<W> in_front;
};

// cosine_to_light. toward: exact, not unit, of length `distance`.
template <int W>
inline void cosines(Arrivals<W>& at, const Surfaces<W>& surface, const Point<W>& normal, const ExactPoint<W>& toward,
                    Doubles<W> distance, Longs<W>& undecided) {
  at.cosine = dot(normal, at.to_light);
  const Longs<W> small = surface.hit & (magnitude<W>(at.cosine) <= 0x1p-10);
  if (any<W>(small)) {
    at.cosine = small ? to_double(dot(surface.normal, toward)) / distance : at.cosine;
    const Doubles<W> position_size = largest<W>(rounded<W>(surface.position)) / distance;
    undecided |= small & ~(magnitude<W>(at.cosine) > larger<W>(all<W>(0x1p-40), 0x1p-80 * (1.0 + position_size)));
  }
  at.in_front = surface.hit & (at.cosine > 0.0);
}

template <int W>
inline Arrivals<W> arriving(const Light& light, const Surfaces<W>& surface, const Point<W>& normal, Longs<W>& undecided) {
  Arrivals<W> at;
  if (light.given.kind == LightKind::directional) {
    at.toward = all<W>(light.to_light);
    at.to_light = all<W>(light.to_light_rounded);
    at.distance = all<W>(std::numeric_limits<double>::infinity());
    at.share = all<W>(1);
    cosines<W>(at, surface, normal, at.toward, all<W>(1), undecided);
  } else {
    const ExactPoint<W> apart = all<W>(light.position) - surface.position;
    const Point<W> toward = rounded<W>(apart);
    const Doubles<W> r2 = dot(toward, toward), r = square_root(r2), scale = 1.0 / r;
    undecided |= surface.hit & ~(r > 0.0);
    at.distance = r;
    at.to_light = toward * scale;
    at.toward = {apart.x * scale, apart.y * scale, apart.z * scale};
    at.share = 1.0 / (light.given.constant + light.given.linear * r + light.given.quadratic * r2);
    cosines<W>(at, surface, normal, apart, r, undecided);
  }
  return at;
}

// max(0, R·V)^p for the lanes that ask for it.
template <int W>
inline Doubles<W> highlights(Longs<W> lanes, const Point<W>& normal, const Point<W>& to_viewer, const Arrivals<W>& at,
                             Doubles<W> exponent, Longs<W>& undecided) {
  const Point<W> mirrored = normal * (2.0 * at.cosine) - at.to_light, apart = mirrored - to_viewer;
  const Doubles<W> versine = 0.5 * dot(apart, apart), cosine = 1.0 - versine;
  const Longs<W> dark = cosine < -0x1p-40, plain = cosine >= (exponent < 1.0 ? all<W>(0.125) : all<W>(0x1p-40));
  undecided |= lanes & ~dark & ~plain;
  Doubles<W> lobe{};
  for (unsigned rest = packed<W>(lanes & plain); rest != 0; rest &= rest - 1) {
    const int i = __builtin_ctz(rest);
    lobe[i] = std::exp(exponent[i] * std::log1p(-versine[i]));
  }
  return lobe;
}

}  // namespace equilux::packets
