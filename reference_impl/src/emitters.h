// Emitters are ordinary objects of the world, after all others: rays find them as they find everything else, they block light, and a tie
// goes to the object.
#pragma once

#include "scene_description.h"

namespace equilux {

// The scene with each emitter appended to its objects, in order, with a material that emits its radiance and reflects nothing.
SceneDescription with_emitters(SceneDescription scene);

}  // namespace equilux
