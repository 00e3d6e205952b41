// Precision as a compile-time policy of the kernel: how a ray is searched and its surface point found.
#pragma once

#include "surface.h"

namespace equilux {

// Search in double (double-double where rounding could tip a decision), surface point in double-double, shading in double.
struct Exact {
  static bool find(const World& world, Search& search, double film_x, double film_y, SurfacePoint& point) {
    search.film_ray = world.camera.ray(film_x, film_y);
    Candidate hit;
    if (!nearest_crossing(search, hit)) return false;
    point = surface_point(world, search.film_ray, hit);
    point.undecided = search.undecided;
    return true;
  }
};

}  // namespace equilux
