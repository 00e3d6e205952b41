// A ray that starts anywhere: mirrored, refracted, or towards a light. Camera rays have a form of their own (camera.h).
//
// Origin and direction are double-double, so that a surface is left from the very point that was found on it. What such a ray must not
// meet again is that surface at that point, and nothing is moved away from it by an epsilon:
//   the object it leaves    its crossing at s = 0, told apart in double-double from the other one: the far side of the same sphere
//   a flat one, a triangle  altogether
//   any other surface       up to `start`: it coincides with the one that is left to the last digits of the coordinates in the spec
// (2^-50 of the distances from the world's origin and from the eye, measured along the normal). Coincident surfaces are one, and it
// belongs to the first object in file order, for secondary rays as for the eye's.
//
// Where surfaces are neither clearly coincident nor clearly apart, the picture hangs on where exactly that line is drawn. No digit of such
// a sample is vouched for: channel `rounding` is infinite there. It begins where a scene is 2^48 of its own sizes off the world's origin.
#pragma once

#include "camera.h"
#include "shapes/crossing.h"

namespace equilux {

// The surface that a ray leaves; none: −1.
struct Departure {
  int object = -1;
  int mesh = -1;
  std::uint32_t triangle = 0;
  double start = 0;  // metres along the ray
  bool displaced = false;  // the origin was moved off the surface by up to `start`, which then covers the object that is left, too
};

// Whether surfaces that are `apart` lie so near to the line `coincident` that another reading of it would take them otherwise. Coordinates
// that are meant to coincide differ by 2^-53 of their size, or an eighth of the line.
inline bool is_undecided(double apart, double coincident) { return apart > 0.5 * coincident && apart < 4 * coincident; }

// P(s) = origin + s direction, s in metres. Eye-relative world coordinates.
struct Ray {
  Vec3dd origin, direction;  // direction unit
  double origin_size = 0;    // the lengths that were added up to find the origin: what its rounding is relative to
  Departure from;
  Vec3d origin_rounded, direction_rounded;
};

// The same ray in an object's canonical frame. Sizes: by row, the sum of the magnitudes of the matrix's elements, and of the eye's place.
struct CanonicalFrame {
  Matrix3<DoubleDouble> linear;
  Vec3dd eye;
  Matrix3<double> linear_rounded;
  Vec3d eye_rounded, row_size;

  CanonicalFrame() = default;
  CanonicalFrame(const Matrix3<DoubleDouble>& matrix, const Vec3dd& eye_there) : linear(matrix), eye(eye_there) {
    eye_rounded = to_double(eye);
    for (int k = 0; k < 3; ++k) {
      linear_rounded.column[k] = to_double(linear.column[k]);
      row_size = row_size + magnitudes(linear_rounded.column[k]);
    }
  }

  LocalRay<double> rounded(const Ray& ray) const {
    return {linear_rounded * ray.origin_rounded + eye_rounded, linear_rounded * ray.direction_rounded, origin_size(ray), row_size};
  }
  LocalRay<DoubleDouble> exact(const Ray& ray) const {
    return {linear * ray.origin + eye, linear * ray.direction, origin_size(ray), row_size};
  }

 private:
  Vec3d origin_size(const Ray& ray) const { return row_size * ray.origin_size + magnitudes(eye_rounded); }
};

}  // namespace equilux
