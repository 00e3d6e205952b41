// Canonical sphere: radius 1 about the origin. One face, 0.
#pragma once

#include "interval.h"

namespace equilux {

struct SphereShape {
  template <class R> static void cross(const LocalRay<R>& ray, Crossings<R>& out) {
    Interval<R> inside;
    if (clip_by_round(inside, ray.o, ray.d, length(ray.o_size), length(ray.d_size), 0, out)) inside.report(out);
  }

  // Not unit. The shaded point itself lies on the sphere to 2^-90, so it is its own normal.
  template <class R> static Vec3<R> normal(const Vec3<R>& p, int) { return p; }

  // Half the extent along w: the largest w·p over the shape.
  static double half_extent(const Vec3d& w) { return length(w); }
};

}  // namespace equilux
