// The surface point that a changed rule shades: which way N points, where V does, and where on a mesh.
#pragma once

#include "opengl.h"

namespace equilux {

// N as the rules want it. Which side was hit (`outside`, `geometric`) stays.
void turn_normal(const Rules& rules, SurfacePoint& point);

// The rule for V on a surface; first: seen by the camera, and not by a secondary ray.
inline Viewer viewer_there(const Rules& rules, bool first) {
  switch (rules.viewer) {
    case Viewer::from_eye_first: return first ? Viewer::from_eye : Viewer::model;
    case Viewer::fixed_first: return first ? Viewer::fixed : Viewer::model;
    default: return rules.viewer;
  }
}

// V of the highlights; secondary rays keep the true one.
inline Vec3dd ruled_viewer(const World& world, const SurfacePoint& point, bool first) {
  const Viewer viewer = viewer_there(world.description.rules, first);
  if (viewer == Viewer::fixed) return -world.camera.forward;
  if (viewer == Viewer::from_eye) return -direction_of(point.position);
  return world.description.model == Model::opengl ? opengl_viewer(world, point) : point.to_viewer;
}

// Whether N points to the outward side: the media before and behind N are told apart by it.
inline bool normal_is_outward(const SurfacePoint& point) {
  return (dot(to_double(point.normal), point.geometric) >= 0) == point.outside;
}

// Where the local model is evaluated, and how much each place counts: the point itself, or the corners of its triangle. Each place's V is
// that of the highlights, so these points are not for secondary rays.
struct LitPlaces {
  SurfacePoint at[3];
  double weight[3] = {1, 0, 0};
  int count = 1;
};

// How much the corners of the point's triangle count at `position`, in its plane.
void corner_weights(const World& world, const SurfacePoint& point, const Vec3dd& position, double (&weight)[3]);

// first: seen by the camera, and not by a secondary ray. `point` has the rules' N.
void find_lit_places(const World& world, const SurfacePoint& point, bool first, LitPlaces& places);

}  // namespace equilux
