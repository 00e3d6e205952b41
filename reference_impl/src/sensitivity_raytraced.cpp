#include <algorithm>

#include "moved_formula.h"
#include "path.h"
#include "precision.h"
#include "sensitivity.h"

namespace equilux {
namespace {

template <bool ChangedRules> using Everything = PathFeatures<true, true, true, true, false, ChangedRules>;

constexpr double step_shares[] = {1.0, 1.0 / 8, 1.0 / 64, 1.0 / 512, 1.0 / 4096};

Bands operator-(const Bands& a, const Bands& b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }

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
  Journey journey;
  LitPlaces places;                        // where the local terms come from
  std::vector<HeldLight> lights;           // place by place
  double ratio = 1;                        // of the index behind N to that in front
  Onward onward;
  Found found[2];

  Visit visit(const SurfacePoint& at) const { return {at, *material, weight, used, Branch::none, 0, {}, journey}; }
};

struct Step {
  Vec3d normal, position;
};

// One thread's search through the hits of a sample.
template <class F> class Steps {
 public:
  Steps(const World& world, const GeometricBounds& bounds, const Stopped& stopped)
      : world_(world), bounds_(bounds), stopped_(stopped), tracing_(world, nothing_), traversal_(world) {}

  // False: stopped.
  bool total_of(const FilmRay& ray, SurfacePoint& first, Bands& total);

 private:
  bool visit(Hit& hit, Bands& total);
  void hold(Hit& hit);
  // displaced_m: how far a step has moved the point off its surface.
  Found follow(const Hit& hit, const SurfacePoint& point, const Onward::Ray& ray, double displaced_m);
  // The local terms of place j, with all that is held there.
  Bands local(const Hit& hit, int j, const SurfacePoint& place) const;
  Bands from_light(const Hit& hit, int j, std::size_t k, const SurfacePoint& place) const;
  SurfacePoint stepped(const Hit& hit, SurfacePoint point, const Step& step) const;
  Bands local_change(const Hit& hit, int j, const Step& step) const;
  Bands onward_change(const Hit& hit, const Step& step, Bands sum);  // added to sum
  bool branch_change(const Hit& hit, int branch, const Step& step, double share, Bands& result);
  template <class Change> Bands over_steps(const Vec3d& normal, double normal_step, double position_step, const Change& change);

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
    Journey journey;
  };
  std::vector<Waiting> waiting_;
};

// --- the local terms ----------------------------------------------------------------------------------------------------

template <class F> Bands Steps<F>::from_light(const Hit& hit, int j, std::size_t k, const SurfacePoint& place) const {
  const HeldLight& held = hit.lights[static_cast<std::size_t>(j) * world_.lights.size() + k];
  if (!held.in_cone) return {};
  const Light& light = world_.lights[k];
  Vec3d to_light;
  double share;
  if (!seen_from_moved(light, to_double(light.position) - to_double(place.position), to_light, share)) return {};
  const Formula formula(world_, *hit.material);
  const LightShares shares = moved_shares(formula, held, to_double(place.normal), to_light, to_double(place.to_viewer), hit.ratio);
  const Bands reflected = hit.material->diffuse * shares.diffuse + hit.material->specular * shares.specular;
  return light.given.strength * held.shadow * reflected * share;
}

template <class F> Bands Steps<F>::local(const Hit& hit, int j, const SurfacePoint& place) const {
  Bands sum;
  for (std::size_t k = 0; k < world_.lights.size(); ++k) sum = sum + from_light(hit, j, k, place);
  return sum;
}

// --- what is held -------------------------------------------------------------------------------------------------------

template <class F> Found Steps<F>::follow(const Hit& hit, const SurfacePoint& point, const Onward::Ray& onward, double displaced_m) {
  Ray ray = leaving(world_, point, onward.direction);
  if (displaced_m > 0) {
    ray.from.displaced = true;
    ray.from.start += 2 * displaced_m / std::max(0.05, across_surface(point, to_double(onward.direction)));
  }
  tracing_.begin();
  Journey journey;
  if constexpr (F::ruled) journey = journey_beyond(world_, tracing_.media, hit.visit(point), onward);
  // Weight 1, so that its radiance is what it brings; what a rule cuts off by weight is cut by that of the whole path.
  tracing_.path_weight = hit.weight * onward.weight;
  tracing_.pending.push_back({ray, {1, 1, 1}, hit.used + 1, Branch::none, {}, journey});
  complete_ &= follow_all<F>(tracing_, 0, stopped_);
  return {tracing_.radiance, tracing_.signature.value()};
}

