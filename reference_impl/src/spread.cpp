#include "spread.h"

namespace equilux {
namespace {

// Vertex normals interpolated with weights w_k: |∂N| ≤ Σ |∂w_k| |n_k − n_0| / |Σ w_k n_k|, and |∂w_k| = one over the height of vertex k.
// The length of the sum is at least that of its part along N, at least the smallest n_k·N.
double curvature_of_mesh(const World& world, const SurfacePoint& point) {
  const MeshObject& mesh = world.meshes[static_cast<std::size_t>(point.mesh)];
  if (mesh.given->vertex_normals.empty()) return 0;
  const auto& corner = mesh.given->faces[point.triangle];
  const Matrix3<DoubleDouble>& back = world.objects[static_cast<std::size_t>(point.object)].to_canonical_linear;
  const Vec3d up = to_double(point.normal);
  Vec3d p[3], n[3];
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {
    p[k] = to_double(mesh.vertex(corner[static_cast<std::size_t>(k)]));
    n[k] = to_double(transposed_times(back, exactly(mesh.given->vertex_normals[corner[static_cast<std::size_t>(k)]])));
    least = std::fmin(least, std::fabs(dot(n[k], up)));
  }
  const double doubled_area = length(cross(p[1] - p[0], p[2] - p[0]));
  double sum = 0;
  for (int k = 1; k < 3; ++k) sum += length(p[3 - k] - p[0]) / doubled_area * length(n[k] - n[0]);
  return sum / std::fmax(least, 1e-3 * (length(n[0]) + length(n[1]) + length(n[2])));
}

}  // namespace

namespace {

// The plane of a triangle is found from its edges: the slimmer it is, the less well.
double rounding_size_of_triangle(const World& world, const SurfacePoint& point) {
  const MeshObject& mesh = world.meshes[static_cast<std::size_t>(point.mesh)];
  const auto& corner = mesh.given->faces[point.triangle];
  const auto at = [&](std::size_t k) {
    const CameraPoint& v = mesh.vertices[corner[k]];
    return Vec3d{v.x, v.y, v.z};
  };
  const Vec3d u = at(1) - at(0), v = at(2) - at(0);
  const double slimness = length(u) * length(v) / length(cross(u, v));
  return (length(at(0)) + length(u) + length(v)) * (slimness < 0x1p90 ? slimness : 0x1p90);
}

}  // namespace

double rounding_size(const World& world, const SurfacePoint& point) {
  if (point.mesh >= 0) return rounding_size_of_triangle(world, point);
  return world.objects[static_cast<std::size_t>(point.object)].rounding_size;
}

double curvature(const World& world, const SurfacePoint& point) {
  if (point.mesh >= 0) return curvature_of_mesh(world, point);
  const Object& object = world.objects[static_cast<std::size_t>(point.object)];
  return point.face == 0 ? object.curvature : 0;  // caps are flat
}

}  // namespace equilux
