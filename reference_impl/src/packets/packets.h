// Packets: the exact tracer, several samples at a time.
//
// What a packet does for each of its lanes are the operations of search.cpp, surface.cpp, phong.h and transport.cpp in their order, so a
// picture has the same bits with and without packets, at every width. Only what is plain is done here. A lane where rounding could tip a
// decision, where two surfaces are within rounding of each other, or that meets something that packets do not know is left alone, and its
// sample is computed by itself as ever.
#pragma once

#include "../kernel.h"
#include "../primitive.h"

namespace equilux::packets {

struct Task {
  const World& world;
  const Samples& samples;
  double* radiance;  // 3 per sample
};

// What a scene needs of a kernel. Anything that is false leaves no code behind.
struct Needs {
  bool shadows = false, highlights = false, several_lights = false;
};

// A sample that is to be computed by itself, and what is known of it.
struct Left {
  std::size_t sample;
  Primitive met;
};

// Computes the packets [begin, end) of a task: a whole film in blocks (blocks.h), a list of positions in runs. met: what each lane's ray
// is said to meet first, or null. left: gains the samples that are to be computed by themselves; room for all. Returns how many there are.
using Kernel = std::size_t (*)(const Task& task, std::size_t begin, std::size_t end, const Primitive* met, Left* left);

// One file for each instruction set, by the doubles of a register; a packet has twice as many samples.
Kernel kernel_by_2(const Needs& needs);
Kernel kernel_by_4(const Needs& needs);
Kernel kernel_by_8(const Needs& needs);

// --- Embree's callbacks -----------------------------------------------------------------------------------------------

// The context of a packet's query. The functions that Embree calls are those of single rays; for more than one ray they go on to these.
struct Query : embree::QueryContextBase {
  void (*object)(const RTCIntersectFunctionNArguments* args) = nullptr;
  void (*triangle)(const RTCIntersectFunctionNArguments* args) = nullptr;
  void (*object_between)(const RTCOccludedFunctionNArguments* args) = nullptr;
  void (*triangle_between)(const RTCOccludedFunctionNArguments* args) = nullptr;
};

template <int W, class Arguments> Query& query_of(const Arguments* args) { return *static_cast<Query*>(args->context); }

}  // namespace equilux::packets
