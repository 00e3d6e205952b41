// Sensitivity of model reflection_equation: see sensitivity.h.
#include <algorithm>

#include "direct_light.h"
#include "moved_light.h"
#include "phong.h"
#include "precision.h"
#include "sensitivity.h"
#include "transport.h"

namespace equilux {
namespace {

// What is known of the point before anything moves.
struct Held {
  const World* world = nullptr;
  const MaterialDescription* material = nullptr;
  Bands specular;                // K_spec, 0 for lambert
  bool with_cosine = false;      // phong_cosine
  int object = 0;
  bool outside = true;
  Vec3dd position;               // eye-relative
  Vec3d normal, to_viewer;
  std::vector<char> shines;      // delta lights: in front, in the cone, and visible
  double nearest_emitter = 0;    // metres
};

// Of the integrals, and least steps: so the integrals' error is a hundredth of the change that is looked for.
constexpr double error_target = 1e-6, least_step = 1e-4;

Bands from_delta_light(const Held& at, std::size_t k, const Vec3dd& position, const Vec3d& normal, const Vec3d& to_viewer) {
  if (!at.shines[k]) return {};
  const Light& light = at.world->lights[k];
  const LightDescription& given = light.given;
  Vec3d to_light;
  double share;
  if (!seen_from_moved(light, to_double(light.position - position), to_light, share)) return {};
  const double cosine = std::max(0.0, dot(normal, to_light));
  const double mirrored = 2 * dot(normal, to_light) * dot(normal, to_viewer) - dot(to_light, to_viewer);
  const double lobe = power(mirrored, at.material->exponent) * (at.with_cosine ? cosine : 1);
  return given.strength * (at.material->diffuse * cosine + at.specular * lobe) * share;
}

Bands reflected(const Held& at, DirectLight& direct, const Vec3dd& position, const Vec3d& normal, const Vec3d& to_viewer) {
  const World& world = *at.world;
  Bands sum;
  for (std::size_t k = 0; k < world.lights.size(); ++k) sum = sum + from_delta_light(at, k, position, normal, to_viewer);
  Reflecting here;
  here.point = {position, normal, at.object, at.outside};
  here.specular = at.specular.any();
  if (here.specular) {
    here.lobe = Lobe(unit(normal * (2 * dot(normal, to_viewer)) - to_viewer), normal, at.material->exponent, at.with_cosine);
  }
  const auto add = [&](int emitter, const Bands& emitted) {
    const Bands diffuse = emitted * at.material->diffuse, specular = emitted * at.specular;
    const Terms seen = direct.from(emitter, here, {largest(diffuse), largest(specular)}, error_target).value;
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

void hold(const World& world, const SurfacePoint& point, ShadowRays& shadows, Held& at) {
  at.world = &world;
  at.material = &material_of(world, point.object);
  at.specular = at.material->brdf == Brdf::lambert ? Bands{} : at.material->specular;
  at.with_cosine = at.material->brdf == Brdf::phong_cosine;
  at.object = point.object;
  at.outside = point.outside;
  at.position = point.position;
  at.normal = to_double(point.normal);
  at.to_viewer = to_double(point.to_viewer);
  for (std::size_t k = 0; k < world.lights.size(); ++k) {
    const Arriving arriving = arriving_light<true>(world.lights[k], point);
    at.shines[k] = false;
    if (!arriving.in_cone || !(cosine_to_light(point, at.normal, arriving) > 0)) continue;
    const bool at_infinity = world.lights[k].given.kind == LightKind::directional;
    const Vec3dd direction = at_infinity ? arriving.toward : unit(arriving.toward);
    const double distance = at_infinity ? std::numeric_limits<double>::infinity() : arriving.distance;
    at.shines[k] = shadows.shadow(leaving(world, point, direction), distance).share.any();
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
    const bool follows = at.world->camera.perspective() && largest(rounded) > 0;
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
    at.shines.resize(world.lights.size());
    for (std::size_t i = begin; i < end && !stopped(); ++i) {
      double x, y;
      samples.position(i, x, y);
      Bands total;
      if (Exact::find(world, search, x, y, point) && point.object < world.first_emitter()) {
        const std::size_t object = static_cast<std::size_t>(point.object);
        hold(world, point, shadows, at);
        total = change_of(at, direct, bounds.normal[object], bounds.position_m[object]);
      }
      out[3 * i] = total.r;
      out[3 * i + 1] = total.g;
      out[3 * i + 2] = total.b;
    }
  });
}

}  // namespace equilux
