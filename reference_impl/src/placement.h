// Where a canonical shape goes: spec numbers → placement in the eye-relative world.
#pragma once

#include "affine.h"
#include "scene_description.h"

namespace equilux {

// Canonical frame → object coordinates, by kind of shape. Meshes are already in object coordinates.
Placement canonical_to_object(const ObjectDescription& object);

// Object coordinates → eye-relative world: M acts on column vectors, and the eye is subtracted from its translation exactly.
Placement object_to_eye(const ObjectDescription& object, const Vec3d& eye);

// first, then second.
Placement chained(const Placement& first, const Placement& second);

}  // namespace equilux
