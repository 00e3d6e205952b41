// What may stand between one surface point and one emitter, and which stretches of a half-plane of directions (scan.h) it blocks.
//
// Nothing is sampled. In a half-plane the blocked angles of a shape begin and end where the half-plane's direction touches the shape's
// outline, meets one of its edges, or meets the curve where the shape pierces the emitter; between two such angles one ray decides. So
// each scan line is cut exactly, and only the integral across scan lines is left to quadrature. Where its integrand bends (outlines cross
// each other, the horizon or the emitter's own) is found as well, so that it is smooth between breakpoints almost everywhere.
#pragma once

#include "emitter_view.h"
#include "world.h"

namespace equilux {

// The world's objects in double, for all points of a render.
class Obstacles {
 public:
  struct Shape {
    Solid solid;
    int object;
    Matrix3<double> back;     // to the canonical frame
    Matrix3<double> columns;  // and from it
    Placement placement;
  };
  // Some neighbouring triangles of a mesh in a ball.
  struct Cluster {
    int object;
    Vec3d centre;
    double radius;
    std::size_t first, last;
  };

  explicit Obstacles(const World& world);

  const World& world;
  std::vector<Shape> shapes;
  std::vector<Cluster> clusters;
  std::vector<std::array<Vec3d, 3>> triangles;  // eye-relative
};

// A surface point as the integrals need it: double, directions unit.
struct ShadedPoint {
  Vec3dd position;  // eye-relative
  Vec3d normal;     // N
  int object = 0;
  bool outside = true;
};

class Blockers {
 public:
  // Everything that may be between the point and the emitter. emitter_object: its own index among the world's objects, −1 the environment.
  void gather(const Obstacles& obstacles, const ShadedPoint& point, const EmitterView& emitter, int emitter_object);

  bool empty() const { return shapes_.empty() && triangles_.empty(); }

  // How much more work a scan line is than without triangles.
  double burden() const { return 1 + 0.02 * static_cast<double>(triangles_.size()); }

  // The stretches of `within` from where the emitter is not seen.
  void gaps(const HalfPlane& plane, Stretch within, Gaps& out);

  // Azimuths where the blocked part may begin, end or bend.
  // circles: normals of great circles that bound the integrand: the horizon, and the end of a highlight's lobe.
  void breakpoints(const std::vector<Vec3d>& circles, std::vector<Breakpoint>& out);

 private:
  struct Shape {
    Solid solid;
    bool own, inside, pierces;
    Vec3d o;  // the point in the canonical frame
    Matrix3<double> back, columns;
    Vec3d centre;
  };
  struct Triangle {
    Vec3d corner[3];
  };
  // Neighbouring triangles in a ball: a half-plane that misses the ball misses them all.
  struct Bundle {
    Vec3d centre;
    double radius;
    std::size_t first, last;
  };
  using Rim = EmitterView::Rim;
  // What a shape looks like from the point: straight edges and round ones.
  struct Outline {
    const Shape* shape = nullptr;
    std::vector<std::array<Vec3d, 2>> edges;
    std::vector<Rim> rims;
  };

  void outline_angles(const Shape& shape, const HalfPlane& plane, std::vector<double>& out) const;
  void piercing_angles(const Shape& shape, const HalfPlane& plane, std::vector<double>& out) const;
  bool blocks(const Shape& shape, const Vec3d& direction) const;
  void triangle_gap(const Triangle& triangle, const HalfPlane& plane, Gaps& out) const;
  void edges_of(const Shape& shape, std::vector<std::array<Vec3d, 2>>& out) const;
  void rims_of(const Shape& shape, std::vector<Rim>& out) const;
  template <class F> void crossings_of_edges(const Outline& a, const Outline& b, const F& found) const;
  template <class F> void crossings_with_rims(const Outline& a, const std::vector<Rim>& rims, const F& found) const;
  bool matters(const Vec3d& direction) const;
  void add_cuts(const Shape& shape, std::vector<Breakpoint>& out) const;
  void extent_of(const Shape& shape, std::vector<Breakpoint>& out) const;
  void tangents(const Vec3d& centre, const Vec3d* columns, int count, std::vector<Breakpoint>& out) const;

  const EmitterView* emitter_ = nullptr;
  bool pierced_ = false;  // the sphere emitter, by the shape whose breakpoints are being found
  std::vector<Shape> shapes_;
  std::vector<Triangle> triangles_;
  std::vector<Bundle> bundles_;
  std::vector<double> angles_;
  std::vector<Vec3d> circles_;
  std::vector<Outline> outlines_;
};

}  // namespace equilux
