// The renderer: samples of the film → radiance and, on request, its terms and the geometry behind it.
#pragma once

#include <cstdint>

#include "film.h"
#include "world.h"

namespace equilux {

// Where to sample: n film positions in pixels, or, without them, the centres of all pixels, row by row.
struct Samples {
  const double* film_xy = nullptr;
  std::size_t count = 0;
  int film_width = 1;

  void position(std::size_t i, double& x, double& y) const {
    if (film_xy != nullptr) {
      x = film_xy[2 * i];
      y = film_xy[2 * i + 1];
    } else {
      const std::size_t width = static_cast<std::size_t>(film_width);
      x = static_cast<double>(i % width) + 0.5;
      y = static_cast<double>(i / width) + 0.5;
    }
  }
};

// Where to write, one entry per sample; null: not asked for. Units: radiance and its terms W/(m²·sr), lengths metres.
struct Outputs {
  double* radiance = nullptr;   // 3
  double* emission = nullptr;   // 3
  double* ambient = nullptr;    // 3
  double* light_ambient = nullptr;  // lights × 3: opengl
  double* diffuse = nullptr;    // lights × 3
  double* specular = nullptr;   // lights × 3
  double* reflected = nullptr;    // 3: raytraced
  double* transmitted = nullptr;  // 3: raytraced
  double* rounding = nullptr;   // 3: bound on the arithmetic error of radiance, derived in phong.h, opengl.h and raytraced.h
  double* quadrature = nullptr;  // 3: bound on the error of the integrals of model reflection_equation
  std::int32_t* object_id = nullptr;
  double* depth = nullptr;      // distance along the unit ray, inf on a miss
  double* normal = nullptr;     // 3; 0 on a miss
  double* position = nullptr;   // 3, world; NaN on a miss
  std::uint64_t* signature = nullptr;

  bool only_radiance() const {
    return !emission && !ambient && !light_ambient && !diffuse && !specular && !reflected && !transmitted && !rounding && !quadrature &&
           !object_id && !depth && !normal && !position && !signature;
  }
};

// Returns false if cancelled or interrupted.
bool render(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
            const Interrupted& interrupted);

}  // namespace equilux
