#include "sensitivity.h"

#include <algorithm>

#include "moved_formula.h"
#include "precision.h"

namespace equilux {
namespace {

// A lit place in double, and what its lights did there: the signature to be held. Steps are many orders larger than a double's rounding,
// which is why no double-double is needed here.
struct Held {
  const World* world = nullptr;
  const MaterialDescription* material = nullptr;
  const Formula* formula = nullptr;
  Vec3d position, normal, to_viewer;
  bool viewer_follows = false;  // V points to the eye point
  std::vector<HeldLight> lights;
};

// The shares of a light are 1, and its ambient one 0, in all models but opengl.
Bands from_light(const Held& at, std::size_t k, const Vec3d& position, const Vec3d& normal, const Vec3d& to_viewer) {
  if (!at.lights[k].in_cone) return {};
  const Light& light = at.world->lights[k];
  const LightDescription& given = light.given;
  Vec3d to_light;
  double share;
  if (!seen_from_moved(light, to_double(light.position) - position, to_light, share)) return {};
  const LightShares shares = moved_shares(*at.formula, at.lights[k], normal, to_light, to_viewer, 1);
  const Bands reflected = at.material->diffuse * given.diffuse * shares.diffuse + at.material->ambient * given.ambient +
                          at.material->specular * given.specular * shares.specular;
  return given.strength * reflected * share;
}

// What changes with N and P; emission and ambient do not.
Bands reflected(const Held& at, const Vec3d& position, const Vec3d& normal, const Vec3d& to_viewer) {
  Bands sum;
  for (std::size_t k = 0; k < at.world->lights.size(); ++k) sum = sum + from_light(at, k, position, normal, to_viewer);
  return sum;
}

Bands with_normal(const Held& at, const Vec3d& step) { return reflected(at, at.position, unit(at.normal + step), at.to_viewer); }

Bands with_position(const Held& at, const Vec3d& step) {
  const Vec3d position = at.position + step;
  const bool follows = at.viewer_follows && largest(position) > 0;
  return reflected(at, position, at.normal, follows ? -unit(position) : at.to_viewer);
}

Bands larger_change(const Bands& base, const Bands& plus, const Bands& minus) {
  const auto change = [](double here, double a, double b) { return std::max(std::fabs(a - here), std::fabs(b - here)); };
  return {change(base.r, plus.r, minus.r), change(base.g, plus.g, minus.g), change(base.b, plus.b, minus.b)};
}

void hold(const World& world, const SurfacePoint& place, const Formula& formula, Held& at) {
  at.world = &world;
  at.material = &material_of(world, place.object);
  at.formula = &formula;
  at.position = to_double(place.position);
  at.normal = to_double(place.normal);
  at.to_viewer = to_double(place.to_viewer);
  at.viewer_follows = viewer_follows(world);
  Arriving arriving;
  for (std::size_t k = 0; k < world.lights.size(); ++k) at.lights[k] = held_light(world.lights[k], place, arriving);
}

Bands change_of(const Held& at, double normal_step, double position_step) {
  Vec3d tangent[2];
  complete_frame(at.normal, tangent[0], tangent[1]);
  const Bands base = reflected(at, at.position, at.normal, at.to_viewer);
  Bands total;
  for (const Vec3d& t : tangent) {
    if (normal_step > 0) total = total + larger_change(base, with_normal(at, t * normal_step), with_normal(at, t * -normal_step));
  }
  for (const Vec3d& u : {tangent[0], tangent[1], at.normal}) {
    if (position_step > 0) total = total + larger_change(base, with_position(at, u * position_step), with_position(at, u * -position_step));
  }
  return total;
}

Bands change_at(const World& world, SurfacePoint& point, const GeometricBounds& bounds, Held& at) {
  const std::size_t object = static_cast<std::size_t>(point.object);
  const double normal_step = bounds.normal[object], position_step = bounds.position_m[object];
  const Formula formula(world, material_of(world, point.object));
  turn_normal(world.description.rules, point);
  LitPlaces places;
  find_lit_places(world, point, true, places);
  const auto change = [&](int j) {
    hold(world, places.at[j], formula, at);
    return change_of(at, normal_step, position_step);
  };
  const auto radiance = [&](int j) {
    hold(world, places.at[j], formula, at);
    return reflected(at, at.position, at.normal, at.to_viewer);
  };
  return change_over_places(world, point, places, position_step, change, radiance);
}

}  // namespace

bool sensitivity(const World& world, const Samples& samples, const GeometricBounds& bounds, double* out, int threads,
                 const Cancel* cancel, const Interrupted& interrupted) {
  const std::size_t objects = static_cast<std::size_t>(world.first_emitter());
  if (bounds.normal.size() != objects || bounds.position_m.size() != objects) throw TracerError("sensitivity: one bound per object");
  if (world.description.model == Model::raytraced) {
    return sensitivity_raytraced(world, samples, bounds, out, threads, cancel, interrupted);
  }
  if (world.description.model == Model::reflection_equation) {
    return sensitivity_emitters(world, samples, bounds, out, threads, cancel, interrupted);
  }
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end) {
    Search search;
    search.world = &world;
    SurfacePoint point;
    Held at;
    at.lights.resize(world.lights.size());
    for (std::size_t i = begin; i < end; ++i) {
      double x, y;
      samples.position(i, x, y);
      Bands total;
      if (Exact::find(world, search, x, y, point)) total = change_at(world, point, bounds, at);
      out[3 * i] = total.r;
      out[3 * i + 1] = total.g;
      out[3 * i + 2] = total.b;
    }
  });
}

}  // namespace equilux
