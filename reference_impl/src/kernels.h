// One kernel per kind of model; render() in kernel.cpp chooses.
#pragma once

#include "kernel.h"

namespace equilux {

// phong and opengl
bool render_local(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
                  const Interrupted& interrupted);

}  // namespace equilux
