#include "boxes.h"

#include <algorithm>
#include <mutex>

namespace equilux {
namespace {

struct Shared {
  std::mutex mutex;
  std::vector<std::weak_ptr<Boxes>> all;
};

Shared& shared() {
  static Shared instance;
  return instance;
}

bool same(const Vec3d& a, const Vec3d& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

bool same_camera(const CameraDescription& a, const CameraDescription& b) {
  return a.projection == b.projection && same(a.eye, b.eye) && same(a.target, b.target) && same(a.up, b.up) && a.fov_y_deg == b.fov_y_deg &&
         a.height_m == b.height_m;
}

bool same_place(const ObjectDescription& a, const ObjectDescription& b) {
  return a.kind == b.kind && a.matrix == b.matrix && same(a.a, b.a) && same(a.b, b.b) && same(a.c, b.c) && a.radius == b.radius &&
         a.capped == b.capped && a.mesh == b.mesh;
}

// Normals do not matter here.
bool same_triangles(const std::shared_ptr<const MeshDescription>& a, const std::shared_ptr<const MeshDescription>& b) {
  return a == b || (a->faces == b->faces && std::equal(a->vertices.begin(), a->vertices.end(), b->vertices.begin(), b->vertices.end(), same));
}

}  // namespace

Boxes::~Boxes() {
  if (embree != nullptr) rtcReleaseScene(embree);
  if (transport.embree != nullptr) rtcReleaseScene(transport.embree);
}

bool Boxes::fit(const SceneDescription& scene, bool transport_too) const {
  return with_transport == transport_too && same_camera(camera, scene.camera) &&
         std::equal(objects.begin(), objects.end(), scene.objects.begin(), scene.objects.end(), same_place) &&
         std::equal(meshes.begin(), meshes.end(), scene.meshes.begin(), scene.meshes.end(), same_triangles);
}

std::shared_ptr<Boxes> shared_boxes(const SceneDescription& scene, bool with_transport) {
  const std::lock_guard lock(shared().mutex);
  std::erase_if(shared().all, [](const std::weak_ptr<Boxes>& boxes) { return boxes.expired(); });
  for (const std::weak_ptr<Boxes>& candidate : shared().all) {
    std::shared_ptr<Boxes> boxes = candidate.lock();
    if (boxes && boxes->fit(scene, with_transport)) return boxes;
  }
  return nullptr;
}

void share(const std::shared_ptr<Boxes>& boxes) {
  const std::lock_guard lock(shared().mutex);
  shared().all.push_back(boxes);
}

}  // namespace equilux
