// What one extended emitter adds to the radiance of one surface point, as two integrals over the directions from which it is seen:
//     diffuse  = ∫ (N·ω)⁺ dω
//     specular = ∫ max(0, R·ω)^p [N·ω > 0] dω          (phong-classic; times N·ω for phong-cosine),   R the mirrored view
// so that L = L_e (K_diff diffuse + K_spec specular). L_i is constant on what is seen, so nothing else is under the integral.
#pragma once

#include "blockers.h"
#include "quadrature.h"
#include "scan_integrals.h"

namespace equilux {

struct Reflecting {
  ShadedPoint point;
  Lobe lobe;
  bool specular = false;
};

// One per thread, reused.
class DirectLight {
 public:
  explicit DirectLight(const Obstacles& obstacles) : obstacles_(obstacles) {}

  // weight: how the two integrals count in the pixel, Σ of both is what `error_target` is relative to: the error asked for is that share of
  // what the point would get if nothing were in between. emitter: its number, or −1 for the environment.
  Integral from(int emitter, const Reflecting& at, Terms weight, double error_target);

 private:
  bool below_horizon(const Reflecting& at) const {
    return dot(at.point.normal, view_.centre) + view_.reach(at.point.normal) <= 0;
  }
  bool look_at(int emitter, const Reflecting& at, const Vec3d& axis, double half_angle);
  Integral over_view(const Reflecting& at, int object, bool diffuse, bool specular, Terms weight, double error_target);
  Terms scan(double turn, const Reflecting& at, bool blocked, bool diffuse, bool specular);
  void arrange_breakpoints(const Reflecting& at, bool blocked, bool specular);

  const Obstacles& obstacles_;
  EmitterView view_;
  Blockers blockers_;
  Gaps gaps_;
  AdaptiveQuadrature quadrature_;
  std::vector<Breakpoint> breakpoints_, ends_;
  std::vector<Vec3d> circles_;
};

}  // namespace equilux
