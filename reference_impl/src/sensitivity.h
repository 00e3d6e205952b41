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

// The same for model raytraced: the sum over all hits h of all paths of w_h times the sum above, w_h the weight of the path to h, δN and δP
// those of the object that is hit, and L what leaves the hit towards where the path came from. Every hit has an error of its own,
// independent of the others even on one object, so that their worst cases add up.
//
// A step at a hit moves the local terms and bends the secondary rays, which are followed anew to their end. V follows P at the first
// hit, as above; deeper, a ray has the direction that it has. Sides, cones and shadows of the lights at the hit are held (a light whose
// shadow was of no interest, because it is on the side that does not count, has none). Where a secondary ray comes back with another path
// signature, that discontinuity is left to class `edge`, and of the continuous change counts what the largest step of 1/8, 1/64, 1/512 or
// 1/4096 of the size shows that keeps the signature, times 8, 64, …; 0 if none does.
bool sensitivity_raytraced(const World& world, const Samples& samples, const GeometricBounds& bounds, double* out, int threads,
                           const Cancel* cancel, const Interrupted& interrupted);

// The same for model reflection_equation. The integrals are evaluated anew at each step, to 1e-6; steps smaller than 1e-4 (of a
// highlight's width, and of the distance to the nearest emitter) are taken at that size and their effect scaled down, so that the error
// of the integrals does not drown it. Visibility of the lights without an extent is held; penumbrae move. A sample that sees an emitter
// gives 0: its radiance is the same all over.
bool sensitivity_emitters(const World& world, const Samples& samples, const GeometricBounds& bounds, double* out, int threads,
                          const Cancel* cancel, const Interrupted& interrupted);

}  // namespace equilux
