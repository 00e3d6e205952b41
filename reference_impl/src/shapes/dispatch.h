// From an object's solid to its shape's code.
#pragma once

#include "../world.h"
#include "box.h"
#include "cylinder.h"
#include "disc.h"
#include "plane.h"
#include "rectangle.h"
#include "sphere.h"

namespace equilux {

template <class R> Crossings<R> crossings(Solid solid, const LocalRay<R>& ray) {
  Crossings<R> out;
  switch (solid) {
    case Solid::sphere: SphereShape::cross(ray, out); break;
    case Solid::plane: PlaneShape::cross(ray, out); break;
    case Solid::box: BoxShape::cross(ray, out); break;
    case Solid::disc: DiscShape::cross(ray, out); break;
    case Solid::rectangle: RectangleShape::cross(ray, out); break;
    case Solid::cylinder_capped: CylinderShape::cross_capped(ray, out); break;
    case Solid::cylinder_open: CylinderShape::cross_open(ray, out); break;
    case Solid::mesh: break;
  }
  return out;
}

// In the canonical frame, outward, not unit. face: the crossing's face number without its last bit.
template <class R> Vec3<R> canonical_normal(Solid solid, const Vec3<R>& p, int face) {
  switch (solid) {
    case Solid::sphere: return SphereShape::normal(p, face);
    case Solid::box: return BoxShape::normal(p, face);
    case Solid::cylinder_capped:
    case Solid::cylinder_open: return CylinderShape::normal(p, face);
    default: return planar_normal<R>();
  }
}

// Half the extent of the canonical shape along w: the largest w·p.
inline double half_extent(Solid solid, const Vec3d& w) {
  switch (solid) {
    case Solid::sphere: return SphereShape::half_extent(w);
    case Solid::box: return BoxShape::half_extent(w);
    case Solid::disc: return DiscShape::half_extent(w);
    case Solid::rectangle: return RectangleShape::half_extent(w);
    case Solid::cylinder_capped:
    case Solid::cylinder_open: return CylinderShape::half_extent(w);
    default: return 0;
  }
}

}  // namespace equilux
