#include "surface.h"

#include "shapes/dispatch.h"
#include "transport.h"

namespace equilux {
namespace {

// Vertex normals interpolated in object coordinates, carried to the world by the inverse transpose.
Vec3dd interpolated_normal(const MeshObject& mesh, std::uint32_t triangle, const ExactTriangle& exact, const Vec3dd& p,
                           const Matrix3<DoubleDouble>& inverse_linear) {
  DoubleDouble beta, gamma;
  exact.weights(p, beta, gamma);
  const auto& corner = mesh.given->faces[triangle];
  const auto normal_of = [&](int k) { return exactly(mesh.given->vertex_normals[corner[static_cast<std::size_t>(k)]]); };
  const Vec3dd sum = normal_of(0) * (DoubleDouble(1.0) - beta - gamma) + normal_of(1) * beta + normal_of(2) * gamma;
  return transposed_times(inverse_linear, sum);
}

void shade_mesh_point(const World& world, const Candidate& hit, SurfacePoint& point) {
  const MeshObject& mesh = world.meshes[static_cast<std::size_t>(hit.mesh)];
  const ExactTriangle triangle = mesh.triangle(hit.triangle);
  const bool smooth = !mesh.given->vertex_normals.empty();
  point.face = smooth ? 0 : static_cast<int>(hit.triangle);
  point.outside = to_double(dot(triangle.normal, point.to_viewer)) > 0;
  const Vec3dd geometric = point.outside ? triangle.normal : -triangle.normal;  // Ng, on the viewer's side
  point.geometric = to_double(geometric);
  Vec3dd normal = geometric;
  point.turned = !point.outside;
  if (smooth) {
    const Matrix3<DoubleDouble>& back = world.objects[static_cast<std::size_t>(hit.object)].to_canonical_linear;
    normal = interpolated_normal(mesh, hit.triangle, triangle, point.position, back);
    point.turned = to_double(dot(normal, geometric)) < 0;
    if (point.turned) normal = -normal;                            // N·Ng > 0
    if (!(largest(to_double(normal)) > 0)) normal = geometric;    // opposite vertex normals that cancel out at this very point
  }
  point.normal = direction_of(normal);
}

void shade_object_point(const World& world, const LocalRay<DoubleDouble>& local, const Candidate& hit, SurfacePoint& point) {
  const Object& object = world.objects[static_cast<std::size_t>(hit.object)];
  point.face = hit.face / 2;
  const Vec3dd canonical = canonical_normal(object.solid, local.o + local.d * point.s, point.face);
  const Vec3dd outward = transposed_times(object.to_canonical_linear, canonical);
  point.outside = to_double(dot(canonical, local.d)) < 0;
  point.turned = !point.outside;
  point.normal = direction_of(point.outside ? outward : -outward);
  point.geometric = to_double(point.normal);
}

}  // namespace

SurfacePoint surface_point(const World& world, const FilmRay& ray, const Candidate& hit) {
  SurfacePoint point;
  point.object = hit.object;
  point.mesh = hit.mesh;
  point.triangle = hit.triangle;
  point.s = exact_depth(world, ray, hit);
  const Vec3dd d = world.camera.direction(ray);
  const DoubleDouble d_length = length(d);
  const Vec3dd origin = world.camera.origin(ray);
  point.position = origin + d * point.s;
  point.to_viewer = -(d * (DoubleDouble(1.0) / d_length));
  point.distance = to_double(point.s * d_length);
  point.position_size = length(to_double(origin)) + point.distance;
  if (hit.mesh >= 0) {
    shade_mesh_point(world, hit, point);
  } else {
    const Object& object = world.objects[static_cast<std::size_t>(hit.object)];
    shade_object_point(world, local_ray(object.exact, ray.x, ray.y, world.camera.perspective()), hit, point);
  }
  return point;
}

SurfacePoint surface_point(const World& world, const Ray& ray, const Candidate& hit) {
  SurfacePoint point;
  point.object = hit.object;
  point.mesh = hit.mesh;
  point.triangle = hit.triangle;
  point.s = exact_distance(world, ray, hit);
  point.distance = to_double(point.s);
  point.position = ray.origin + ray.direction * point.s;
  point.to_viewer = -ray.direction;
  point.position_size = length(ray.origin_rounded) + point.distance;
  if (hit.mesh >= 0) {
    shade_mesh_point(world, hit, point);
  } else {
    shade_object_point(world, world.objects[static_cast<std::size_t>(hit.object)].canonical.exact(ray), hit, point);
  }
  return point;
}

}  // namespace equilux
