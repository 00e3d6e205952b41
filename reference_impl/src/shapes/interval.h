// The stretch of a ray inside a convex solid, as the intersection of stretches inside slabs and infinite cylinders. Because enter and
// leave come from comparing the very numbers that bound the stretch, a solid has no cracks along its edges.
#pragma once

#include <limits>
#include <utility>

#include "crossing.h"

namespace equilux {

template <class R>
struct Interval {
  Crossing<R> enter{R(-std::numeric_limits<double>::infinity()), 0, 0};
  Crossing<R> leave{R(std::numeric_limits<double>::infinity()), 0, 0};

  // The earlier-numbered face keeps a tie.
  void clip(const Crossing<R>& first, const Crossing<R>& second) {
    if (first.s > enter.s) enter = first;
    if (second.s < leave.s) leave = second;
  }

  void report(Crossings<R>& out) const {
    if (enter.s > leave.s) {
      if (!not_negative(leave.s - enter.s, enter.error + leave.error, out)) return;
    } else if (sign_within(leave.s - enter.s, enter.error + leave.error) == Sign::zero) {
      out.uncertain = true;
    }
    out.add(enter.s, enter.error, 2 * enter.face);
    out.add(leave.s, leave.error, 2 * leave.face + 1);
  }
};

// Clip by −1 ≤ o + s d ≤ 1 along one axis. False: the ray runs beside the slab.
template <class R>
bool clip_by_slab(Interval<R>& inside, R o, R d, double o_size, double d_size, int lower_face, int upper_face, Crossings<R>& out) {
  const double d_error = rounding<R> * d_size;
  if (sign_within(d, d_error) == Sign::zero) {  // parallel
    out.uncertain |= to_double(d) != 0;
    const double o_error = rounding<R> * (1 + o_size);
    return not_negative(R(1.0) - o, o_error, out) && not_negative(R(1.0) + o, o_error, out);
  }
  const R reciprocal = R(1.0) / d;
  const double steepness = std::fabs(to_double(reciprocal));
  const auto crossing = [&](double bound, int face) {
    const R s = (R(bound) - o) * reciprocal;
    const double error = (rounding<R> * (1 + o_size) + std::fabs(to_double(s)) * d_error) * steepness;
    return Crossing<R>{s, error, face};
  };
  Crossing<R> lower = crossing(-1.0, lower_face), upper = crossing(1.0, upper_face);
  if (to_double(d) < 0) std::swap(lower, upper);
  inside.clip(lower, upper);
  return true;
}

// The stretch in which a quadratic form |o + s d|² ≤ 1 holds; o, d already projected (3 components for a sphere, 2 for a cylinder).
// The half chord comes from the distance vector q at the closest approach, not from b² − ac, which would cancel:
//   s₀ = −o·d / d·d,   q = o + s₀ d,   s = s₀ ∓ √((1 − q·q) / d·d)
// Error of q: that of o and s₀ d, both of size |o|; hence of 1 − q·q near the rim: 2 |q| times as much, |q| ≤ 1, and its square, which is
// all there is where |o| exceeds 1 / rounding.
template <class R>
bool clip_by_round(Interval<R>& inside, const Vec3<R>& o, const Vec3<R>& d, double o_size, double d_size, int face,
                   Crossings<R>& out) {
  const R dd = dot(d, d);
  const double d_length = std::sqrt(to_double(dd));
  if (d_length <= rounding<R> * d_size * 4) {  // parallel to the cylinder's axis
    out.uncertain |= d_length != 0;
    return not_negative(R(1.0) - dot(o, o), rounding<R> * (1 + o_size) * 4, out);
  }
  const R s0 = -(dot(o, d) / dd);
  const Vec3<R> q = o + d * s0;
  const R rest = R(1.0) - dot(q, q);
  const double skew = d_size / d_length;  // how much of d cancelled when it was projected
  const double q_error = rounding<R> * 2 * (1 + o_size * skew), rest_error = q_error * (2 + q_error);
  if (!not_negative(rest, rest_error, out)) return false;
  const R root = square_root(to_double(rest) > 0 ? rest / dd : R(0.0));
  const double half = std::fmax(to_double(root) * d_length, std::sqrt(rest_error));
  const double error = (rounding<R> * o_size * skew + rest_error / half) / d_length;
  inside.clip({s0 - root, error, face}, {s0 + root, error, face});
  return true;
}

}  // namespace equilux
