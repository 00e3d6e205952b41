// The path signature (comparison.md, class `edge`): two samples with the same signature are on the same side of every discontinuity.
#pragma once

#include <cstdint>

#include "surface.h"

namespace equilux {

constexpr std::uint64_t signature_of_a_miss = 0;

// A 64-bit hash of object, face, side, and per light: in front (the gate), in the cone, and, for exponents below 1, whose highlight meets
// 0 with a jump or infinitely steep, on the lit side of R·V = 0.
class Signature {
 public:
  Signature() = default;
  explicit Signature(const SurfacePoint& point) { add_surface(point); }
  void add_light(bool in_front, bool in_cone, bool mirrored) { mix((in_front ? 1 : 0) + (in_cone ? 2 : 0) + (mirrored ? 4 : 0)); }
  // Model raytraced: whatever else tells one path from another.
  void add(std::uint64_t what) { mix(what); }
  void add_surface(const SurfacePoint& point) {
    mix(static_cast<std::uint64_t>(point.object));
    mix(static_cast<std::uint64_t>(point.face));
    mix(point.outside ? 1 : 2);
  }
  // Rules that choose N's side anew may turn it where the surface does not.
  void add_normal(const SurfacePoint& point) { mix(dot(to_double(point.normal), point.geometric) < 0 ? 5 : 6); }
  std::uint64_t value() const { return state_ == signature_of_a_miss ? 1 : state_; }

 private:
  // splitmix64's finaliser over the running state.
  void mix(std::uint64_t value) {
    std::uint64_t z = state_ + 0x9e3779b97f4a7c15u + value * 0xd1342543de82ef95u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    state_ = z ^ (z >> 31);
  }
  std::uint64_t state_ = 0x243f6a8885a308d3u;
};

}  // namespace equilux
