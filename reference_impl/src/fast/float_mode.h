// The float and the refined precision: pictures by packets.
#pragma once

#include <mutex>

#include "../kernel.h"
#include "float_scene.h"

namespace equilux::fast {

// How long a traversal took, and of how many rays.
struct TraversalTime {
  std::uint64_t eye_rays = 0, shadow_rays = 0;
  double seconds = 0;
};

class FloatMode {
 public:
  FloatMode(const World& world, int width) : scene_(world, width) {}

  int width() const { return scene_.kernels().width; }
  std::size_t pixels() const {
    return static_cast<std::size_t>(scene_.tables().width) * static_cast<std::size_t>(scene_.tables().height);
  }

  // How far a silhouette or the border of a shadow may be displaced, pixels: 2^-14 of the lengths involved, as seen. Eye rays and surfaces
  // are off by a few 2^-24; shadow rays start 2^-19 beside the surface, and a border that they draw is moved by 2^5 times that where
  // light or view pass along the surface at 2 degrees.
  double displacement_px() const;

  // Radiance, and the bound of its arithmetic error or null: float, 3 per pixel, row by row. False: cancelled or interrupted.
  bool render(float* radiance, float* rounding, int threads, const Cancel* cancel, const Interrupted& interrupted) const;

  // The same rays in the same packets and in the same order, nothing shaded: what Embree alone needs. The first call finds out, by
  // rendering, which shadow rays there are; that is not in the time. Secondary rays are not sent.
  TraversalTime traverse(int threads) const;

  // The same in double, with the bound of the exact mode: the eye's rays find their surface in float packets, everything else is exact.
  // Where the exact crossing contradicts the packet (at a silhouette), the exact search decides. A scene whose surfaces the exact mode's
  // packets find faster than Embree's float traversal does (spheres, discs and rectangles) gets the exact picture.
  bool refine(double* radiance, double* rounding, int threads, const Cancel* cancel, const Interrupted& interrupted) const;

 private:
  void record_shadows(int threads) const;

  FloatScene scene_;
  mutable std::once_flag recorded_;
  mutable std::vector<std::uint32_t> shadowed_;
  mutable std::uint64_t shadow_rays_ = 0;
};

}  // namespace equilux::fast
