// Scan lines over directions. A pencil of half-planes through the shaded point shares one axis; a direction is (azimuth α of its half-plane,
// angle θ from the axis), dω = sin θ dθ dα. What one half-plane sees of convex things are intervals of θ, found exactly; the integral over α
// is left to adaptive quadrature.
#pragma once

#include <algorithm>
#include <numbers>
#include <vector>

#include "vec3.h"

namespace equilux {

constexpr double pi = std::numbers::pi;

// Directions a cos θ + b sin θ, 0 ≤ θ ≤ π. a, b, normal = a × b: unit, orthogonal.
struct HalfPlane {
  Vec3d a, b, normal;

  Vec3d direction(double theta) const { return a * std::cos(theta) + b * std::sin(theta); }
};

struct Pencil {
  Vec3d axis, zero, quarter;  // orthonormal; azimuths 0 and π/2

  HalfPlane at(double azimuth) const {
    const double c = std::cos(azimuth), s = std::sin(azimuth);
    return {axis, zero * c + quarter * s, quarter * c - zero * s};
  }
  double azimuth(const Vec3d& direction) const { return std::atan2(dot(direction, quarter), dot(direction, zero)); }
};

// A pencil whose azimuth 0 points towards `zero`, as far as that is not along the axis.
inline Pencil pencil_about(const Vec3d& axis, const Vec3d& zero) {
  Pencil pencil;
  pencil.axis = axis;
  const Vec3d across = zero - axis * dot(axis, zero);
  const double size = length(across);
  if (size > 1e-9) {
    pencil.zero = unit(across - axis * dot(axis, across));
    pencil.quarter = cross(axis, pencil.zero);
  } else {
    complete_frame(axis, pencil.zero, pencil.quarter);
  }
  return pencil;
}

struct Stretch {
  double low = 0, high = 0;

  bool empty() const { return !(low < high); }
};

// The part of a stretch of the half-plane where m·ω > 0; m need not be unit. Always one stretch: both arcs are at most half a turn.
inline Stretch in_front_of(const Vec3d& m, const HalfPlane& plane, Stretch stretch) {
  double middle = std::atan2(dot(m, plane.b), dot(m, plane.a));
  if (middle < -0.5 * pi) middle += 2 * pi;
  stretch.low = std::max(stretch.low, middle - 0.5 * pi);
  stretch.high = std::min(stretch.high, middle + 0.5 * pi);
  return stretch;
}

// Up to four angles in [0, π) or, twice that, azimuths, where P cos² + 2 Q cos sin + R sin² = 0: two per half turn, or none.
inline bool roots_of_form(double P, double Q, double R, double root[2]) {
  const double mean = 0.5 * (P + R), swing = std::hypot(0.5 * (P - R), Q);
  if (!(std::fabs(mean) < swing)) return false;
  const double middle = std::atan2(Q, 0.5 * (P - R));
  // acos(−mean/swing), without losing digits where it is near 0 or π
  const double apart = 2 * std::atan2(std::sqrt(swing + mean), std::sqrt(swing - mean));
  root[0] = 0.5 * (middle - apart);
  root[1] = 0.5 * (middle + apart);
  for (int k = 0; k < 2; ++k) {
    if (root[k] < 0) root[k] += pi;
    if (root[k] >= pi) root[k] -= pi;
  }
  return true;
}

// Stretches that are taken out of another.
class Gaps {
 public:
  void clear() { gaps_.clear(); }
  bool empty() const { return gaps_.empty(); }
  void add(double low, double high) {
    if (low < high) gaps_.push_back({low, high});
  }
  // Calls f(piece) for what is left of `whole`, in order.
  template <class F> void rest_of(Stretch whole, const F& f) {
    std::sort(gaps_.begin(), gaps_.end(), [](const Stretch& a, const Stretch& b) { return a.low < b.low; });
    double from = whole.low;
    for (const Stretch& gap : gaps_) {
      if (gap.low >= whole.high) break;
      if (gap.low > from) f(Stretch{from, gap.low});
      from = std::max(from, gap.high);
    }
    if (from < whole.high) f(Stretch{from, whole.high});
  }

 private:
  std::vector<Stretch> gaps_;
};

}  // namespace equilux
