// The Embree scene of a world: one user geometry for all analytic shapes, one per mesh, in boxes that rounding to float cannot beat.
#include <algorithm>
#include <limits>
#include <string>

#include "placement.h"
#include "search.h"
#include "shapes/dispatch.h"
#include "transport.h"

namespace equilux {

namespace {

RTCDevice shared_device() {
  static const RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) throw TracerError("Embree could not be started");
  return device;
}

// --- bounds, in the camera's frame ------------------------------------------------------------------------------------

struct Bounds {
  double lower[3], upper[3];
};

Bounds bounds_of_object(const World& world, int index) {
  const Object& object = world.objects[static_cast<std::size_t>(index)];
  const ObjectDescription& given = world.description.objects[static_cast<std::size_t>(index)];
  const Placement placement = chained(canonical_to_object(given), object_to_eye(given, world.camera.eye));
  const Vec3dd axes[3] = {world.camera.right, world.camera.up, world.camera.forward};
  Bounds bounds;
  for (int k = 0; k < 3; ++k) {
    const double centre = to_double(dot(axes[k], placement.origin));
    const double half = half_extent(object.solid, to_double(transposed_times(placement.linear, axes[k])));
    bounds.lower[k] = centre - half;
    bounds.upper[k] = centre + half;
  }
  return bounds;
}

Bounds bounds_of_triangle(const MeshObject& mesh, unsigned triangle) {
  const auto& corner = mesh.given->faces[triangle];
  const CameraPoint a = mesh.vertices[corner[0]], b = mesh.vertices[corner[1]], c = mesh.vertices[corner[2]];
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}};
}

double extent(const Bounds& bounds) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::fabs(bounds.lower[k]), std::fabs(bounds.upper[k])});
  return largest;
}

// The box handed to Embree, large enough that no rounding loses a crossing. In the camera's frame and scaled so that the farthest
// coordinate is near 1 (a scene of 1e-15 m neither underflows nor does one of 1e15 m overflow), a ray is
//   perspective:  (0, 0, 0) + s (x, y, 1)        orthographic:  (x, y, 0) + s (0, 0, 1)
// 1. Rounding the ray to float moves its point at s, per axis, by ≤ 2^-24 |s x| = 2^-24 |P_x| (perspective) or 2^-24 |x| = 2^-24 |P_x|
//    (orthographic); z is exact. So the displacement on an axis is 2^-24 of the coordinate itself, which the box bounds.
// 2. Embree's slab test multiplies by an approximate reciprocal and, off the origin, subtracts org·rdir: relative error of each distance a
//    few 2^-23, which again displaces the point by so much of its own coordinate. (RTC_SCENE_FLAG_ROBUST does not reach user geometry.)
//    Components of the direction below 1e-18 are replaced by 1e-18: at s ≤ 4 an absolute 2^-57.
// 3. Bounds come from double arithmetic on rounded numbers, 2^-48 at worst, and are rounded to float outward.
// 2^-19 of the larger bound of the axis, plus 2^-54, is more than all of them together.
void write_bounds(const Bounds& bounds, double scale, RTCBounds& out) {
  float* const lower[3] = {&out.lower_x, &out.lower_y, &out.lower_z};
  float* const upper[3] = {&out.upper_x, &out.upper_y, &out.upper_z};
  for (int k = 0; k < 3; ++k) {
    const double padding = 0x1p-19 * scale * std::max(std::fabs(bounds.lower[k]), std::fabs(bounds.upper[k])) + 0x1p-54;
    *lower[k] = std::nextafter(static_cast<float>(bounds.lower[k] * scale - padding), -std::numeric_limits<float>::infinity());
    *upper[k] = std::nextafter(static_cast<float>(bounds.upper[k] * scale + padding), std::numeric_limits<float>::infinity());
  }
}

void object_bounds_for_embree(const RTCBoundsFunctionArguments* args) {
  const World& world = *static_cast<const World*>(args->geometryUserPtr);
  write_bounds(bounds_of_object(world, world.bounded[args->primID]), world.boxes->embree_scale, *args->bounds_o);
}

void triangle_bounds_for_embree(const RTCBoundsFunctionArguments* args) {
  const MeshTag& tag = *static_cast<const MeshTag*>(args->geometryUserPtr);
  const World& world = *tag.building;
  write_bounds(bounds_of_triangle(world.meshes[static_cast<std::size_t>(tag.mesh)], args->primID), world.boxes->embree_scale, *args->bounds_o);
}

// Boxes for rays from anywhere (ray.h). Scaled to [-1, 1]³ about the scene's middle, a ray starts within 3 of it. Rounding its origin and
// its direction to float moves its points by ≤ 2^-24 (3 + 5); the slab test adds a few 2^-23 of bound and origin, below 2^-19 in all, and
// the double arithmetic of bounds and origin 2^-48 of their distance from the eye. 2^-16 and that is more than all of them together.
constexpr double transport_padding = 0x1p-16;

