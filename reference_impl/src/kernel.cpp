#include "kernels.h"

#include <algorithm>

namespace equilux {

bool render(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
            const Interrupted& interrupted) {
  if (outputs.quadrature != nullptr && world.description.model != Model::reflection_equation) {
    std::fill_n(outputs.quadrature, 3 * samples.count, 0.0);  // nothing else is integrated
  }
  const bool ruled = world.description.rules.changed();
  switch (world.description.model) {
    case Model::phong:
      return (ruled ? render_ruled : render_local)(world, samples, outputs, threads, cancel, interrupted);
    case Model::opengl:
      return (ruled ? render_ruled : render_opengl)(world, samples, outputs, threads, cancel, interrupted);
    case Model::raytraced:
      return render_raytraced(world, samples, outputs, threads, cancel, interrupted);
    case Model::reflection_equation:
      return render_emitters(world, samples, outputs, threads, cancel, interrupted);
  }
  throw TracerError("no such model");
}

}  // namespace equilux
