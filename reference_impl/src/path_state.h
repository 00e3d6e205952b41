// What following the paths of model raytraced needs to know: of a ray, of a visit to a surface, of a sample as a whole.
#pragma once

#include <vector>

#include "film.h"
#include "media.h"
#include "outputs.h"
#include "raytraced.h"
#include "stated.h"

namespace equilux {

// What the kernel is compiled for. Anything that is false here leaves no code behind. Of the combinations that scenes ask for, four are
// compiled (twice, with and without channels): nothing but the lights; with shadows; with mirrors too; with everything. A scene gets the
// least one that has all it needs. Under changed rules there is only one with everything.
template <bool Shadows, bool Mirrors, bool Glass, bool TermChannels, bool RoundingBound = TermChannels, bool ChangedRules = false>
struct PathFeatures {
  static constexpr bool occlusion = Shadows, reflection = Mirrors, transparency = Glass;
  static constexpr bool channels = TermChannels, rounding = RoundingBound;  // rounding: the bound, and the spread that it needs
  static constexpr bool secondary = Mirrors || Glass;
  static constexpr bool ruled = ChangedRules;
};

// How the first surface sent the ray whose contribution is being summed up.
enum class Branch { none, reflected, transmitted };

// A ray to be followed, and what its radiance counts.
struct Pending {
  Ray ray;
  Bands weight;
  int used = 0;  // of the recursion limit, this ray included
  Branch branch = Branch::none;
  Spread spread;
  Journey journey;
};

// What one thread has to itself. The sums are one sample's.
struct Tracing {
  const World& world;
  const Outputs& out;
  Traversal traversal;
  ShadowRays shadows;
  std::vector<Pending> pending;
  Media media;
  Bands radiance, reflected, transmitted, rounding;
  Signature signature;
  int terms = 0;  // that were summed up
  Bands path_weight{1, 1, 1};  // of the path on which the rays begin, where it is not the camera's: a rule cuts by the whole path's weight

  Tracing(const World& world, const Outputs& out) : world(world), out(out), traversal(world), shadows(world) {}

  bool undecided() { return traversal.undecided || shadows.undecided(); }

  void begin() {
    traversal.undecided = shadows.undecided() = false;
    radiance = reflected = transmitted = rounding = {};
    signature = {};
    terms = 0;
    pending.clear();
  }

  void add(const Bands& light, Branch branch) {
    radiance = radiance + light;
    if (branch == Branch::reflected) reflected = reflected + light;
    if (branch == Branch::transmitted) transmitted = transmitted + light;
  }
};

// A surface point on a path: the sample it belongs to, what its radiance counts, and how often the path has turned.
struct Visit {
  const SurfacePoint& point;
  const MaterialDescription& material;
  Bands weight{1, 1, 1};
  int used = 0;
  Branch branch = Branch::none;
  std::size_t sample = 0;
  Spread spread;
  Journey journey;
};

inline Shadow shadow_of(Tracing& tracing, const Light& light, const SurfacePoint& point, const Arriving& arriving) {
  const bool at_infinity = light.given.kind == LightKind::directional;
  // The exact way, of unit length to a double's rounding: where crossings lie is found to 2^-50 of the distance all the same.
  const double scale = 1 / arriving.distance;
  const Vec3dd toward{arriving.toward.x * scale, arriving.toward.y * scale, arriving.toward.z * scale};
  const Vec3dd& direction = at_infinity ? light.to_light : toward;
  const double distance = at_infinity ? std::numeric_limits<double>::infinity() : arriving.distance;
  return tracing.shadows.shadow(leaving(tracing.world, point, direction), distance);
}

// What one light may add to the error, in units of Rounding::unit.
inline Bands rounding_of_path_light(const Light& light, const Arriving& arriving, const MaterialDescription& material, double side,
                                    const Shadow& shadow, const Moved& moved) {
  const double spot = light.given.kind == LightKind::spot ? Rounding::cone(light.given.exponent) : 0;
  const double factors = 2 * shadow.crossings + 2;
  const Bands reflected = material.diffuse + material.specular;
  const Bands local = material.diffuse * (Rounding::diffuse + factors) + material.specular * (Rounding::lobe(material.exponent) + factors);
  const Bands shading = light.given.strength * shadow.share * (local * arriving.share + reflected * (spot * arriving.attenuated)) * side;
  return completed(shading, light, arriving, reflected, moved);
}

// The secondary rays of a surface point.
struct Onward {
  struct Ray {
    Vec3dd direction;
    Bands weight;
    Branch branch = Branch::none;
    double bend = mirror_bend;
  };
  Ray rays[2];
  int count = 0;
  bool total = false;  // total reflection

  void add(const Vec3dd& direction, const Bands& weight, Branch branch, double bend) {
    if (weight.any()) rays[count++] = {direction, weight, branch, bend};
  }
};

}  // namespace equilux
