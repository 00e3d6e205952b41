// What one half-plane of directions (scan.h) contributes: ∫ f(θ) sin θ dθ over a stretch of θ.
#pragma once

#include <array>

#include "scan.h"

namespace equilux {

// t − sin t without cancellation.
inline double sine_defect(double t) {
  if (t > 0.5) return t - std::sin(t);
  const double s = t * t;
  double term = t * s / 6, sum = 0;
  for (int k = 4; k <= 20; k += 2) {
    sum += term;
    term *= -s / (k * (k + 1));
  }
  return sum;
}

// ∫ (n·ω) sin θ dθ, exactly: with n·ω = n_a cos θ + n_b sin θ,
//     n_a [sin² θ / 2] + n_b [(θ − sin θ cos θ) / 2]
// written with Δ = high − low and Σ = high + low so that nothing cancels in a short stretch.
inline double cosine_scan(const Vec3d& n, const HalfPlane& plane, Stretch at) {
  const double delta = at.high - at.low, sigma = at.high + at.low;
  const double sine = std::sin(delta), half = std::sin(0.5 * sigma);
  return 0.5 * (dot(n, plane.a) * sine * std::sin(sigma) + dot(n, plane.b) * (sine_defect(delta) + 2 * sine * half * half));
}

// The highlight's lobe max(0, R·ω)^p about the mirrored view R, times n·ω where the BRDF carries the receiver's cosine.
struct Lobe {
  Vec3d mirrored, normal;
  double exponent = 1;
  bool with_cosine = false;
  double width = 1;  // angle from the peak where it has fallen to about 1/√e
  double reach = 0.5 * pi;  // angle from the peak beyond which it is below 1e-20

  Lobe() = default;
  Lobe(const Vec3d& mirrored, const Vec3d& normal, double exponent, bool with_cosine)
      : mirrored(mirrored), normal(normal), exponent(exponent), with_cosine(with_cosine), width(1 / std::sqrt(exponent + 1)) {
    const double cosine = exponent > 0 ? std::exp(-46 / exponent) : 0;
    reach = 2 * std::asin(std::sqrt(0.5 * (1 - cosine)));
  }

  // |∫ lobe dω| over everything is at most this: 2π/(p+1).
  double size() const { return 2 * pi / (exponent + 1); }

  // In one half-plane R·ω = ρ cos u, u = θ − θ_R. cos^p u is integrated by Gauss's rule of 10 nodes in panels of at most two widths, which
  // leaves 1e-15; towards u = ±π/2, where cos^p u is not smooth, in panels shrinking by 4.
  double scan(const HalfPlane& plane, Stretch at) const;

 private:
  double power(double sine, double cosine) const {  // cos^p u
    if (sine * sine < 0.5) return std::exp(0.5 * exponent * std::log1p(-sine * sine));
    return cosine > 0 ? std::exp(exponent * std::log(cosine)) : 0;  // π/2 itself is not a double
  }
};

}  // namespace equilux
