// Canonical box: the cube [-1, 1]³. Faces 0…5: −x, +x, −y, +y, −z, +z.
#pragma once

#include "interval.h"

namespace equilux {

struct BoxShape {
  template <class R> static void cross(const LocalRay<R>& ray, Crossings<R>& out) {
    Interval<R> inside;
    if (clip_by_slab(inside, ray.o.x, ray.d.x, ray.o_size.x, ray.d_size.x, 0, 1, out) &&
        clip_by_slab(inside, ray.o.y, ray.d.y, ray.o_size.y, ray.d_size.y, 2, 3, out) &&
        clip_by_slab(inside, ray.o.z, ray.d.z, ray.o_size.z, ray.d_size.z, 4, 5, out)) {
      inside.report(out);
    }
  }

  template <class R> static Vec3<R> normal(const Vec3<R>&, int face) {
    const R sign(face % 2 == 0 ? -1.0 : 1.0);
    return face < 2 ? Vec3<R>{sign, {}, {}} : face < 4 ? Vec3<R>{{}, sign, {}} : Vec3<R>{{}, {}, sign};
  }

  static double half_extent(const Vec3d& w) { return std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z); }
};

}  // namespace equilux
