#include "float_mode.h"

#include <bit>
#include <chrono>
#include <new>

#include "flushed.h"

namespace equilux::fast {
namespace {

// Memory for a kernel's waiting rays, one per chunk of blocks.
class Scratch {
 public:
  explicit Scratch(std::size_t bytes) : memory_(::operator new(bytes, std::align_val_t{64})) {}
  ~Scratch() { ::operator delete(memory_, std::align_val_t{64}); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  void* get() const { return memory_; }

 private:
  void* memory_;
};

}  // namespace

double FloatMode::displacement_px() const {
  const Camera& camera = scene_.world().camera;
  const double half_film = to_double(camera.scale);  // at distance 1, or in metres
  const double per_length = 0.5 * camera.height / half_film;
  return 0x1p-14 * per_length * (camera.perspective() ? 1 : 2 / scene_.scale());
}

bool FloatMode::render(float* radiance, float* rounding, int threads, const Cancel* cancel, const Interrupted& interrupted) const {
  const Tables& tables = scene_.tables();
  const Kernels& kernels = scene_.kernels();
  const RenderBlocks kernel = kernels.choose(scene_.features(), rounding != nullptr);
  const PacketOutputs out{radiance, rounding, nullptr};
  return for_each_chunk(kernels.block_count(tables), threads, cancel, interrupted, [&](std::size_t begin, std::size_t end) {
    const FlushedToZero flushed;
    const Scratch scratch(kernels.scratch_bytes(tables.recursion_limit));
    kernel(tables, begin, end, out, scratch.get());
  });
}

void FloatMode::record_shadows(int threads) const {
  const Tables& tables = scene_.tables();
  const Kernels& kernels = scene_.kernels();
  FloatFeatures first = scene_.features();
  first.secondary = false;
  if (!first.shadows) return;
  const RenderBlocks kernel = kernels.choose(first, false);
  shadowed_.assign(kernels.block_count(tables) * static_cast<std::size_t>(tables.lamp_count), 0);
  std::vector<float> radiance(3 * static_cast<std::size_t>(tables.width) * static_cast<std::size_t>(tables.height));
  const PacketOutputs out{radiance.data(), nullptr, shadowed_.data()};
  for_each_chunk(kernels.block_count(tables), threads, nullptr, {}, [&](std::size_t begin, std::size_t end) {
    const FlushedToZero flushed;
    kernel(tables, begin, end, out, nullptr);
  });
  for (const std::uint32_t lanes : shadowed_) shadow_rays_ += static_cast<std::uint64_t>(std::popcount(lanes));
}

TraversalTime FloatMode::traverse(int threads) const {
  const Tables& tables = scene_.tables();
  const Kernels& kernels = scene_.kernels();
  std::call_once(recorded_, [&] { record_shadows(threads); });
  if (shadowed_.empty()) shadowed_.assign(kernels.block_count(tables) * static_cast<std::size_t>(tables.lamp_count), 0);
  const auto started = std::chrono::steady_clock::now();
  for_each_chunk(kernels.block_count(tables), threads, nullptr, {}, [&](std::size_t begin, std::size_t end) {
    const FlushedToZero flushed;
    kernels.traverse(tables, begin, end, shadowed_.data());
  });
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - started;
  return {static_cast<std::uint64_t>(tables.width) * static_cast<std::uint64_t>(tables.height), shadow_rays_, taken.count()};
}

}  // namespace equilux::fast
