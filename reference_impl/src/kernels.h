// One kernel per kind of model; render() in kernel.cpp chooses.
#pragma once

#include "kernel.h"

namespace equilux {

bool render_local(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                  const Interrupted& interrupted);  // phong

bool render_opengl(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                   const Interrupted& interrupted);

bool render_ruled(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                  const Interrupted& interrupted);  // phong, opengl, with changed rules

bool render_raytraced(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                      const Interrupted& interrupted);

bool render_emitters(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                     const Interrupted& interrupted);  // reflection_equation

}  // namespace equilux
