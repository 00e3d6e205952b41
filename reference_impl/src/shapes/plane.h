// Canonical plane: z = 0 without end. Outside Embree: it has no bounds.
#pragma once

#include "planar.h"

namespace equilux {

struct PlaneShape {
  template <class R> static void cross(const LocalRay<R>& ray, Crossings<R>& out) {
    PlaneCrossing<R> at;
    if (cross_plane(ray, at, out)) out.add(at.crossing.s, at.crossing.error, 0);
  }

  template <class R> static Vec3<R> normal(const Vec3<R>&, int) { return planar_normal<R>(); }
};

}  // namespace equilux
