// The kernel: packets of samples → radiance. Each instruction set's file instantiates it for its W.
#pragma once

#include "../blocks.h"
#include "shading_packet.h"
#include "shadow_packet.h"

namespace equilux::packets {

// What the kernel is compiled for. Anything that is false here leaves no code behind.
template <int Width, bool Shadows, bool Highlights, bool SeveralLights> struct Compiled {
  static constexpr int width = Width;
  static constexpr bool shadows = Shadows, highlights = Highlights, several_lights = SeveralLights;
};

// Which samples a packet's lanes stand for.
template <int W> struct Place {
  std::size_t sample[2 * W];
  double x[2 * W], y[2 * W];
  unsigned lanes = 0;  // those that stand for one

  Place(const Task& task, std::size_t packet) {
    if (task.samples.film_xy == nullptr) {
      tile(task, packet);
    } else {
      run(task, packet);
    }
  }

 private:
  void put(const Task& task, int lane, std::size_t index) {
    sample[lane] = index;
    if (task.samples.film_xy != nullptr) {
      x[lane] = task.samples.film_xy[2 * index];
      y[lane] = task.samples.film_xy[2 * index + 1];
    } else {
      const std::size_t width = static_cast<std::size_t>(task.samples.film_width);
      x[lane] = static_cast<double>(index % width) + 0.5;
      y[lane] = static_cast<double>(index / width) + 0.5;
    }
    lanes |= 1u << lane;
  }

  void tile(const Task& task, std::size_t packet) {
    const int width = task.samples.film_width;
    const PixelAt block = block_at(2 * W, width, packet);
    for (int lane = 0; lane < 2 * W; ++lane) {
      const PixelAt at = pixel_of_lane(2 * W, block, lane);
      const std::size_t index = static_cast<std::size_t>(at.row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(at.column);
      x[lane] = y[lane] = 0;
      if (at.column < width && index < task.samples.count) put(task, lane, index);
    }
  }

  void run(const Task& task, std::size_t packet) {
    for (int lane = 0; lane < 2 * W; ++lane) {
      const std::size_t index = packet * 2 * W + static_cast<std::size_t>(lane);
      x[lane] = y[lane] = 0;
      if (index < task.samples.count) put(task, lane, index);
    }
  }
};

template <class F> class PacketKernel {
  static constexpr int W = F::width;

 public:
  explicit PacketKernel(const Task& task) : task_(task), world_(task.world), camera_packet_(task.world), shadow_packet_(task.world) {}

  // Writes what is plain; returns the lanes that are not. met: what each lane is said to meet first, or null.
  unsigned render(const Place<W>& place, const Primitive* met) {
    for (int h = 0; h < 2; ++h) look_through(place, h);
    if (met == nullptr) {
      camera_packet_.find();
    } else {
      for (int h = 0; h < 2; ++h) camera_packet_.cross(h, expected(met + h * W));
    }
    for (int h = 0; h < 2; ++h) begin(h);
    const std::size_t lights = F::several_lights ? world_.lights.size() : 1;
    for (std::size_t k = 0; k < lights; ++k) {
      if (k < world_.lights.size()) add_light(world_.lights[k]);
    }
    unsigned left = 0;
    for (int h = 0; h < 2; ++h) left |= write_half(place, h) << (h * W);
    return left;
  }

 private:
  struct Half {
    Surfaces<W> surface;
    Point<W> normal, to_viewer;
    Colours<W> radiance, diffuse, specular;
    Doubles<W> exponent;
    Longs<W> shines;
    Arrivals<W> light;
  };

  // Camera::ray
  void look_through(const Place<W>& place, int h) {
    const Camera& camera = world_.camera;
    CameraRays<W>& rays = camera_packet_.half[h];
    Doubles<W> x, y;
    for (int i = 0; i < W; ++i) {
      x[i] = place.x[h * W + i];
      y[i] = place.y[h * W + i];
    }
    const Exactly<W> height(all<W>(camera.height)), scale = all<W>(camera.scale);
    rays.x = Exactly<W>::two_sum(2.0 * x, all<W>(-camera.width)) / height * scale;
    rays.y = Exactly<W>::two_sum(all<W>(camera.height), -(2.0 * y)) / height * scale;
    rays.active = unpacked<W>(place.lanes >> (h * W));
  }

  static Expected<W> expected(const Primitive* met) {
    Expected<W> result;
    for (int i = 0; i < W; ++i) {
      result.object[i] = met[i].object;
      result.mesh[i] = met[i].mesh;
      result.triangle[i] = met[i].triangle;
    }
    return result;
  }

  void begin(int h) {
    Half& half = half_[h];
    half.surface = SurfaceFinder<W>(world_, camera_packet_.half[h]).find();
    if (!any<W>(half.surface.hit)) return;
    half.normal = rounded<W>(half.surface.normal);
    half.to_viewer = rounded<W>(half.surface.to_viewer);
    const Materials<W> material(world_, half.surface.hit, half.surface.object);
    half.radiance = material.own;
    half.diffuse = material.diffuse;
    half.specular = material.specular;
    half.exponent = material.exponent;
    half.shines = any_of<W>(material.diffuse) | any_of<W>(material.specular);
  }

  void add_light(const Light& light) {
    for (int h = 0; h < 2; ++h) {
      Half& half = half_[h];
      const bool seen = any<W>(half.surface.hit);
      if (seen) half.light = arriving<W>(light, half.surface, half.normal, camera_packet_.half[h].undecided);
      if constexpr (F::shadows) {
        const Longs<W> asks = seen ? half.light.in_front & half.shines : Longs<W>{};
        shadow_packet_.aim(h, asks, half.surface, half.light.toward, half.light.distance);
      }
    }
    if constexpr (F::shadows) shadow_packet_.trace();
    for (int h = 0; h < 2; ++h) {
      if (any<W>(half_[h].surface.hit)) reflect(light, h);
    }
  }

  void reflect(const Light& light, int h) {
    Half& half = half_[h];
    Longs<W>& undecided = camera_packet_.half[h].undecided;
    Longs<W> lit = half.light.in_front;
    if constexpr (F::shadows) {
      undecided |= shadow_packet_.half[h].undecided;
      lit &= ~shadow_packet_.half[h].blocked;
    }
    if (!any<W>(lit)) return;
    const Colours<W> irradiance = product_of<W>(all<W>(light.given.strength), half.light.share);
    Colours<W> reflected = product_of<W>(product_of<W>(irradiance, half.diffuse), half.light.cosine);
    if constexpr (F::highlights) {
      const Longs<W> asks = lit & any_of<W>(half.specular) & any_of<W>(irradiance);
      if (any<W>(asks)) {
        const Doubles<W> lobe = highlights<W>(asks, half.normal, half.to_viewer, half.light, half.exponent, undecided);
        reflected = sum_of<W>(reflected, product_of<W>(product_of<W>(irradiance, half.specular), lobe));
      }
    }
    half.radiance = sum_of<W>(half.radiance, where<W>(lit, reflected));
  }

  unsigned write_half(const Place<W>& place, int h) {
    CameraRays<W>& rays = camera_packet_.half[h];
    const Half& half = half_[h];
    constexpr double infinity = std::numeric_limits<double>::infinity();
    rays.undecided |= half.surface.hit & ~(half.radiance.r + half.radiance.g + half.radiance.b < infinity);
    const unsigned left = packed<W>(rays.active & rays.undecided), lanes = packed<W>(rays.active) & ~left;
    const unsigned hit = packed<W>(half.surface.hit);
    const Bands& background = world_.description.background;
    for (int i = 0; i < W; ++i) {
      if (!(lanes >> i & 1)) continue;
      double* const to = task_.radiance + 3 * place.sample[h * W + i];
      const bool surface = hit >> i & 1;
      to[0] = surface ? half.radiance.r[i] : background.r;
      to[1] = surface ? half.radiance.g[i] : background.g;
      to[2] = surface ? half.radiance.b[i] : background.b;
    }
    return left;
  }

  const Task& task_;
  const World& world_;
  CameraPacket<W> camera_packet_;
  ShadowPacket<W> shadow_packet_;
  Half half_[2];
};

template <class F> std::size_t run(const Task& task, std::size_t begin, std::size_t end, const Primitive* met, Left* left) {
  PacketKernel<F> kernel(task);
  std::size_t count = 0;
  for (std::size_t packet = begin; packet < end; ++packet) {
    const Place<F::width> place(task, packet);
    if (place.lanes == 0) continue;  // beyond the film
    const Primitive* const here = met == nullptr ? nullptr : met + (packet - begin) * 2 * F::width;
    for (unsigned lanes = kernel.render(place, here); lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      left[count++] = {place.sample[lane], here == nullptr ? Primitive{} : here[lane]};
    }
  }
  return count;
}

template <int W> Kernel chosen_kernel(const Needs& needs) {
  static constexpr Kernel table[8] = {
      run<Compiled<W, false, false, false>>, run<Compiled<W, false, false, true>>, run<Compiled<W, false, true, false>>,
      run<Compiled<W, false, true, true>>,   run<Compiled<W, true, false, false>>, run<Compiled<W, true, false, true>>,
      run<Compiled<W, true, true, false>>,   run<Compiled<W, true, true, true>>,
  };
  return table[(needs.shadows ? 4 : 0) + (needs.highlights ? 2 : 0) + (needs.several_lights ? 1 : 0)];
}

}  // namespace equilux::packets
