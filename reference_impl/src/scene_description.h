// The scene as the spec says it: plain numbers in world coordinates, SI units, nothing derived. World (world.h) prepares it for tracing.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "rules.h"
#include "vec3.h"

namespace equilux {

// Anything the tracer refuses; becomes equilux_tracer.TracerError.
struct TracerError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Bands {
  double r = 0, g = 0, b = 0;

  bool any() const { return r != 0 || g != 0 || b != 0; }
};

inline Bands operator+(Bands a, Bands b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
inline Bands operator*(Bands a, Bands b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
inline Bands operator*(Bands a, double s) { return {a.r * s, a.g * s, a.b * s}; }
inline double largest(const Bands& bands) { return std::max({bands.r, bands.g, bands.b}); }

enum class Projection { perspective, orthographic };

struct CameraDescription {
  Projection projection = Projection::perspective;
  Vec3d eye, target, up;
  double fov_y_deg = 0;  // perspective
  double height_m = 0;   // orthographic, the full height
};

enum class Model { phong, opengl, raytraced, reflection_equation };

enum class LightKind { point, directional, spot };

struct LightDescription {
  LightKind kind = LightKind::point;
  Vec3d position;    // point, spot
  Vec3d direction;   // the way the light travels: directional, spot
  Bands strength;    // radiant intensity W/sr (point, spot: on the axis) or irradiance W/m² (directional)
  double constant = 0, linear = 0, quadratic = 1;
  double cone_half_angle_deg = 90, exponent = 0;  // spot
  Bands ambient, diffuse{1, 1, 1}, specular{1, 1, 1};  // opengl: shares of the strength
};

enum class EmitterKind { sphere, disc, rectangle };

// A surface that shines, in model reflection_equation. What a, b and c mean is as for objects.
struct EmitterDescription {
  EmitterKind kind = EmitterKind::sphere;
  Vec3d a, b, c;
  double radius = 0;
  Bands radiance;
};

enum class Brdf { lambert, phong_classic, phong_cosine };

struct MaterialDescription {
  Bands diffuse, specular;  // 1/sr
  double exponent = 1;
  Bands ambient, emission;
  Bands reflection, transmission;  // k_refl, k_trans
  double transparency = 0, ior = 1;
  Brdf brdf = Brdf::phong_classic;
};

enum class ShapeKind { sphere, plane, box, disc, rectangle, cylinder, mesh };

// A mesh in object coordinates. Without vertex normals it is flat-shaded.
struct MeshDescription {
  std::vector<Vec3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<Vec3d> vertex_normals;
};

struct ObjectDescription {
  ShapeKind kind = ShapeKind::sphere;
  int material = 0;
  std::array<double, 16> matrix{};  // object → world, row by row, acts on column vectors
  // What a and b mean depends on the shape: sphere: centre; plane, disc: point, normal; box: min, max; rectangle: corner, edge_u and c =
  // edge_v; cylinder: base, top.
  Vec3d a, b, c;
  double radius = 0;
  bool capped = true;
  int mesh = -1;
};

struct SceneDescription {
  Model model = Model::phong;
  int recursion_limit = 8;
  bool attenuated_shadows = true;   // raytraced: false: objects with t > 0 cast none
  bool infinite_viewer = false;     // opengl
  bool has_environment = false;     // reflection_equation; its radiance is `background`
  double error_target = 1e-6;       // reflection_equation: asked of every integral, relative to what would come unblocked
  CameraDescription camera;
  int width = 1, height = 1;
  Rules rules;
  Bands ambient, background;
  std::vector<LightDescription> lights;
  std::vector<EmitterDescription> emitters;
  std::vector<MaterialDescription> materials;
  std::vector<ObjectDescription> objects;
  std::vector<std::shared_ptr<const MeshDescription>> meshes;
};

}  // namespace equilux
