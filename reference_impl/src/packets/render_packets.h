// Rendering by packets, with what is left of them done one by one.
#pragma once

#include <functional>

#include "../kernel.h"

namespace equilux::packets {

// Computes one sample by itself; made once per chunk and thread.
using Sampler = std::function<void(std::size_t sample)>;
using NewSampler = std::function<Sampler()>;

// No packet gets more lanes than this, whatever the machine could do: 4, 8 or 16; 0: no packets. For tests.
void limit_lanes(int lanes);

// Whether packets know this scene's model and lights, and only radiance is asked for.
bool suit(const World& world, const Outputs& outputs);

// Returns false if cancelled or interrupted.
bool render(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
            const Interrupted& interrupted, const NewSampler& new_sampler);

}  // namespace equilux::packets
