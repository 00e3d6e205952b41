#include "emitters.h"

namespace equilux {
namespace {

ShapeKind shape_of(EmitterKind kind) {
  switch (kind) {
    case EmitterKind::sphere: return ShapeKind::sphere;
    case EmitterKind::disc: return ShapeKind::disc;
    case EmitterKind::rectangle: break;
  }
  return ShapeKind::rectangle;
}

}  // namespace

SceneDescription with_emitters(SceneDescription scene) {
  for (const EmitterDescription& emitter : scene.emitters) {
    MaterialDescription glow;
    glow.emission = emitter.radiance;
    glow.brdf = Brdf::lambert;
    ObjectDescription object;
    object.kind = shape_of(emitter.kind);
    object.material = static_cast<int>(scene.materials.size());
    object.matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    object.a = emitter.a;
    object.b = emitter.b;
    object.c = emitter.c;
    object.radius = emitter.radius;
    scene.materials.push_back(glow);
    scene.objects.push_back(object);
  }
  return scene;
}

}  // namespace equilux
