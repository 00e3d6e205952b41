// What a packet kernel reads: plain tables of floats and integers, made once by FloatScene. No function stands here, so that kernels of
// any instruction set may include it.
//
// Frame: the camera's axes (right, up, forward), origin at the eye, lengths × `scale`, a power of two that brings the farthest coordinate
// near 1: a scene of 1e-15 m neither underflows nor does one of 1e15 m overflow, and what is near the eye keeps its digits.
#pragma once

#include <cstdint>

#include "../embree_shim.h"
#include "../primitive.h"

namespace equilux::fast {

// Where the normal of a primitive comes from.
enum class Facing : std::int32_t {
  stored,        // flat: one unit normal per primitive
  interpolated,  // three vertex normals
  sphere,        // from the centre
  round,         // an ellipsoid or a cylinder: a Shape says
};

// One Embree geometry.
struct Geometry {
  Facing facing = Facing::stored;
  std::int32_t first = 0;    // of its primitives, in the table that `facing` looks at
  std::int32_t surface = -1; // of all of them; −1: `surfaces_of_primitives[first_surface + primitive]`
  std::int32_t first_surface = 0;
  std::int32_t mesh = -1;    // index into World::meshes, or −1
};

// A row of the table `surfaces`: one per object.
enum SurfaceColumn : int {
  column_constant = 0,      // K_emit + K_amb L_amb
  column_diffuse = 3,
  column_specular = 6,
  column_exponent = 9,
  column_mirrored = 10,     // (1 − t) k_refl
  column_through = 13,      // t k_trans
  column_front = 16,        // 1 − t
  column_behind = 17,       // t
  column_ior = 18,
  column_shadow = 19,       // what a crossing leaves of light, 3; opaque: 0
  column_reach = 22,        // how far a vertex or the centre lies, at most, from any point of a primitive
  column_curvature = 23,    // |change of N| per scaled unit of length, at most; of interpolated normals: a triangle's own
};
constexpr std::int32_t surface_stride = 24;

enum class LampKind : std::int32_t { point, directional, spot };

// E = strength / (constant + linear r + quadratic r²) × cos^e, r in scaled units.
struct Lamp {
  LampKind kind = LampKind::point;
  float position[3] = {};   // directional: unit, towards the light
  float axis[3] = {};       // spot: unit, the way the light travels
  float strength[3] = {};
  float constant = 0, linear = 0, quadratic = 0;
  float cone_cosine = 0, exponent = 0;
};

// n·P = level, n unit, outward.
struct Plane {
  float normal[3] = {};
  float level = 0;
  std::int32_t surface = 0;
  std::uint32_t mask = 1;
};

enum class ShapeForm : std::int32_t { disc, ellipsoid, cylinder_capped, cylinder_open };

// A shape that Embree has no geometry for. canonical = rows · P + shift.
struct Shape {
  ShapeForm form = ShapeForm::disc;
  float row[3][3] = {};
  float shift[3] = {};
  float lower[3] = {}, upper[3] = {};  // its box in the scene's frame
};

// Embree's ray masks: what an object does to the light of a lamp. Skipped: it casts no shadow at all.
constexpr std::uint32_t mask_opaque = 1, mask_transparent = 2, mask_skipped = 4, mask_all = 7;

struct Tables {
  RTCScene embree = nullptr;   // null: nothing is bounded
  bool perspective = true;
  int width = 1, height = 1;
  float film_step = 0;         // x = (2 i + 1 − width) film_step
  const Geometry* geometries = nullptr;
  const float* surfaces = nullptr;
  const std::int32_t* surfaces_of_primitives = nullptr;
  const float* stored_normals = nullptr;   // 4 per primitive
  const std::int32_t* corners = nullptr;   // 3 per triangle: place of the vertex's normal
  const float* vertex_normals = nullptr;   // 4 per vertex
  const float* curvatures = nullptr;       // of the same triangles
  const Plane* planes = nullptr;
  int plane_count = 0;
  const Lamp* lamps = nullptr;
  int lamp_count = 0;
  const Shape* shapes = nullptr;
  float background[3] = {};
  int recursion_limit = 0;
  bool transparent_shadows = false;  // some object leaves a part of the light that crosses it
};

}  // namespace equilux::fast