template <class F> void Steps<F>::hold(Hit& hit) {
  find_lit_places(world_, hit.point, hit.used == 0, hit.places);
  const Formula formula(world_, *hit.material);
  const Indices indices = ruled_indices_at(tracing_, hit.visit(hit.point));
  const bool seen_in_front = normal_is_outward(hit.point) == hit.point.outside;
  hit.ratio = seen_in_front ? indices.beyond / indices.here : indices.here / indices.beyond;
  const std::size_t lights = world_.lights.size();
  hit.lights.assign(lights * static_cast<std::size_t>(hit.places.count), {});
  for (int j = 0; j < hit.places.count; ++j) {
    const SurfacePoint& place = hit.places.at[j];
    for (std::size_t k = 0; k < lights; ++k) {
      Arriving arriving;
      HeldLight& held = hit.lights[static_cast<std::size_t>(j) * lights + k] = held_light(world_.lights[k], place, arriving);
      const bool counts = held.in_cone && formula.shines(held.in_front, held.behind);
      if (counts) held.shadow = ruled_shadow_of(tracing_, world_.lights[k], place, arriving).share;
    }
  }
  for (int i = 0; i < hit.onward.count; ++i) hit.found[i] = follow(hit, hit.point, hit.onward.rays[i], 0);
}

// --- steps --------------------------------------------------------------------------------------------------------------

template <class F> SurfacePoint Steps<F>::stepped(const Hit& hit, SurfacePoint point, const Step& step) const {
  if (largest(step.normal) > 0) point.normal = direction_of(point.normal + exactly(step.normal));
  if (largest(step.position) > 0) {
    point.position = point.position + exactly(step.position);
    if (hit.used == 0 && world_.camera.perspective()) point.to_viewer = -direction_of(point.position);
  }
  return point;
}

template <class F> Bands Steps<F>::local_change(const Hit& hit, int j, const Step& step) const {
  SurfacePoint place = stepped(hit, hit.places.at[j], step);
  if constexpr (F::ruled) {
    // V of the highlights, where it is not that of the path.
    const Viewer viewer = viewer_there(world_.description.rules, hit.used == 0);
    if (viewer == Viewer::fixed || (viewer == Viewer::from_eye && largest(step.position) > 0)) {
      place.to_viewer = ruled_viewer(world_, place, hit.used == 0);
    }
  }
  return local(hit, j, place) - local(hit, j, hit.places.at[j]);
}

// False: the ray's path is another one.
template <class F> bool Steps<F>::branch_change(const Hit& hit, int branch, const Step& step, double share, Bands& result) {
  const Step part{step.normal * share, step.position * share};
  const SurfacePoint point = stepped(hit, hit.point, part);
  Onward onward = onward_from<F>(tracing_, hit.visit(point));
  if constexpr (F::ruled) keep_followed(world_, hit.visit(point), hit.weight, onward);
  if (onward.total != hit.onward.total || onward.count != hit.onward.count) return false;
  const Found found = follow(hit, point, onward.rays[branch], length(part.position));
  if (found.signature != hit.found[branch].signature) return false;
  result = onward.rays[branch].weight * (found.radiance - hit.found[branch].radiance) * (1 / share);
  return true;
}