void write_transport_bounds(const Bounds& bounds, const TransportBoxes& boxes, RTCBounds& out) {
  float* const lower[3] = {&out.lower_x, &out.lower_y, &out.lower_z};
  float* const upper[3] = {&out.upper_x, &out.upper_y, &out.upper_z};
  const double centre[3] = {boxes.centre.x, boxes.centre.y, boxes.centre.z};
  for (int k = 0; k < 3; ++k) {
    *lower[k] = static_cast<float>((bounds.lower[k] - centre[k]) * boxes.scale - boxes.padding);
    *upper[k] = static_cast<float>((bounds.upper[k] - centre[k]) * boxes.scale + boxes.padding);
  }
}

void object_bounds_for_transport(const RTCBoundsFunctionArguments* args) {
  const World& world = *static_cast<const World*>(args->geometryUserPtr);
  write_transport_bounds(bounds_of_object(world, world.bounded[args->primID]), world.boxes->transport, *args->bounds_o);
}

void triangle_bounds_for_transport(const RTCBoundsFunctionArguments* args) {
  const MeshTag& tag = *static_cast<const MeshTag*>(args->geometryUserPtr);
  const World& world = *tag.building;
  write_transport_bounds(bounds_of_triangle(world.meshes[static_cast<std::size_t>(tag.mesh)], args->primID), world.boxes->transport,
                         *args->bounds_o);
}

// --- building ---------------------------------------------------------------------------------------------------------

double largest_extent(const World& world) {
  double largest = 0;
  for (const int index : world.bounded) largest = std::max(largest, extent(bounds_of_object(world, index)));
  for (const MeshObject& mesh : world.meshes) {
    for (const CameraPoint& v : mesh.vertices) largest = std::max({largest, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  }
  return largest;
}

// What Embree calls for one kind of primitive. occluded: null where nothing asks.
struct Callbacks {
  RTCBoundsFunction bounds;
  RTCIntersectFunctionN intersect;
  RTCOccludedFunctionN occluded = nullptr;
};

void attach(RTCScene scene, void* user, std::size_t count, const Callbacks& callbacks) {
  if (count == 0) return;
  RTCGeometry geometry = rtcNewGeometry(shared_device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
  rtcSetGeometryUserData(geometry, user);
  rtcSetGeometryBoundsFunction(geometry, callbacks.bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, callbacks.intersect);
  rtcSetGeometryOccludedFunction(geometry, callbacks.occluded);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

}  // namespace

namespace {

Bounds bounds_of_world(const World& world) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Bounds all{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  const auto include = [&all](const double (&lower)[3], const double (&upper)[3]) {
    for (int k = 0; k < 3; ++k) {
      all.lower[k] = std::min(all.lower[k], lower[k]);
      all.upper[k] = std::max(all.upper[k], upper[k]);
    }
  };
  for (const int index : world.bounded) {
    const Bounds bounds = bounds_of_object(world, index);
    include(bounds.lower, bounds.upper);
  }
  for (const MeshObject& mesh : world.meshes) {
    for (const CameraPoint& v : mesh.vertices) include({v.x, v.y, v.z}, {v.x, v.y, v.z});
  }
  return all;
}

void commit(RTCScene scene) {
  rtcCommitScene(scene);
  const RTCError error = rtcGetDeviceError(shared_device());
  if (error != RTC_ERROR_NONE) throw TracerError("Embree could not build the scene: error " + std::to_string(error));
}

void attach_all(World& world, RTCScene scene, const Callbacks& object, const Callbacks& triangle) {
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  attach(scene, &world, world.bounded.size(), object);
  for (std::size_t i = 0; i < world.meshes.size(); ++i) {
    MeshTag& tag = world.boxes->tags[i];
    tag = {&world, static_cast<int>(i)};
    attach(scene, &tag, world.meshes[i].given->faces.size(), triangle);
  }
  commit(scene);
}

bool nothing_bounded(const World& world) {
  return world.bounded.empty() && std::all_of(world.meshes.begin(), world.meshes.end(),
                                              [](const MeshObject& mesh) { return mesh.given->faces.empty(); });
}

}  // namespace

void World::build_transport_boxes() {
  if (nothing_bounded(*this)) return;
  const Bounds all = bounds_of_world(*this);
  double half = 0;
  for (int k = 0; k < 3; ++k) half = std::max(half, 0.5 * (all.upper[k] - all.lower[k]));
  TransportBoxes& built = boxes->transport;
  built.centre = {0.5 * (all.lower[0] + all.upper[0]), 0.5 * (all.lower[1] + all.upper[1]), 0.5 * (all.lower[2] + all.upper[2])};
  built.scale = half > 0 ? std::ldexp(1.0, -std::ilogb(half) - 1) : 1;
  built.padding = transport_padding + 0x1p-48 * built.scale * extent(all);
  built.embree = rtcNewScene(shared_device());
  attach_all(*this, built.embree, {object_bounds_for_transport, transport_objects, objects_between},
             {triangle_bounds_for_transport, transport_mesh, mesh_between});
}

void World::build_embree() {
  if (nothing_bounded(*this)) return;
  const double largest = largest_extent(*this);
  boxes->embree_scale = largest > 0 ? std::ldexp(1.0, -std::ilogb(largest)) : 1;
  boxes->embree = rtcNewScene(shared_device());
  attach_all(*this, boxes->embree, {object_bounds_for_embree, intersect_objects}, {triangle_bounds_for_embree, intersect_mesh});
}

}  // namespace equilux
