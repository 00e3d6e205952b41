// The local formula at a place that has been moved, in double, with what its lights did before held: what every model's sensitivity needs,
// under the model's rules and changed ones alike.
#pragma once

#include "moved_light.h"
#include "ruled_light.h"

namespace equilux {

// What one light did at the unmoved place.
struct HeldLight {
  bool in_front = false, behind = false, in_cone = false;
  Bands shadow{1, 1, 1};
};

inline HeldLight held_light(const Light& light, const SurfacePoint& place, Arriving& arriving) {
  arriving = arriving_light<true>(light, place);
  const double cosine = cosine_to_light(place, to_double(place.normal), arriving);
  return {cosine > 0, cosine < 0, arriving.in_cone, {1, 1, 1}};
}

inline Vec3d unit_or_zero(const Vec3d& v) { return largest(v) > 0 ? unit(v) : Vec3d{}; }

// d, unit, refracted with the ratio of indices; 0 on total reflection.
inline Vec3d bent(const Vec3d& d, const Vec3d& normal, double ratio) {
  const double c = dot(normal, d), rest = 1 - ratio * ratio * (1 - c * c);
  if (rest < 0) return {};
  return d * ratio + normal * ((c < 0 ? -1 : 1) * std::sqrt(rest) - ratio * c);
}

// ratio: the index behind N over that in front. The diffuse term has no gate and follows N·L.
inline LightShares moved_shares(const Formula& formula, const HeldLight& held, const Vec3d& normal, const Vec3d& to_light,
                                const Vec3d& to_viewer, double ratio) {
  const double cosine = dot(normal, to_light);
  const auto lobe = [&](double side) {
    const double lobe_cosine = formula.half_vector ? side * dot(normal, unit_or_zero(to_light + to_viewer))
                                                   : 2 * cosine * dot(normal, to_viewer) - dot(to_light, to_viewer);
    return power(lobe_cosine, formula.exponent);
  };
  const auto transmitted = [&] { return power(dot(bent(-to_light, normal, ratio), to_viewer), formula.exponent); };
  return light_shares(formula, cosine, held.in_front, held.behind, lobe, transmitted);
}

// Whether V, of the first surface, points to the eye point from wherever the surface is.
inline bool viewer_follows(const World& world) {
  const Viewer viewer = viewer_there(world.description.rules, true);
  if (viewer != Viewer::model) return viewer == Viewer::from_eye;
  return world.description.model == Model::opengl ? !world.description.infinite_viewer : world.camera.perspective();
}

inline Bands magnitude(const Bands& a) { return {std::fabs(a.r), std::fabs(a.g), std::fabs(a.b)}; }
inline Bands larger(const Bands& a, const Bands& b) { return {std::max(a.r, b.r), std::max(a.g, b.g), std::max(a.b, b.b)}; }

// Over the places where a point is lit. Each place's own geometry may be off, so that their changes add up with their weights; where it is
// more than one, the point may also lie elsewhere between them, and get other weights. change(j): the sum of steps at place j, radiance(j):
// what it sends; both of what changes with geometry.
template <class Change, class Radiance>
Bands change_over_places(const World& world, const SurfacePoint& point, const LitPlaces& places, double position_step, const Change& change,
                         const Radiance& radiance) {
  Bands total, at[3];
  for (int j = 0; j < places.count; ++j) total = total + change(j) * places.weight[j];
  if (places.count == 1 || !(position_step > 0)) return total;
  for (int j = 0; j < places.count; ++j) at[j] = radiance(j);
  Vec3d tangent[2];
  complete_frame(unit(point.geometric), tangent[0], tangent[1]);
  for (const Vec3d& t : tangent) {
    Bands largest_move;
    for (const double step : {position_step, -position_step}) {
      double weight[3];
      corner_weights(world, point, point.position + exactly(t * step), weight);
      Bands moved;
      for (int j = 0; j < 3; ++j) moved = moved + at[j] * (weight[j] - places.weight[j]);
      largest_move = larger(largest_move, magnitude(moved));
    }
    total = total + largest_move;
  }
  return total;
}

}  // namespace equilux
