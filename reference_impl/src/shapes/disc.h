// Canonical disc: x² + y² ≤ 1, z = 0, the rim included.
#pragma once

#include "planar.h"

namespace equilux {

struct DiscShape {
  template <class R> static void cross(const LocalRay<R>& ray, Crossings<R>& out) {
    PlaneCrossing<R> at;
    if (!cross_plane(ray, at, out)) return;
    // Of second order, too: from far enough off, x itself is all error.
    const double error = (2 * std::fabs(to_double(at.x)) + at.error_x) * at.error_x + (2 * std::fabs(to_double(at.y)) + at.error_y) * at.error_y;
    if (not_negative(R(1.0) - (at.x * at.x + at.y * at.y), error, out)) out.add(at.crossing.s, at.crossing.error, 0);
  }

  template <class R> static Vec3<R> normal(const Vec3<R>&, int) { return planar_normal<R>(); }

  static double half_extent(const Vec3d& w) { return std::hypot(w.x, w.y); }
};

}  // namespace equilux
