// An emitter as one surface point sees it: which pencil of half-planes suits it, and what each of them sees of it.
#pragma once

#include "quadrature.h"
#include "scan.h"
#include "scene_description.h"

namespace equilux {

// Coordinates relative to the shaded point.
//   sphere:      half-planes about the direction to the centre; θ from 0 to the rim of the cone of directions
//   disc:        the same; θ from 0 to where the half-plane leaves the disc
//   rectangle:   half-planes that contain edge_u's direction: each sees a segment across the rectangle, parallel to edge_u
//   environment: half-planes about a given axis; θ from 0 to π
struct EmitterView {
  enum class Kind { sphere, disc, rectangle, environment };

  Kind kind = Kind::environment;
  Pencil pencil;
  double first = -pi, last = pi;  // azimuths
  Vec3d centre;                   // sphere, disc; the middle of the rectangle
  Vec3d normal;                   // disc, rectangle: unit, towards the shaded point's side
  double height = 0;              // distance of the shaded point from the plane of disc or rectangle, > 0
  double radius = 0, cone = 0;    // sphere; cone: half-angle
  Vec3d corner[4];                // rectangle
  Vec3d across[2];                // disc: in its plane, unit, turning with the azimuth
  double u_low = 0, u_high = 0;   // rectangle: along edge_u
  double half_angle = pi;         // of a cone about `towards` that contains the emitter
  Vec3d towards;

  bool flat() const { return kind == Kind::disc || kind == Kind::rectangle; }
  bool round_about() const { return kind != Kind::rectangle; }  // azimuths go full circle

  Stretch stretch(const HalfPlane& plane) const;

  // Half the emitter's extent along m, about its centre.
  double reach(const Vec3d& m) const;

  // Distance along the unit direction ω to the emitter's surface, for a direction that meets it. Infinite for the environment.
  double distance(const Vec3d& direction) const;

  // The variable that is integrated over in place of the azimuth, growing with it: for a disc the turn around its rim, in which a disc seen
  // edge-on is as smooth as any other; else the azimuth itself. slope: dα/dt.
  double turn_of(double azimuth) const;
  double azimuth_of(double turn, double& slope) const;

  // Directions, not unit, around the rim of a sphere or disc: middle + cosine cos φ + sine sin φ.
  struct Rim {
    Vec3d middle, cosine, sine;

    Vec3d at(double turn) const { return middle + cosine * std::cos(turn) + sine * std::sin(turn); }
  };
  Rim rim() const;

  // Azimuths where the great circle m·ω = 0 crosses the emitter's outline.
  void crossings_with(const Vec3d& m, std::vector<Breakpoint>& out) const;
};

// The two turns of a rim where m·ω = 0, if it gets there.
bool rim_crossings(const EmitterView::Rim& rim, const Vec3d& m, double turn[2]);

// False: the point gets nothing from it (behind it, in its plane, or inside the sphere).
bool view_of_sphere(const Vec3d& centre, double radius, const Vec3d& zero, EmitterView& view);
bool view_of_disc(const Vec3d& centre, const Vec3d& normal, double radius, const Vec3d& zero, EmitterView& view);
bool view_of_rectangle(const Vec3d& corner, const Vec3d& edge_u, const Vec3d& edge_v, EmitterView& view);
// Of the environment only what lies within half_angle of the axis counts.
void view_of_environment(const Vec3d& axis, double half_angle, const Vec3d& zero, EmitterView& view);

}  // namespace equilux
