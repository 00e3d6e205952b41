// A world in float, as the packet kernels want it: tables, and an Embree scene of triangles, quads, spheres and shapes of our own.
#pragma once

#include <memory>
#include <vector>

#include "../world.h"
#include "kernel.h"

namespace equilux::fast {

// Raises TracerError, with the feature's name, for what float packets do not cover.
void refuse_uncovered(const World& world);

// Built once, read-only afterwards. The world must outlive it.
class FloatScene {
 public:
  // width: of the packets, 4, 8 or 16; 0: the widest that this machine and this build have.
  FloatScene(const World& world, int width);
  ~FloatScene();
  FloatScene(const FloatScene&) = delete;
  FloatScene& operator=(const FloatScene&) = delete;

  const World& world() const { return world_; }
  const Tables& tables() const { return tables_; }
  const Kernels& kernels() const { return *kernels_; }
  const FloatFeatures& features() const { return features_; }
  double scale() const { return scale_; }

 private:
  double extent_of_scene() const;
  Vec3d in_camera(const Vec3dd& v) const;
  void add_surfaces();
  void add_lamps();
  void add_plane(int object);
  void add_meshes();
  void add_mesh(int index);
  void add_bounded();
  void add_quads(const std::vector<int>& objects, std::uint32_t mask);
  void add_spheres(const std::vector<int>& objects, std::uint32_t mask);
  void add_shapes(const std::vector<int>& objects, std::uint32_t mask);
  void attach(RTCGeometry geometry, std::uint32_t mask, const Geometry& row);
  void find_features();
  std::uint32_t mask_of(int object) const;

  const World& world_;
  const Kernels* kernels_;
  double scale_ = 1;
  RTCScene embree_ = nullptr;
  Tables tables_;
  FloatFeatures features_;
  std::vector<Geometry> geometries_;
  std::vector<float> surfaces_, stored_normals_, vertex_normals_, curvatures_;
  std::vector<std::int32_t> surfaces_of_primitives_, corners_;
  std::vector<Plane> planes_;
  std::vector<Lamp> lamps_;
  std::vector<Shape> shapes_;
};

}  // namespace equilux::fast
