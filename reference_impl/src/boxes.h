// What the search through a world is built of, as far as it depends on the camera and on where things are, and on nothing else: worlds
// that differ in their lights, materials or rules share it. Diagnosing a picture prepares hundreds of those, and building the boxes of a
// mesh takes a hundred times as long as all the rest.
#pragma once

#include <memory>
#include <vector>

#include "embree_shim.h"
#include "scene_description.h"
#include "shapes/triangle.h"

namespace equilux {

class World;

// The boxes that rays from anywhere are sent through, in the camera's frame, moved and scaled so that they fill [-1, 1]³. The camera's own
// boxes are padded by what rounding does to rays from the eye, these by what it does to all others.
struct TransportBoxes {
  RTCScene embree = nullptr;  // null: nothing is bounded, or the model has no such rays
  Vec3d centre;               // metres, in the camera's frame
  double scale = 1;           // power of two
  double padding = 0;         // in scaled units
};

// Embree's user data of a mesh. building: looked at only while the boxes are.
struct MeshTag {
  const World* building = nullptr;
  int mesh = 0;  // index into World::meshes
};

struct Boxes {
  Boxes(const SceneDescription& scene, bool with_transport)
      : camera(scene.camera), objects(scene.objects), meshes(scene.meshes), with_transport(with_transport), tags(scene.objects.size()) {}
  ~Boxes();
  Boxes(const Boxes&) = delete;
  Boxes& operator=(const Boxes&) = delete;

  bool fit(const SceneDescription& scene, bool transport_too) const;

  // What they were built for.
  const CameraDescription camera;
  const std::vector<ObjectDescription> objects;
  const std::vector<std::shared_ptr<const MeshDescription>> meshes;
  const bool with_transport;

  std::vector<std::vector<CameraPoint>> vertices;  // of each of World::meshes
  std::vector<MeshTag> tags;
  RTCScene embree = nullptr;  // null when nothing is bounded
  double embree_scale = 1;    // power of two: metres → Embree's units
  TransportBoxes transport;
};

// Those of a world that is still alive, if they fit; else null.
std::shared_ptr<Boxes> shared_boxes(const SceneDescription& scene, bool with_transport);

// From now on others may share them. Nothing is written to them any more.
void share(const std::shared_ptr<Boxes>& boxes);

}  // namespace equilux
