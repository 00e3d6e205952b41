#include "kernels.h"

namespace equilux {

bool render(const World& world, const Samples& samples, const Outputs& outputs, int threads, const Cancel* cancel,
            const Interrupted& interrupted) {
  switch (world.description.model) {
    case Model::phong:
      return render_local(world, samples, outputs, threads, cancel, interrupted);
    case Model::opengl:
      return render_opengl(world, samples, outputs, threads, cancel, interrupted);
    case Model::raytraced:
      return render_raytraced(world, samples, outputs, threads, cancel, interrupted);
    case Model::reflection_equation:
      throw TracerError("model reflection-equation: not in this version");
  }
  throw TracerError("no such model");
}

}  // namespace equilux
