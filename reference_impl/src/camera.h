// The camera: film position → ray. The ray of a film position is kept as two numbers (x, y) in the camera's own frame
//   perspective:  P(s) = s (x·right + y·up + forward)          (eye-relative)
//   orthographic: P(s) = x·right + y·up + s·forward
// so that s is the depth along `forward`, one parameter for every object, whatever frame it is intersected in.
#pragma once

#include "scene_description.h"

namespace equilux {

// Where a film position looks, to 2^-100, and rounded to double for the search.
struct FilmRay {
  DoubleDouble x, y;
  double x_rounded = 0, y_rounded = 0;
};

struct Camera {
  Projection projection;
  Vec3d eye;
  Vec3dd right, up, forward;
  DoubleDouble scale;  // film units (half heights) → x, y: tan(fov_y/2), or half the height in metres
  double width, height;

  explicit Camera(const SceneDescription& scene);

  bool perspective() const { return projection == Projection::perspective; }

  // film_x, film_y in pixels, (0.5, 0.5) is the centre of the top-left pixel. 2·film − size is exact as a double-double, so that neither
  // a 20000-pixel film nor a 1° field of view costs a digit.
  FilmRay ray(double film_x, double film_y) const {
    FilmRay ray;
    ray.x = two_difference(2 * film_x, width) / DoubleDouble(height) * scale;
    ray.y = two_difference(height, 2 * film_y) / DoubleDouble(height) * scale;
    ray.x_rounded = to_double(ray.x);
    ray.y_rounded = to_double(ray.y);
    return ray;
  }

  // D, not unit: P(s) = origin + s D.
  Vec3dd direction(const FilmRay& ray) const { return perspective() ? right * ray.x + up * ray.y + forward : forward; }
  Vec3dd origin(const FilmRay& ray) const { return perspective() ? Vec3dd{} : right * ray.x + up * ray.y; }
};

inline Camera::Camera(const SceneDescription& scene)
    : projection(scene.camera.projection), eye(scene.camera.eye), width(scene.width), height(scene.height) {
  const CameraDescription& given = scene.camera;
  forward = direction_of(difference(given.target, given.eye));
  right = direction_of(cross(forward, scaled_to_one(exactly(given.up))));
  up = cross(right, forward);
  if (!std::isfinite(to_double(dot(right, right) + dot(up, up)))) {
    throw TracerError("camera: eye and target coincide, or up is parallel to the view");
  }
  if (perspective()) {
    const SineCosine half = sine_cosine_of_degrees(DoubleDouble(given.fov_y_deg) * 0.5);
    scale = half.sine / half.cosine;
  } else {
    scale = DoubleDouble(given.height_m) * 0.5;
  }
}

}  // namespace equilux
