#include "placement.h"

namespace equilux {
namespace {

Vec3dd half_sum(const Vec3d& a, const Vec3d& b) {
  return Vec3dd{two_sum(a.x, b.x), two_sum(a.y, b.y), two_sum(a.z, b.z)} * DoubleDouble(0.5);
}

// A frame whose third axis is n, a unit vector; the first two are scaled by `radius`, the third by `height`.
Matrix3<DoubleDouble> frame_about(const Vec3dd& n, DoubleDouble radius, DoubleDouble height) {
  Vec3dd u, v;
  complete_frame(n, u, v);
  return {{u * radius, v * radius, n * height}};
}

Placement box_placement(const ObjectDescription& box) {
  const Vec3dd half = difference(box.b, box.a) * DoubleDouble(0.5);
  return {{{{half.x, {}, {}}, {{}, half.y, {}}, {{}, {}, half.z}}}, half_sum(box.a, box.b)};
}

Placement rectangle_placement(const ObjectDescription& rectangle) {
  const Vec3dd half_u = exactly(rectangle.b) * DoubleDouble(0.5), half_v = exactly(rectangle.c) * DoubleDouble(0.5);
  const Vec3dd normal = direction_of(cross(scaled_to_one(half_u), scaled_to_one(half_v)));
  // The normal's length is free: as long as the edges, so that the matrix is well conditioned at any scale.
  return {{{half_u, half_v, normal * length(half_u)}}, exactly(rectangle.a) + half_u + half_v};
}

Placement cylinder_placement(const ObjectDescription& cylinder) {
  const Vec3dd half = difference(cylinder.b, cylinder.a) * DoubleDouble(0.5);
  return {frame_about(direction_of(half), cylinder.radius, length(half)), half_sum(cylinder.a, cylinder.b)};
}

}  // namespace

Placement canonical_to_object(const ObjectDescription& object) {
  const DoubleDouble radius = object.radius, zero;
  switch (object.kind) {
    case ShapeKind::sphere:
      return {{{{radius, zero, zero}, {zero, radius, zero}, {zero, zero, radius}}}, exactly(object.a)};
    case ShapeKind::plane:
      return {frame_about(direction_of(object.b), 1.0, 1.0), exactly(object.a)};
    case ShapeKind::disc:
      return {frame_about(direction_of(object.b), radius, radius), exactly(object.a)};
    case ShapeKind::box:
      return box_placement(object);
    case ShapeKind::rectangle:
      return rectangle_placement(object);
    case ShapeKind::cylinder:
      return cylinder_placement(object);
    case ShapeKind::mesh:
      break;
  }
  const DoubleDouble one = 1.0;
  return {{{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}}, {}};
}

Placement object_to_eye(const ObjectDescription& object, const Vec3d& eye) {
  const std::array<double, 16>& m = object.matrix;
  return {{{{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}}}, difference({m[3], m[7], m[11]}, eye)};
}

Placement chained(const Placement& first, const Placement& second) {
  return {second.linear * first.linear, second.linear * first.origin + second.origin};
}

}  // namespace equilux
