// Which surface a ray meets: an object and, of a mesh, which of its triangles.
#pragma once

#include <cstdint>

namespace equilux {

struct Primitive {
  std::int32_t object = -1;  // −1: none
  std::int32_t mesh = -1;    // index into World::meshes, or −1
  std::uint32_t triangle = 0;
};

}  // namespace equilux
