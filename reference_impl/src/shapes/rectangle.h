// Canonical rectangle: |x| ≤ 1, |y| ≤ 1, z = 0, the edges included; x along edge_u, y along edge_v.
#pragma once

#include "planar.h"

namespace equilux {

struct RectangleShape {
  template <class R> static void cross(const LocalRay<R>& ray, Crossings<R>& out) {
    PlaneCrossing<R> at;
    if (!cross_plane(ray, at, out)) return;
    if (not_negative(R(1.0) - at.x, at.error_x, out) && not_negative(R(1.0) + at.x, at.error_x, out) &&
        not_negative(R(1.0) - at.y, at.error_y, out) && not_negative(R(1.0) + at.y, at.error_y, out)) {
      out.add(at.crossing.s, at.crossing.error, 0);
    }
  }

  template <class R> static Vec3<R> normal(const Vec3<R>&, int) { return planar_normal<R>(); }

  static double half_extent(const Vec3d& w) { return std::fabs(w.x) + std::fabs(w.y); }
};

}  // namespace equilux
