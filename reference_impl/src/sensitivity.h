// How far radiance may move when normals and positions do: what a *geometric* uncertainty is propagated through (comparison.md).
#pragma once

#include <vector>

#include "kernel.h"

namespace equilux {

// Bounds of a renderer's geometry, one per object: |ΔN| of the unit normal, |ΔP| in metres.
struct GeometricBounds {
  std::vector<double> normal, position_m;
};

// Writes 3 bands per sample. With t₁, t₂ two tangent directions at the shaded point and δN, δP the object's bounds:
//     Σ_{t = t₁, t₂} max_± |L(N ± δN t) − L(N)|  +  Σ_{u = t₁, t₂, N} max_± |L(P ± δP u) − L(P)|
// with steps of full size, N made unit again, V following P where it points to the eye. The path signature is held: gates of highlights and
// cones stay as they are at the unmoved point (a change there is a discontinuity, the business of class `edge`). The diffuse term has no
// jump at its gate, so it follows max(0, N·L) freely. A miss gives 0. Returns false if cancelled or interrupted.
bool sensitivity(const World& world, const Samples& samples, const GeometricBounds& bounds, double* out, int threads,
                 const Cancel* cancel, const Interrupted& interrupted);

}  // namespace equilux
