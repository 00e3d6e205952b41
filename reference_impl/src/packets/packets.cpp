#include "packets.h"

#include <atomic>
#include <vector>

#include "render_packets.h"

namespace equilux::packets {
namespace {

std::atomic<int> most_lanes{16};

}  // namespace

void limit_lanes(int lanes) { most_lanes = lanes; }

Kernel widest_kernel(const Needs& needs, int& lanes) {
#if defined(EQUILUX_PACKETS_WIDE)
  __builtin_cpu_init();
  const int most = most_lanes;
  if (most >= 16 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    lanes = 16;
    return kernel_by_8(needs);
  }
  if (most >= 8 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    lanes = 8;
    return kernel_by_4(needs);
  }
#endif
  lanes = 4;
  return kernel_by_2(needs);
}

bool suit(const World& world, const Outputs& outputs) {
  const bool local = world.description.model == Model::phong, traced = world.description.model == Model::raytraced;
  return (local || (traced && !world.features.transparency && !world.features.reflection)) && !world.description.rules.changed() &&
         !world.features.spot && outputs.radiance != nullptr && outputs.only_radiance() && !world.objects.empty() &&
         most_lanes >= 4;
}

bool render(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
            const Interrupted& interrupted, const NewSampler& new_sampler) {
  Needs needs;
  needs.shadows = world.description.model == Model::raytraced && world.features.occlusion;
  needs.highlights = world.features.specular;
  needs.several_lights = world.lights.size() > 1;
  int lanes = 0;
  const Kernel kernel = widest_kernel(needs, lanes);
  Task task{world, samples, outputs.radiance};
  task.rows = lanes == 16 ? 4 : 2;
  task.columns = lanes / task.rows;
  const std::size_t width = static_cast<std::size_t>(samples.film_width), height = (samples.count + width - 1) / width;
  const std::size_t rows = static_cast<std::size_t>(task.rows), per_packet = static_cast<std::size_t>(lanes);
  const std::size_t packets = samples.film_xy == nullptr ? packets_across(task) * ((height + rows - 1) / rows)
                                                         : (samples.count + per_packet - 1) / per_packet;
  return for_each_chunk(packets, threads, cancel, interrupted, [&](std::size_t begin, std::size_t end, const Stopped& stopped) {
    std::vector<std::size_t> left((end - begin) * per_packet);
    const std::size_t count = kernel(task, begin, end, left.data());
    if (count == 0) return;
    const Sampler sampler = new_sampler();
    for (std::size_t i = 0; i < count && !stopped(); ++i) sampler(left[i]);
  });
}

}  // namespace equilux::packets
