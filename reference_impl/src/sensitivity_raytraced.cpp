#include <algorithm>

#include "moved_light.h"
#include "path.h"
#include "precision.h"
#include "sensitivity.h"

namespace equilux {
namespace {

using Everything = PathFeatures<true, true, true, true, false>;

constexpr double step_shares[] = {1.0, 1.0 / 8, 1.0 / 64, 1.0 / 512, 1.0 / 4096};

Bands operator-(const Bands& a, const Bands& b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
Bands magnitude(const Bands& a) { return {std::fabs(a.r), std::fabs(a.g), std::fabs(a.b)}; }
Bands larger(const Bands& a, const Bands& b) { return {std::max(a.r, b.r), std::max(a.g, b.g), std::max(a.b, b.b)}; }

// What a light does at the unmoved point, to be held.
struct HeldLight {
  bool in_front = false, in_cone = false;
  Bands shadow{1, 1, 1};
};

// A secondary ray's radiance and signature.
struct Found {
  Bands radiance;
  std::uint64_t signature = 0;
};

// A hit with all that is held there.
struct Hit {
  SurfacePoint point;
  const MaterialDescription* material = nullptr;
  Bands weight;
  int used = 0;
  std::vector<HeldLight> lights;
  Onward onward;
  Found found[2];
};

struct Step {
  Vec3d normal, position;
};

// One thread's search through the hits of a sample.
class Steps {
 public:
  Steps(const World& world, const GeometricBounds& bounds, const Stopped& stopped)
      : world_(world), bounds_(bounds), stopped_(stopped), tracing_(world, nothing_), traversal_(world) {}

  // False: stopped.
  bool total_of(const SurfacePoint& first, Bands& total);

 private:
  bool visit(Hit& hit, Bands& total);
  void hold(Hit& hit);
  // displaced_m: how far a step has moved the point off its surface.
  Found follow(const SurfacePoint& point, const Vec3dd& direction, int used, double displaced_m);
  Bands local(const Hit& hit, const SurfacePoint& point) const;
  Bands from_light(const Hit& hit, std::size_t k, const Vec3d& position, const Vec3d& normal, const Vec3d& to_viewer) const;
  SurfacePoint stepped(const Hit& hit, const Step& step) const;
  Bands change(const Hit& hit, const Step& step);
  bool branch_change(const Hit& hit, int branch, const Step& step, double share, Bands& result);
  Bands larger_change(const Hit& hit, const Step& step);

  const World& world_;
  const GeometricBounds& bounds_;
  const Stopped& stopped_;
  const Outputs nothing_;
  Tracing tracing_;
  Traversal traversal_;
  bool complete_ = true;

  struct Waiting {
    Ray ray;
    Bands weight;
    int used;
  };
  std::vector<Waiting> waiting_;
};

// --- the local terms ----------------------------------------------------------------------------------------------------

Vec3d bent(const Vec3d& d, const Vec3d& normal, double ratio) {
  const double c = dot(normal, d), rest = 1 - ratio * ratio * (1 - c * c);
  if (rest < 0) return {};
  return d * ratio + normal * ((c < 0 ? -1 : 1) * std::sqrt(rest) - ratio * c);
}

Bands Steps::from_light(const Hit& hit, std::size_t k, const Vec3d& position, const Vec3d& normal, const Vec3d& to_viewer) const {
  const HeldLight& held = hit.lights[k];
  if (!held.in_cone) return {};
  const Light& light = world_.lights[k];
  const LightDescription& given = light.given;
  const MaterialDescription& material = *hit.material;
  Vec3d to_light;
  double share;
  if (!seen_from_moved(light, to_double(light.position) - position, to_light, share)) return {};
  const double cosine = dot(normal, to_light), t = material.transparency;
  Bands reflected = material.diffuse * (cosine > 0 ? (1 - t) * cosine : -t * cosine);
  if (material.specular.any()) {
    const double ratio = index_behind(hit.point, material) / index_in_front(hit.point, material);
    const Vec3d lobe = held.in_front ? normal * (2 * cosine) - to_light : bent(-to_light, normal, ratio);
    reflected = reflected + material.specular * ((held.in_front ? 1 - t : t) * power(dot(lobe, to_viewer), material.exponent));
  }
  return given.strength * held.shadow * reflected * share;
}

Bands Steps::local(const Hit& hit, const SurfacePoint& point) const {
  Bands sum;
  for (std::size_t k = 0; k < world_.lights.size(); ++k) {
    sum = sum + from_light(hit, k, to_double(point.position), to_double(point.normal), to_double(point.to_viewer));
  }
  return sum;
}

// --- what is held -------------------------------------------------------------------------------------------------------

Found Steps::follow(const SurfacePoint& point, const Vec3dd& direction, int used, double displaced_m) {
  Ray ray = leaving(world_, point, direction);
  if (displaced_m > 0) {
    ray.from.displaced = true;
    ray.from.start += 2 * displaced_m / std::max(0.05, across_surface(point, to_double(direction)));
  }
  tracing_.begin();
  tracing_.pending.push_back({ray, {1, 1, 1}, used, Branch::none, {}, {}});
  complete_ &= follow_all<Everything>(tracing_, 0, stopped_);
  return {tracing_.radiance, tracing_.signature.value()};
}

void Steps::hold(Hit& hit) {
  const Vec3d normal = to_double(hit.point.normal);
  const double t = hit.material->transparency;
  hit.lights.assign(world_.lights.size(), {});
  for (std::size_t k = 0; k < world_.lights.size(); ++k) {
    const Arriving arriving = arriving_light<true>(world_.lights[k], hit.point);
    const double cosine = cosine_to_light(hit.point, normal, arriving);
    HeldLight& held = hit.lights[k];
    held.in_front = cosine > 0;
    held.in_cone = arriving.in_cone;
    const bool counts = cosine > 0 ? t < 1 : cosine < 0 && t > 0;
    if (counts && arriving.in_cone) held.shadow = shadow_of(tracing_, world_.lights[k], hit.point, arriving).share;
  }
  for (int i = 0; i < hit.onward.count; ++i) hit.found[i] = follow(hit.point, hit.onward.rays[i].direction, hit.used + 1, 0);
}

// --- steps --------------------------------------------------------------------------------------------------------------

SurfacePoint Steps::stepped(const Hit& hit, const Step& step) const {
  SurfacePoint point = hit.point;
  if (largest(step.normal) > 0) point.normal = direction_of(point.normal + exactly(step.normal));
  if (largest(step.position) > 0) {
    point.position = point.position + exactly(step.position);
    if (hit.used == 0 && world_.camera.perspective()) point.to_viewer = -direction_of(point.position);
  }
  return point;
}

// False: the ray's path is another one.
bool Steps::branch_change(const Hit& hit, int branch, const Step& step, double share, Bands& result) {
  const Step part{step.normal * share, step.position * share};
  const SurfacePoint point = stepped(hit, part);
  const Onward onward = onward_of_model<Everything>(point, *hit.material);
  if (onward.total != hit.onward.total || onward.count != hit.onward.count) return false;
  const Found found = follow(point, onward.rays[branch].direction, hit.used + 1, length(part.position));
  if (found.signature != hit.found[branch].signature) return false;
  result = onward.rays[branch].weight * (found.radiance - hit.found[branch].radiance) * (1 / share);
  return true;
}

Bands Steps::change(const Hit& hit, const Step& step) {
  Bands sum = local(hit, stepped(hit, step)) - local(hit, hit.point);
  for (int branch = 0; branch < hit.onward.count; ++branch) {
    Bands moved;
    for (const double share : step_shares) {
      if (branch_change(hit, branch, step, share, moved)) {
        sum = sum + moved;
        break;
      }
    }
  }
  return sum;
}

Bands Steps::larger_change(const Hit& hit, const Step& step) {
  const Step back{-step.normal, -step.position};
  return larger(magnitude(change(hit, step)), magnitude(change(hit, back)));
}

bool Steps::visit(Hit& hit, Bands& total) {
  const std::size_t object = static_cast<std::size_t>(hit.point.object);
  const double normal_step = bounds_.normal[object], position_step = bounds_.position_m[object];
  if (hit.used < world_.description.recursion_limit) hit.onward = onward_of_model<Everything>(hit.point, *hit.material);
  if (normal_step > 0 || position_step > 0) {
    hold(hit);
    const Vec3d normal = to_double(hit.point.normal);
    Vec3d tangent[2];
    complete_frame(normal, tangent[0], tangent[1]);
    Bands sum;
    for (const Vec3d& t : tangent) {
      if (normal_step > 0) sum = sum + larger_change(hit, {t * normal_step, {}});
    }
    for (const Vec3d& u : {tangent[0], tangent[1], normal}) {
      if (position_step > 0) sum = sum + larger_change(hit, {{}, u * position_step});
    }
    total = total + hit.weight * sum;
  }
  for (int i = 0; i < hit.onward.count; ++i) {
    const Bands weight = hit.weight * hit.onward.rays[i].weight;
    if (weight.any()) waiting_.push_back({leaving(world_, hit.point, hit.onward.rays[i].direction), weight, hit.used + 1});
  }
  return complete_;
}

bool Steps::total_of(const SurfacePoint& first, Bands& total) {
  Hit hit{first, &material_of(world_, first.object), {1, 1, 1}, 0, {}, {}, {}};
  waiting_.clear();
  if (!visit(hit, total)) return false;
  while (!waiting_.empty()) {
    if (stopped_()) return false;
    const Waiting next = waiting_.back();
    waiting_.pop_back();
    Candidate found;
    if (!traversal_.nearest(next.ray, found)) continue;
    hit.point = surface_point(world_, next.ray, found);
    hit.material = &material_of(world_, hit.point.object);
    hit.weight = next.weight;
    hit.used = next.used;
    hit.onward = {};
    if (!visit(hit, total)) return false;
  }
  return true;
}

}  // namespace

bool sensitivity_raytraced(const World& world, const Samples& samples, const GeometricBounds& bounds, double* out, int threads,
                           const Cancel* cancel, const Interrupted& interrupted) {
  const auto none = [](const std::vector<double>& of_objects) {
    return std::all_of(of_objects.begin(), of_objects.end(), [](double bound) { return bound == 0; });
  };
  if (none(bounds.normal) && none(bounds.position_m)) {
    std::fill_n(out, 3 * samples.count, 0.0);
    return true;
  }
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    Search search;
    search.world = &world;
    SurfacePoint point;
    Steps steps(world, bounds, stopped);
    for (std::size_t i = begin; i < end; ++i) {
      double x, y;
      samples.position(i, x, y);
      Bands total;
      if (Exact::find(world, search, x, y, point) && !steps.total_of(point, total)) return;
      out[3 * i] = total.r;
      out[3 * i + 1] = total.g;
      out[3 * i + 2] = total.b;
    }
  });
}

}  // namespace equilux