template <class F> Bands Steps<F>::onward_change(const Hit& hit, const Step& step, Bands sum) {
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

template <class F>
template <class Change>
Bands Steps<F>::over_steps(const Vec3d& normal, double normal_step, double position_step, const Change& change) {
  Vec3d tangent[2];
  complete_frame(normal, tangent[0], tangent[1]);
  const auto larger_change = [&](const Step& step) {
    const Step back{-step.normal, -step.position};
    return larger(magnitude(change(step)), magnitude(change(back)));
  };
  Bands sum;
  for (const Vec3d& t : tangent) {
    if (normal_step > 0) sum = sum + larger_change({t * normal_step, {}});
  }
  for (const Vec3d& u : {tangent[0], tangent[1], normal}) {
    if (position_step > 0) sum = sum + larger_change({{}, u * position_step});
  }
  return sum;
}

template <class F> bool Steps<F>::visit(Hit& hit, Bands& total) {
  const std::size_t object = static_cast<std::size_t>(hit.point.object);
  const double normal_step = bounds_.normal[object], position_step = bounds_.position_m[object];
  if (!at_the_limit<F>(tracing_, hit.visit(hit.point))) {
    hit.onward = onward_from<F>(tracing_, hit.visit(hit.point));
    if constexpr (F::ruled) keep_followed(world_, hit.visit(hit.point), hit.weight, hit.onward);
  }
  if (normal_step > 0 || position_step > 0) {
    hold(hit);
    const Vec3d normal = to_double(hit.point.normal);
    const auto all = [&](const Step& step) { return onward_change(hit, step, local_change(hit, 0, step)); };
    const auto onward = [&](const Step& step) { return onward_change(hit, step, {}); };
    if (hit.places.count == 1) {
      total = total + hit.weight * over_steps(normal, normal_step, position_step, all);
    } else {  // the places' own errors and that of the point are different ones
      const auto change = [&](int j) {
        const auto at_place = [&](const Step& step) { return local_change(hit, j, step); };
        return over_steps(to_double(hit.places.at[j].normal), normal_step, position_step, at_place);
      };
      const auto radiance = [&](int j) { return local(hit, j, hit.places.at[j]); };
      const Bands sum = change_over_places(world_, hit.point, hit.places, position_step, change, radiance) +
                        over_steps(normal, normal_step, position_step, onward);
      total = total + hit.weight * sum;
    }
  }
  for (int i = 0; i < hit.onward.count; ++i) {
    const Bands weight = hit.weight * hit.onward.rays[i].weight;
    Journey journey;
    if constexpr (F::ruled) journey = journey_beyond(world_, tracing_.media, hit.visit(hit.point), hit.onward.rays[i]);
    if (weight.any()) waiting_.push_back({leaving(world_, hit.point, hit.onward.rays[i].direction), weight, hit.used + 1, journey});
  }
  return complete_;
}

template <class F> bool Steps<F>::total_of(const FilmRay& ray, SurfacePoint& first, Bands& total) {
  Hit hit;
  if constexpr (F::ruled) hit.journey = first_journey(tracing_, ray, first);
  hit.point = first;
  hit.material = &material_of(world_, first.object);
  hit.weight = {1, 1, 1};
  waiting_.clear();
  if (!visit(hit, total)) return false;
  while (!waiting_.empty()) {
    if (stopped_()) return false;
    const Waiting next = waiting_.back();
    waiting_.pop_back();
    Candidate found;
    if (!traversal_.nearest(next.ray, found)) continue;
    hit.point = surface_point(world_, next.ray, found);
    if constexpr (F::ruled) turn_normal(world_.description.rules, hit.point);
    hit.material = &material_of(world_, hit.point.object);
    hit.weight = next.weight;
    hit.used = next.used;
    hit.journey = next.journey;
    hit.onward = {};
    if (!visit(hit, total)) return false;
  }
  return true;
}

template <class F>
bool run(const World& world, const Samples& samples, const GeometricBounds& bounds, double* out, int threads, const Cancel* cancel,
         const Interrupted& interrupted) {
  return for_each_chunk(samples.count, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    Search search;
    search.world = &world;
    SurfacePoint point;
    Steps<F> steps(world, bounds, stopped);
    for (std::size_t i = begin; i < end; ++i) {
      double x, y;
      samples.position(i, x, y);
      Bands total;
      if (Exact::find(world, search, x, y, point) && !steps.total_of(search.film_ray, point, total)) return;
      out[3 * i] = total.r;
      out[3 * i + 1] = total.g;
      out[3 * i + 2] = total.b;
    }
  });
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
  const auto run_with = world.description.rules.changed() ? run<Everything<true>> : run<Everything<false>>;
  return run_with(world, samples, bounds, out, threads, cancel, interrupted);
}

}  // namespace equilux
