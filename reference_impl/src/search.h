// Which surface a ray meets first. Embree traverses in float; whether and where a shape is crossed is decided here in double, and in
// double-double wherever rounding could tip the decision.
#pragma once

#include <limits>
#include <vector>

#include "world.h"

namespace equilux {

// A crossing that may be the nearest. face: Crossing::face of a shape, 0 for a triangle.
struct Candidate {
  int object = 0;
  int mesh = -1;              // index into World::meshes, or −1
  std::uint32_t triangle = 0;
  int face = 0;
  double s = 0;      // depth along the camera's forward
  double error = 0;  // bound on |error of s|
};

// The candidates within rounding of the nearest crossing found so far, or that may count as coincident with it.
class Candidates {
 public:
  // coincident: up to which difference of s surfaces may count as one, as far as it does not grow with s.
  void clear(double coincident) {
    found_.clear();
    reach_ = std::numeric_limits<double>::infinity();
    slack_ = coincident;
  }
  void offer(const Candidate& candidate);
  const std::vector<Candidate>& found() const { return found_; }
  double reach() const { return reach_; }  // nothing beyond can win

 private:
  std::vector<Candidate> found_;
  double reach_ = std::numeric_limits<double>::infinity(), slack_ = 0;
};

// One camera ray on its way through the world; one per thread, reused.
struct Search {
  const World* world = nullptr;
  FilmRay film_ray;
  TriangleRay triangle_ray{};
  Candidates candidates;
  bool undecided = false;  // which of two surfaces is seen hangs on how exactly coincidence is defined (ray.h)
};

// Fills search.candidates with every crossing that may be the nearest.
void find_candidates(Search& search);

// The winner: nearest, ties to the first object in file order. False: the ray misses everything.
bool nearest_crossing(Search& search, Candidate& winner);

// One object or triangle against the ray.
void try_object(Search& search, int object);
void try_triangle(Search& search, int mesh, std::uint32_t triangle);

// Embree calls these back for a primitive whose box the ray meets. User data of a mesh: its MeshTag.
void intersect_objects(const RTCIntersectFunctionNArguments* args);
void intersect_mesh(const RTCIntersectFunctionNArguments* args);

// s of a candidate in double-double; the candidate's own where rounding let the double see a crossing that is not there.
DoubleDouble exact_depth(const World& world, const FilmRay& ray, const Candidate& candidate);

}  // namespace equilux
