// Following the paths of one sample of model raytraced: what the picture and its sensitivity have in common.
//
// Secondary rays wait on a stack of their own, so that no recursion limit can exhaust the thread's: where each hit sends one, it never
// holds more than one; where each sends two, as many as the limit.
#pragma once

#include "ruled_path.h"

namespace equilux {

// The local terms: emission, ambient, and the lights on both sides. Returns them, not weighted.
template <class F> Bands local_terms_of_model(Tracing& tracing, const Visit& visit, const Moved& moved, Bands& rounding) {
  const World& world = tracing.world;
  const SurfacePoint& point = visit.point;
  const MaterialDescription& material = visit.material;
  const Vec3d normal = to_double(point.normal), to_viewer = to_double(point.to_viewer);
  const std::size_t lights = world.lights.size();
  const bool shines = material.diffuse.any() || material.specular.any();
  Bands sum = material.emission + material.ambient * world.description.ambient;

  for (std::size_t k = 0; k < lights; ++k) {
    // 1. What arrives, from which side, and how much that side counts
    const Arriving arriving = arriving_light<true>(world.lights[k], point);
    const double cosine = cosine_to_light(point, normal, arriving);
    double side = cosine > 0 ? 1 : 0;
    if constexpr (F::transparency) side = cosine > 0 ? 1 - material.transparency : cosine < 0 ? material.transparency : 0;
    const bool counts = side > 0 && arriving.in_cone && shines;

    // 2. The two terms
    Bands diffuse, specular;
    Shadow shadow;
    bool lobe_shines = false, total = false;
    if (counts) {
      if constexpr (F::occlusion) shadow = shadow_of(tracing, world.lights[k], point, arriving);
      const Bands irradiance = world.lights[k].given.strength * arriving.share * shadow.share * side;
      diffuse = irradiance * material.diffuse * std::fabs(cosine);
      if (material.specular.any() && irradiance.any()) {
        double lobe = 0;
        if (cosine > 0) {
          lobe = highlight(point, normal, to_viewer, arriving, cosine, material.exponent);
        } else {
          const Refraction light = refracted_light(point, material, arriving);
          total = light.total;
          lobe = transmitted_highlight(point, to_viewer, light, material.exponent);
        }
        specular = irradiance * material.specular * lobe;
        lobe_shines = lobe > 0;
      }
    }
    sum = sum + (diffuse + specular);

    // 3. Channels
    if constexpr (F::channels) {
      if (visit.used == 0) {
        if (tracing.out.diffuse) write(tracing.out.diffuse, visit.sample * lights + k, diffuse);
        if (tracing.out.specular) write(tracing.out.specular, visit.sample * lights + k, specular);
      }
      if (F::rounding && counts) rounding = rounding + rounding_of_path_light(world.lights[k], arriving, material, side, shadow, moved);
      tracing.signature.add_light(cosine > 0, arriving.in_cone, lobe_shines && material.exponent < 1);
      if (counts) tracing.signature.add(shadow.crossed * 2 + (total ? 1 : 0));
    }
  }
  return sum;
}

template <class F> Onward onward_of_model(const SurfacePoint& point, const MaterialDescription& material) {
  Onward onward;
  const Bands mirrored = material.reflection * (1 - material.transparency);
  if constexpr (F::transparency) {
    if (material.transparency > 0) {
      const Refraction through = refracted_view(point, material);
      if (through.total) {
        onward.total = true;
        onward.add(mirrored_about(point.normal, point.to_viewer), {1, 1, 1}, Branch::reflected, mirror_bend);
        return onward;
      }
      onward.add(through.direction, material.transmission * material.transparency, Branch::transmitted, through.bend);
    }
  }
  if (mirrored.any()) onward.add(mirrored_about(point.normal, point.to_viewer), mirrored, Branch::reflected, mirror_bend);
  return onward;
}

template <class F> Bands local_terms(Tracing& tracing, const Visit& visit, const Moved& moved, Bands& rounding) {
  if constexpr (F::ruled) return ruled_local_terms<F>(tracing, visit, moved, rounding);
  return local_terms_of_model<F>(tracing, visit, moved, rounding);
}

template <class F> Onward onward_from(const Tracing& tracing, const Visit& visit) {
  const Rules& rules = tracing.world.description.rules;
  if constexpr (F::ruled) return ruled_onward(rules, visit.point, visit.material, ruled_indices_at(tracing, visit));
  return onward_of_model<F>(visit.point, visit.material);
}

// Whether the ray that led here was the last that is followed.
template <class F> bool at_the_limit(const Tracing& tracing, const Visit& visit) {
  if constexpr (F::ruled) return beyond_ruled_limit(tracing.world, visit);
  return visit.used >= tracing.world.description.recursion_limit;
}

// Puts the secondary rays of a visit on the stack. Rays of weight 0 are not followed, all others are.
template <class F> void send_secondary(Tracing& tracing, const Visit& visit, const Moved& moved) {
  if (at_the_limit<F>(tracing, visit)) return;
  Onward onward = onward_from<F>(tracing, visit);
  if constexpr (F::channels) tracing.signature.add(onward.total ? 3 : 4);
  if constexpr (F::ruled) keep_followed(tracing.world, visit, tracing.path_weight * visit.weight, onward);
  for (int i = 0; i < onward.count; ++i) {
    const Onward::Ray& ray = onward.rays[i];
    const Bands weight = visit.weight * ray.weight;
    if (!weight.any()) continue;
    Journey journey;
    if constexpr (F::ruled) journey = journey_beyond(tracing.world, tracing.media, visit, ray);
    const Branch branch = visit.branch == Branch::none ? ray.branch : visit.branch;
    tracing.pending.push_back({leaving(tracing.world, visit.point, ray.direction), weight, visit.used + 1, branch, {}, journey});
    if constexpr (F::rounding) tracing.pending.back().spread = spread_beyond(moved, visit.point, to_double(ray.direction), ray.bend);
  }
}

template <class F> void shade(Tracing& tracing, const Visit& visit) {
  Moved moved;
  if constexpr (F::channels) tracing.signature.add_surface(visit.point);
  if constexpr (F::channels && F::ruled) tracing.signature.add_normal(visit.point);
  if constexpr (F::rounding) moved = moved_by(tracing.world, visit.spread, visit.point);
  Bands rounding;
  const Bands local = local_terms<F>(tracing, visit, moved, rounding);
  tracing.add(visit.weight * local, visit.branch);
  if constexpr (F::rounding) {
    const double factors = 4 * visit.used + static_cast<double>(tracing.world.lights.size()) + 3;
    tracing.rounding = tracing.rounding + visit.weight * (rounding + local * factors);
    ++tracing.terms;
  }
  if constexpr (F::secondary) send_secondary<F>(tracing, visit, moved);
}

constexpr int rays_between_questions = 1024;  // whether the render has been cancelled

// Follows every ray on the stack to its end. False: cancelled.
template <class F> bool follow_all(Tracing& tracing, std::size_t sample, const Stopped& stopped) {
  int followed = 0;
  while (!tracing.pending.empty()) {
    if (++followed % rays_between_questions == 0 && stopped()) return false;
    const Pending next = tracing.pending.back();
    tracing.pending.pop_back();
    if constexpr (F::channels) tracing.signature.add(static_cast<std::uint64_t>(next.used));
    Candidate hit;
    if (!tracing.traversal.nearest(next.ray, hit)) {
      if constexpr (F::channels) tracing.signature.add(signature_of_a_miss);
      const Bands& background = tracing.world.description.background;
      tracing.add(next.weight * background, next.branch);
      if constexpr (F::rounding) {
        tracing.rounding = tracing.rounding + next.weight * background * (4 * next.used + 1.0);
        ++tracing.terms;
      }
      continue;
    }
    SurfacePoint point = surface_point(tracing.world, next.ray, hit);
    if constexpr (F::ruled) turn_normal(tracing.world.description.rules, point);
    const MaterialDescription& material = material_of(tracing.world, point.object);
    shade<F>(tracing, {point, material, next.weight, next.used, next.branch, sample, next.spread, next.journey});
  }
  return true;
}

}  // namespace equilux
