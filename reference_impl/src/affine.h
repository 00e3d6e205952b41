// From a shape's canonical frame to the eye-relative world, and camera rays back into that frame. All in double-double: the rounding
// to double, for the search, is the last step.
#pragma once

#include "camera.h"
#include "shapes/crossing.h"

namespace equilux {

// Eye-relative world = linear · canonical + origin.
struct Placement {
  Matrix3<DoubleDouble> linear;
  Vec3dd origin;
};

// What is needed to bring camera rays into a canonical frame:
//   perspective:  o = eye,                    d = x·right + y·up + forward
//   orthographic: o = eye + x·right + y·up,   d = forward
template <class R>
struct RayFrame {
  Vec3<R> eye, right, up, forward;
};

inline Vec3d sizes_of(const Vec3d& at, const Vec3d& right, const Vec3d& up, double x, double y) {
  return magnitudes(at) + magnitudes(right) * std::fabs(x) + magnitudes(up) * std::fabs(y);
}
inline Vec3d sizes_of(const Vec3dd& at, const Vec3dd& right, const Vec3dd& up, double x, double y) {
  return sizes_of(to_double(at), to_double(right), to_double(up), x, y);
}

template <class R> LocalRay<R> local_ray(const RayFrame<R>& frame, R x, R y, bool perspective) {
  const Vec3<R> sideways = frame.right * x + frame.up * y;
  if (perspective) {
    return {frame.eye, sideways + frame.forward, magnitudes(to_double(frame.eye)),
            sizes_of(frame.forward, frame.right, frame.up, to_double(x), to_double(y))};
  }
  return {frame.eye + sideways, frame.forward, sizes_of(frame.eye, frame.right, frame.up, to_double(x), to_double(y)),
          magnitudes(to_double(frame.forward))};
}

}  // namespace equilux
