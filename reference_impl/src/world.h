// The scene prepared for tracing: every object's placement about the eye, materials, lights, and the Embree scene that finds candidates.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "affine.h"
#include "boxes.h"
#include "ray.h"
#include "scene_description.h"
#include "shapes/triangle.h"

namespace equilux {

enum class Solid { sphere, plane, box, disc, rectangle, cylinder_capped, cylinder_open, mesh };

// An analytic object: one canonical shape and where it is.
struct Object {
  Solid solid = Solid::sphere;
  int material = 0;
  Matrix3<DoubleDouble> to_canonical_linear;  // inverse of the placement's linear part; its transpose carries normals to the world
  RayFrame<DoubleDouble> exact;
  RayFrame<double> rounded;
  double curvature = 0;      // of its round surface: |change of N| per metre, an upper bound
  double rounding_size = 0;  // metres: the lengths that its crossings are summed up of, times the condition of its placement
  CanonicalFrame canonical;  // for rays that do not start at the eye
};

// What an object leaves of light that crosses its surface.
struct Casts {
  bool blocks = true, skipped = false;
  Bands share;  // else
};

// A mesh: vertices in the camera's frame for the search; object coordinates and placement for the exact triangle.
struct MeshObject {
  int object = 0;
  const MeshDescription* given = nullptr;
  Placement placement;
  bool inside_out = false;                // wound inwards; looked at under the rule `media_counted` only
  std::span<const CameraPoint> vertices;  // Boxes holds them

  Vec3dd vertex(std::uint32_t index) const { return placement.linear * exactly(given->vertices[index]) + placement.origin; }
  ExactTriangle triangle(std::uint32_t face) const {
    const auto& corner = given->faces[face];
    return {vertex(corner[0]), vertex(corner[1]), vertex(corner[2])};
  }
};

struct Light {
  LightDescription given;
  Vec3dd position;      // eye-relative
  Vec3dd to_light;      // unit: directional
  Vec3dd axis;          // unit: spot, the way the light travels
  Vec3d to_light_rounded, axis_rounded;
  DoubleDouble cone_cosine, cone_versine;  // versine = 1 − cosine
};

// What a scene makes use of: selects the kernel, which has no code for anything else.
struct Features {
  bool specular = false;
  bool spot = false;
  // raytraced
  bool occlusion = false;     // something may stand between a light and a surface
  bool reflection = false;
  bool transparency = false;
};

// Built once, read-only afterwards: any number of threads may trace it.
class World {
 public:
  explicit World(SceneDescription scene);
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  const SceneDescription description;
  const Camera camera;
  std::shared_ptr<Boxes> boxes;
  std::vector<Object> objects;
  std::vector<int> unbounded;  // planes: tested for every ray, in file order
  std::vector<int> bounded;    // analytic objects inside Embree: primitive number → object
  std::vector<MeshObject> meshes;
  std::vector<Light> lights;
  std::vector<Casts> casts;    // one per object: its shadow
  Features features;
  // Those of `boxes`, once they are built
  RTCScene embree = nullptr;
  double embree_scale = 1;
  TransportBoxes transport;
  double eye_size = 0;         // largest |coordinate| of the eye: the rounding of the spec's own numbers is relative to it

  // Emitters are the last of the objects (emitters.h).
  int first_emitter() const { return static_cast<int>(objects.size() - description.emitters.size()); }
  // Of the channels with an axis of lights: delta lights, emitters, environment.
  std::size_t light_count() const { return lights.size() + description.emitters.size() + (description.has_environment ? 1 : 0); }

 private:
  void place_object(int index);
  void place_mesh(int index, const Placement& placement);
  static bool wound_inwards(const MeshObject& mesh);
  std::vector<CameraPoint> seen_by_camera(int index, const MeshObject& mesh) const;
  void prepare_lights();
  void find_features();
  void prepare_shadows();
  void build_boxes();
  void build_embree();
  void build_transport_boxes();
};

inline const MaterialDescription& material_of(const World& world, int object) {
  return world.description.materials[static_cast<std::size_t>(world.objects[static_cast<std::size_t>(object)].material)];
}

}  // namespace equilux
