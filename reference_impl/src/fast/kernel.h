// What a packet kernel offers to the code that has the baseline's instruction set: function pointers, one set per width.
#pragma once

#include <cstddef>

#include "tables.h"

namespace equilux::fast {

// What a kernel is compiled for; what is false leaves no code behind.
struct FloatFeatures {
  bool specular = false;    // some highlight
  bool shadows = false;     // something may stand between a light and a surface
  bool lamps = false;       // anything but one point light that falls off with r² alone
  bool meshes = false;      // interpolated normals, or triangles at all
  bool planes = false;      // they have no bounds, and are crossed outside Embree
  bool secondary = false;   // mirrored or refracted rays: then all of the above
};

struct PacketOutputs {
  float* radiance = nullptr;        // 3 per pixel
  float* rounding = nullptr;        // 3 per pixel, or null
  std::uint32_t* shadowed = nullptr;  // lamps per block: which lanes sent a shadow ray; or null
};

// Renders blocks [begin, end). scratch: scratch_bytes of memory of the calling thread's own, aligned to 64.
using RenderBlocks = void (*)(const Tables&, std::size_t begin, std::size_t end, const PacketOutputs&, void* scratch);
// Sends the same rays and shades nothing. shadowed: from RenderBlocks.
using TraverseBlocks = void (*)(const Tables&, std::size_t begin, std::size_t end, const std::uint32_t* shadowed);
// What the eye's rays meet first: W for each block, lane by lane. Blocks beyond the film are passed over.
using FindBlocks = void (*)(const Tables&, std::size_t begin, std::size_t end, Primitive* met);

struct Kernels {
  int width = 0;
  std::size_t (*block_count)(const Tables&) = nullptr;
  RenderBlocks (*choose)(const FloatFeatures&, bool rounding) = nullptr;
  TraverseBlocks traverse = nullptr;
  FindBlocks find = nullptr;
  std::size_t (*scratch_bytes)(int recursion_limit) = nullptr;
  RTCIntersectFunctionN intersect_shapes = nullptr;
  RTCOccludedFunctionN occlude_shapes = nullptr;
};

// Null where this build has none of that width.
const Kernels* kernels_of_4();
const Kernels* kernels_of_8();
const Kernels* kernels_of_16();

// Raises TracerError: a shadow ray met more transparent surfaces than are followed.
[[noreturn]] void refuse_crossings(int at_most);

}  // namespace equilux::fast
