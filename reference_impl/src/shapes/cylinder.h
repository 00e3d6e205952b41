// Canonical cylinder: x² + y² ≤ 1, |z| ≤ 1. Faces: 0 the side, 1 the cap at the base (z = −1), 2 the cap at the top. Open: the side only.
#pragma once

#include "interval.h"

namespace equilux {

struct CylinderShape {
  // The solid between the caps: convex, so no ray slips through the rim.
  template <class R> static void cross_capped(const LocalRay<R>& ray, Crossings<R>& out) {
    Interval<R> inside;
    if (clip_by_side(inside, ray, out) &&
        clip_by_slab(inside, ray.o.z, ray.d.z, ray.o_size.z, ray.d_size.z, 1, 2, out)) {
      inside.report(out);
    }
  }

  // Both crossings of the infinite side that lie between base and top.
  template <class R> static void cross_open(const LocalRay<R>& ray, Crossings<R>& out) {
    Interval<R> inside;
    if (!clip_by_side(inside, ray, out) || inside.enter.s < R(-1e300)) return;  // parallel to the axis: no crossing of the side
    add_between_ends(inside.enter, 0, ray, out);
    add_between_ends(inside.leave, 1, ray, out);
  }

  template <class R> static Vec3<R> normal(const Vec3<R>& p, int face) {
    if (face == 0) return {p.x, p.y, {}};
    return {{}, {}, R(face == 1 ? -1.0 : 1.0)};
  }

  static double half_extent(const Vec3d& w) { return std::hypot(w.x, w.y) + std::fabs(w.z); }

 private:
  template <class R> static bool clip_by_side(Interval<R>& inside, const LocalRay<R>& ray, Crossings<R>& out) {
    return clip_by_round(inside, Vec3<R>{ray.o.x, ray.o.y, {}}, Vec3<R>{ray.d.x, ray.d.y, {}},
                         std::hypot(ray.o_size.x, ray.o_size.y), std::hypot(ray.d_size.x, ray.d_size.y), 0, out);
  }

  template <class R> static void add_between_ends(const Crossing<R>& side, int leaving, const LocalRay<R>& ray, Crossings<R>& out) {
    const R z = ray.o.z + side.s * ray.d.z;
    const double s = std::fabs(to_double(side.s));
    const double error = rounding<R> * (1 + ray.o_size.z + s * ray.d_size.z) + side.error * std::fabs(to_double(ray.d.z));
    if (not_negative(R(1.0) - z, error, out) && not_negative(R(1.0) + z, error, out)) out.add(side.s, side.error, leaving);
  }
};

}  // namespace equilux
