// One triangle of a mesh, crossed without leaks.
//
// The search projects the three vertices along the ray into its plane (after Woop, Benthin and Wald, "Watertight ray/triangle
// intersection", JCGT 2013). Each vertex is projected by itself, so neighbours see the same rounded point, and the projection of a mesh
// is a mesh in the plane. The ray is the origin there, and a triangle is hit when no edge function
//     e(p, q) = p.x q.y − p.y q.x
// has the sign opposite to another's. Rounding to nearest is monotonic, so the sign of e as computed is the right one or 0, and swapping
// p and q negates it exactly: whatever is rounded, a point that a neighbour excludes is included here. Edges and vertices belong to all
// their triangles; ties go to the first. So a closed mesh has no cracks, along edges and through vertices.
#pragma once

#include <algorithm>

#include "crossing.h"

namespace equilux {

// A vertex in the camera's frame: right, up, forward; eye-relative.
struct CameraPoint {
  double x, y, z;
};

// Where a camera ray is in that frame, as doubles: the point at depth s is (x s, y s, s) in perspective, (x, y, s) in orthographic view.
struct TriangleRay {
  double x, y;
  bool perspective;

  CameraPoint project(const CameraPoint& v) const {
    return perspective ? CameraPoint{v.x - x * v.z, v.y - y * v.z, v.z} : CameraPoint{v.x - x, v.y - y, v.z};
  }
  double size(const CameraPoint& v) const {
    const double along = perspective ? std::fabs(v.z) : 1;
    return std::max({std::fabs(v.x) + std::fabs(x) * along, std::fabs(v.y) + std::fabs(y) * along, std::fabs(v.z)});
  }
};

// The same for a ray that starts anywhere, in the camera's frame: the axis along which it runs furthest takes the place of `forward`, so
// that depths are s itself, metres along the unit direction.
struct AnywhereTriangleRay {
  double o[3], shear_x = 0, shear_y = 0, reciprocal = 1;
  int kx = 0, ky = 1, kz = 2;

  AnywhereTriangleRay() = default;
  AnywhereTriangleRay(const Vec3d& origin, const Vec3d& direction) : o{origin.x, origin.y, origin.z} {
    const double d[3] = {direction.x, direction.y, direction.z};
    kz = std::fabs(d[0]) > std::fabs(d[1]) ? 0 : 1;
    if (std::fabs(d[2]) >= std::fabs(d[kz])) kz = 2;
    kx = (kz + 1) % 3;
    ky = (kz + 2) % 3;
    reciprocal = 1 / d[kz];
    shear_x = d[kx] * reciprocal;
    shear_y = d[ky] * reciprocal;
  }

  CameraPoint project(const CameraPoint& v) const {
    const double p[3] = {v.x - o[0], v.y - o[1], v.z - o[2]};
    return {p[kx] - shear_x * p[kz], p[ky] - shear_y * p[kz], p[kz] * reciprocal};
  }
  double size(const CameraPoint& v) const {  // |shear| ≤ 1, |reciprocal| < 2
    return 4 * std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z), std::fabs(o[0]), std::fabs(o[1]), std::fabs(o[2])});
  }
};

// `face` of a triangle's crossing is made of these. on_border: neighbours may claim it too, because the ray meets an edge or a vertex to
// the last digit. winds_forward: the same for all triangles that one ray meets from the same side.
constexpr int triangle_on_border = 1, triangle_winds_forward = 2;

// False: no crossing. s, the depth, comes with a bound of its error and stays between the depths of the vertices, also for a triangle
// that is seen almost edge-on.
template <class AnyRay>
bool cross_triangle(const AnyRay& ray, const CameraPoint& a, const CameraPoint& b, const CameraPoint& c, Crossing<double>& out) {
  const CameraPoint p = ray.project(a), q = ray.project(b), r = ray.project(c);
  const auto edge = [](const CameraPoint& from, const CameraPoint& to) { return from.x * to.y - from.y * to.x; };
  const double u = edge(q, r), v = edge(r, p), w = edge(p, q);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double area = u + v + w;
  if (area == 0) return false;  // edge-on: its neighbours cover the ray
  const auto [near, far] = std::minmax({p.z, q.z, r.z});
  out.s = std::clamp((u * p.z + v * q.z + w * r.z) / area, near, far);
  // A vertex displaced by η moves the plane along the ray by η (1 + slope); the slope is at most depth range × extent / area.
  const double extent = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(q.x), std::fabs(q.y), std::fabs(r.x), std::fabs(r.y)});
  const double moved = rounding<double> * std::max({ray.size(a), ray.size(b), ray.size(c)});
  out.error = moved + std::min(far - near, moved * 4 * (far - near) * extent / std::fabs(area));
  out.face = (u == 0 || v == 0 || w == 0 ? triangle_on_border : 0) + (area > 0 ? triangle_winds_forward : 0);
  return true;
}

// The exact triangle, eye-relative world coordinates.
struct ExactTriangle {
  Vec3dd a, edge_u, edge_v, normal;  // normal = edge_u × edge_v, not unit, by winding

  ExactTriangle(const Vec3dd& a, const Vec3dd& b, const Vec3dd& c)
      : a(a), edge_u(b - a), edge_v(c - a), normal(cross(edge_u, edge_v)) {}

  DoubleDouble crossing(const Vec3dd& o, const Vec3dd& d) const { return dot(normal, a - o) / dot(normal, d); }

  // Weights of the second and third vertex at the point p of its plane.
  void weights(const Vec3dd& p, DoubleDouble& beta, DoubleDouble& gamma) const {
    const DoubleDouble scale = DoubleDouble(1.0) / dot(normal, normal);
    beta = dot(cross(p - a, edge_v), normal) * scale;
    gamma = dot(cross(edge_u, p - a), normal) * scale;
  }
};

}  // namespace equilux
