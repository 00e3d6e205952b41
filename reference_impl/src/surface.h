// The shaded point, found again in double-double once the search has said which surface it lies on.
#pragma once

#include "search.h"

namespace equilux {

// All eye-relative world coordinates; directions unit, leaving the surface.
struct SurfacePoint {
  int object = 0;
  int face = 0;                // face of a box or cylinder; triangle of a flat mesh; else 0
  bool outside = true;         // the viewer is on the side of the outward (winding) normal
  DoubleDouble s;              // depth along the camera's forward
  double distance = 0;         // along the unit ray, metres
  Vec3dd position;
  Vec3dd normal;               // N, unit, on the viewer's side
  bool turned = false;         // N is minus the outward normal, or minus the one stored with a mesh
  Vec3dd to_viewer;            // V, unit
  // For the rays that leave this point
  int mesh = -1;               // index into World::meshes, or −1
  std::uint32_t triangle = 0;
  Vec3d geometric;             // Ng, not unit, on the viewer's side
  double position_size = 0;    // the lengths that were added up to find the position
  bool undecided = false;      // of the eye's own: another reading of what coincides (ray.h) would see another surface
};

SurfacePoint surface_point(const World& world, const FilmRay& ray, const Candidate& hit);
SurfacePoint surface_point(const World& world, const Ray& ray, const Candidate& hit);  // s: metres along the ray

}  // namespace equilux
