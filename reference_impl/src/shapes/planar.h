// What plane, disc and rectangle share: the crossing with the canonical plane z = 0, whose normal is +z. One face, 0.
#pragma once

#include "crossing.h"

namespace equilux {

// The crossing with z = 0, and its x and y with a bound of their error.
template <class R>
struct PlaneCrossing {
  Crossing<R> crossing;
  R x{}, y{};
  double error_x = 0, error_y = 0;
};

// False: parallel.
template <class R> bool cross_plane(const LocalRay<R>& ray, PlaneCrossing<R>& at, Crossings<R>& out) {
  const double d_error = rounding<R> * ray.d_size.z;
  if (sign_within(ray.d.z, d_error) == Sign::zero) {
    out.uncertain |= to_double(ray.d.z) != 0;
    return false;
  }
  const R s = -(ray.o.z / ray.d.z);
  const double distance = std::fabs(to_double(s));
  const double error = (rounding<R> * ray.o_size.z + distance * d_error) / std::fabs(to_double(ray.d.z));
  at.crossing = {s, error, 0};
  at.x = ray.o.x + s * ray.d.x;
  at.y = ray.o.y + s * ray.d.y;
  at.error_x = rounding<R> * (1 + ray.o_size.x + distance * ray.d_size.x) + error * std::fabs(to_double(ray.d.x));
  at.error_y = rounding<R> * (1 + ray.o_size.y + distance * ray.d_size.y) + error * std::fabs(to_double(ray.d.y));
  return true;
}

template <class R> Vec3<R> planar_normal() { return {{}, {}, R(1.0)}; }

}  // namespace equilux
