#include "packets.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "../blocks.h"
#include "render_packets.h"

namespace equilux::packets {
namespace {

std::atomic<int> most_lanes{16};

Kernel kernel_of(int lanes, const Needs& needs) {
#if defined(EQUILUX_PACKETS_WIDE)
  if (lanes == 16) return kernel_by_8(needs);
  if (lanes == 8) return kernel_by_4(needs);
#endif
  (void)lanes;
  return kernel_by_2(needs);
}

}  // namespace

void limit_lanes(int lanes) { most_lanes = lanes; }

int widest(int most) {
  most = std::min(most, most_lanes.load());
#if defined(EQUILUX_PACKETS_WIDE)
  __builtin_cpu_init();
  const bool has_8 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (most >= 16 && has_8) return 16;
  if (most >= 8 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return 8;
#endif
  return most >= 4 ? 4 : 0;
}

bool know(const World& world) {
  const bool local = world.description.model == Model::phong, traced = world.description.model == Model::raytraced;
  return (local || (traced && !world.features.transparency && !world.features.reflection)) && !world.description.rules.changed() &&
         !world.features.spot && !world.objects.empty();
}

bool suit(const World& world, const Outputs& outputs) {
  return know(world) && outputs.radiance != nullptr && outputs.only_radiance() && widest() > 0;
}

bool render(const World& world, const Samples& samples, const Outputs& outputs, const Finder* finder, int threads, const Cancel* cancel,
            const Interrupted& interrupted, const NewSampler& new_sampler) {
  Needs needs;
  needs.shadows = world.description.model == Model::raytraced && world.features.occlusion;
  needs.highlights = world.features.specular;
  needs.several_lights = world.lights.size() > 1;
  const int lanes = finder != nullptr ? finder->lanes : std::max(widest(), 4);
  const Kernel kernel = kernel_of(lanes, needs);
  const Task task{world, samples, outputs.radiance};
  const std::size_t per_packet = static_cast<std::size_t>(lanes);
  const std::size_t packets = samples.film_xy == nullptr ? block_count(lanes, world.description.width, world.description.height)
                                                         : (samples.count + per_packet - 1) / per_packet;
  return for_each_chunk(packets, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    std::vector<Primitive> met;
    if (finder != nullptr) {
      met.resize((end - begin) * per_packet);
      finder->find(begin, end, met.data());
    }
    std::vector<Left> left((end - begin) * per_packet);
    const std::size_t count = kernel(task, begin, end, finder != nullptr ? met.data() : nullptr, left.data());
    if (count == 0) return;
    const Sampler sampler = new_sampler();
    for (std::size_t i = 0; i < count && !stopped(); ++i) sampler(left[i].sample, left[i].met);
  });
}

}  // namespace equilux::packets
