#include "ruled_point.h"

namespace equilux {
namespace {

bool lit_at_vertices(const World& world, const SurfacePoint& point) { return world.description.rules.vertex_lighting && point.mesh >= 0; }

// The corner k of the triangle that `point` lies on, with the normal that is stored there (flat meshes: the face's), on the side on which
// the triangle is seen, and V to where the triangle is seen from.
SurfacePoint corner_point(const World& world, const SurfacePoint& point, int k, bool first) {
  const MeshObject& mesh = world.meshes[static_cast<std::size_t>(point.mesh)];
  const std::uint32_t index = mesh.given->faces[point.triangle][static_cast<std::size_t>(k)];
  SurfacePoint corner = point;
  corner.position = mesh.vertex(index);
  if (!first) {
    corner.to_viewer = direction_of(point.position + point.to_viewer * point.s - corner.position);
  } else if (world.camera.perspective()) {
    corner.to_viewer = -direction_of(corner.position);
  }
  const bool smooth = !mesh.given->vertex_normals.empty();
  if (smooth) {
    const Matrix3<DoubleDouble>& back = world.objects[static_cast<std::size_t>(point.object)].to_canonical_linear;
    Vec3dd normal = transposed_times(back, exactly(mesh.given->vertex_normals[index]));
    corner.turned = dot(to_double(normal), point.geometric) < 0;
    if (corner.turned) normal = -normal;
    if (!(largest(to_double(normal)) > 0)) normal = exactly(point.geometric);
    corner.normal = direction_of(normal);
    turn_normal(world.description.rules, corner);
  }
  return corner;
}

}  // namespace

void turn_normal(const Rules& rules, SurfacePoint& point) {
  bool reversed = rules.normals_reversed;
  if (rules.normal_side == NormalSide::as_given) reversed ^= point.turned;
  if (rules.normal_side == NormalSide::facing_viewer) reversed ^= to_double(dot(point.normal, point.to_viewer)) < 0;
  if (reversed) point.normal = -point.normal;
}

void corner_weights(const World& world, const SurfacePoint& point, const Vec3dd& position, double (&weight)[3]) {
  DoubleDouble beta, gamma;
  world.meshes[static_cast<std::size_t>(point.mesh)].triangle(point.triangle).weights(position, beta, gamma);
  weight[0] = to_double(DoubleDouble(1.0) - beta - gamma);
  weight[1] = to_double(beta);
  weight[2] = to_double(gamma);
}

void find_lit_places(const World& world, const SurfacePoint& point, bool first, LitPlaces& places) {
  places.count = 1;
  places.weight[0] = 1;
  if (lit_at_vertices(world, point)) {
    corner_weights(world, point, point.position, places.weight);
    for (double& weight : places.weight) weight = std::fmax(0, weight);  // on an edge rounding may leave one just below 0
    places.count = 3;
    for (int k = 0; k < 3; ++k) places.at[k] = corner_point(world, point, k, first);
  } else {
    places.at[0] = point;
  }
  for (int k = 0; k < places.count; ++k) places.at[k].to_viewer = ruled_viewer(world, places.at[k], first);
}

}  // namespace equilux
