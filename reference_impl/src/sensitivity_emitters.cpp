// Sensitivity of model reflection_equation: see sensitivity.h.
#include <algorithm>

#include "moved_formula.h"
#include "precision.h"
#include "ruled_emitters.h"
#include "sensitivity.h"
#include "transport.h"

namespace equilux {
namespace {

// What is known of a lit place before anything moves.
struct Held {
  const World* world = nullptr;
  const MaterialDescription* material = nullptr;
  const Formula* formula = nullptr;
  Bands specular;                // K_spec, 0 for lambert
  int object = 0;
  bool outside = true;           // N points outward
  Vec3dd position;               // eye-relative
  Vec3d normal, to_viewer;
  std::vector<HeldLight> lights;  // delta lights; shadow 0: they do not count
  double nearest_emitter = 0;    // metres
};

// Of the integrals, and least steps: so the integrals' error is a hundredth of the change that is looked for.
constexpr double error_target = 1e-6, least_step = 1e-4;

Bands from_delta_light(const Held& at, std::size_t k, const Vec3dd& position, const Vec3d& normal, const Vec3d& to_viewer) {
  if (!at.lights[k].shadow.any()) return {};
  const Light& light = at.world->lights[k];
  const LightDescription& given = light.given;
  Vec3d to_light;
  double share;
  if (!seen_from_moved(light, to_double(light.position - position), to_light, share)) return {};
  const LightShares shares = moved_shares(*at.formula, at.lights[k], normal, to_light, to_viewer, 1);
  return given.strength * (at.material->diffuse * shares.diffuse + at.specular * shares.specular) * share;
}

Bands reflected(const Held& at, DirectLight& direct, const Vec3dd& position, const Vec3d& normal, const Vec3d& to_viewer) {
  const World& world = *at.world;
  Bands sum;
  for (std::size_t k = 0; k < world.lights.size(); ++k) sum = sum + from_delta_light(at, k, position, normal, to_viewer);
  const Rules& rules = world.description.rules;
  const Reflecting here = ruled_reflecting(rules, {position, normal, at.object, at.outside}, to_viewer, *at.material);
  const auto add = [&](int emitter, const Bands& emitted) {
    const Bands diffuse = emitted * at.material->diffuse, specular = emitted * at.specular;
    const Terms seen = ruled_integral(direct, emitter, rules, here, {largest(diffuse), largest(specular)}, error_target).value;
    sum = sum + diffuse * seen.diffuse + specular * seen.specular;
  };
  for (std::size_t k = 0; k < world.description.emitters.size(); ++k) add(static_cast<int>(k), world.description.emitters[k].radiance);
  if (world.description.has_environment) add(-1, world.description.background);
  return sum;
}

Bands larger_change(const Bands& base, const Bands& plus, const Bands& minus) {
  const auto change = [](double here, double a, double b) { return std::max(std::fabs(a - here), std::fabs(b - here)); };
  return {change(base.r, plus.r, minus.r), change(base.g, plus.g, minus.g), change(base.b, plus.b, minus.b)};
}

void hold(const World& world, const SurfacePoint& place, const Formula& formula, ShadowRays& shadows, Held& at) {
  at.world = &world;
  at.material = &material_of(world, place.object);
  at.formula = &formula;
  at.specular = specular_coefficient(*at.material);
  at.object = place.object;
  at.outside = normal_is_outward(place);
  at.position = place.position;
  at.normal = to_double(place.normal);
  at.to_viewer = to_double(place.to_viewer);
  at.lights.resize(world.lights.size());
  for (std::size_t k = 0; k < world.lights.size(); ++k) {
    Arriving arriving;
    HeldLight& held = at.lights[k] = held_light(world.lights[k], place, arriving);
    const bool counts = held.in_cone && formula.shines(held.in_front, held.behind);
    if (!counts || !ruled_visibility(shadows, world, world.lights[k], place, arriving)) held.shadow = {};
  }
  at.nearest_emitter = length(to_double(at.position));
  for (const EmitterDescription& emitter : world.description.emitters) {
    const double distance = length(to_double(difference(emitter.a, world.camera.eye) - at.position));
    at.nearest_emitter = std::min(at.nearest_emitter, distance);
  }
}

// A step of the size asked for, or a larger one whose effect is scaled down: the integrals' own error must not drown it.
struct Step {
  double size = 0, share = 1;

  Step(double asked, double least) : size(std::max(asked, least)), share(size > 0 ? asked / size : 0) {}
};

Bands change_of(const Held& at, DirectLight& direct, double normal_bound, double position_bound) {
  const double width = at.specular.any() ? 1 / std::sqrt(at.material->exponent + 1) : 1;
  const Step normal_step(normal_bound, least_step * width), position_step(position_bound, least_step * width * at.nearest_emitter);
  Vec3d tangent[2];
  complete_frame(at.normal, tangent[0], tangent[1]);
  const Bands base = reflected(at, direct, at.position, at.normal, at.to_viewer);
  const auto turned = [&](const Vec3d& step) { return reflected(at, direct, at.position, unit(at.normal + step), at.to_viewer); };
  const auto moved = [&](const Vec3d& step) {
    const Vec3dd position = at.position + exactly(step);
    const Vec3d rounded = to_double(position);
    const bool follows = viewer_follows(*at.world) && largest(rounded) > 0;
    return reflected(at, direct, position, at.normal, follows ? -unit(rounded) : at.to_viewer);
  };
  Bands total;
  for (const Vec3d& t : tangent) {
    if (!(normal_bound > 0)) break;
    total = total + larger_change(base, turned(t * normal_step.size), turned(t * -normal_step.size)) * normal_step.share;
  }
  for (const Vec3d& u : {tangent[0], tangent[1], at.normal}) {
    if (!(position_bound > 0)) break;
    total = total + larger_change(base, moved(u * position_step.size), moved(u * -position_step.size)) * position_step.share;
  }
  return total;
}

Bands change_at(const World& world, SurfacePoint& point, const GeometricBounds& bounds, DirectLight& direct, ShadowRays& shadows, Held& at) {
  const std::size_t object = static_cast<std::size_t>(point.object);
  const double normal_bound = bounds.normal[object], position_bound = bounds.position_m[object];
  const Formula formula(world, material_of(world, point.object));
  turn_normal(world.description.rules, point);
  LitPlaces places;
  find_lit_places(world, point, true, places);
  const auto change = [&](int j) {
    hold(world, places.at[j], formula, shadows, at);
    return change_of(at, direct, normal_bound, position_bound);
  };
  const auto radiance = [&](int j) {
    hold(world, places.at[j], formula, shadows, at);
    return reflected(at, direct, at.position, at.normal, at.to_viewer);
  };
  return change_over_places(world, point, places, position_bound, change, radiance);
}

}  // namespace

bool sensitivity_emitters(const World& world, const Samples& samples, const GeometricBounds& bounds, double* out, int threads,
                          const Cancel* cancel, const Interrupted& interrupted) {
  const Obstacles obstacles(world);
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    Search search;
    search.world = &world;
    SurfacePoint point;
    DirectLight direct(obstacles);
    ShadowRays shadows(world);
    Held at;
    for (std::size_t i = begin; i < end && !stopped(); ++i) {
      double x, y;
      samples.position(i, x, y);
      Bands total;
      if (Exact::find(world, search, x, y, point) && point.object < world.first_emitter()) {
        total = change_at(world, point, bounds, direct, shadows, at);
      }
      out[3 * i] = total.r;
      out[3 * i + 1] = total.g;
      out[3 * i + 2] = total.b;
    }
  });
}

}  // namespace equilux
