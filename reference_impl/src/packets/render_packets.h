// Rendering by packets, with what is left of them done one by one.
#pragma once

#include <functional>

#include "../kernel.h"
#include "../primitive.h"

namespace equilux::packets {

// Computes one sample by itself; made once per chunk and thread. met: what the finder said, if there is one.
using Sampler = std::function<void(std::size_t sample, const Primitive& met)>;
using NewSampler = std::function<Sampler()>;

// Says what the eye's rays of the blocks [begin, end) meet first (blocks.h), lane by lane.
struct Finder {
  int lanes = 0;  // of its blocks
  std::function<void(std::size_t begin, std::size_t end, Primitive* met)> find;
};

// No packet gets more lanes than this, whatever the machine could do: 4, 8 or 16; 0: no packets. For tests.
void limit_lanes(int lanes);

// The lanes of the widest packets that there are, of no more than `most`; 0: none.
int widest(int most = 16);

// Whether packets know this scene's model and lights.
bool know(const World& world);

// Whether they do, and only radiance is asked for.
bool suit(const World& world, const Outputs& outputs);

// finder: of a whole film, whose lanes are those of packets; a sample whose ray does not cross what is found is left to the sampler. Null:
// packets search. Returns false if cancelled or interrupted.
bool render(const World& world, const Samples& samples, const Outputs& outputs, const Finder* finder, int threads, const Cancel* cancel,
            const Interrupted& interrupted, const NewSampler& new_sampler);

}  // namespace equilux::packets
