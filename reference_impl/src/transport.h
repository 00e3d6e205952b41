// Rays that start anywhere: what they meet first, and what stands between a point and a light.
//
// As for camera rays, Embree finds candidates in float, shapes are crossed in double, and in double-double wherever rounding could tip
// a decision.
#pragma once

#include <cstdint>
#include <vector>

#include "search.h"
#include "surface.h"

namespace equilux {

// The ray that leaves a surface point in `direction`, a unit vector.
Ray leaving(const World& world, const SurfacePoint& point, const Vec3dd& direction);

// Told of every crossing ahead, in no particular order; s in metres. Nothing beyond reach() need be told.
class Crossed {
 public:
  virtual void offer(const Candidate& crossing) = 0;
  virtual double reach() const = 0;

 protected:
  ~Crossed() = default;
};

// Sends rays through the world; one per thread, reused.
class Traversal {
 public:
  explicit Traversal(const World& world) : world_(world) {}

  // Tells `crossed` of every crossing of the ray that may lie within its reach.
  void follow(const Ray& ray, Crossed& crossed);

  // The first surface: nearest, ties to the first object in file order. False: the ray misses everything.
  bool nearest(const Ray& ray, Candidate& winner);

  const World& world() const { return world_; }

  bool undecided = false;  // set where a ray's crossing hangs on how exactly coincidence is defined (ray.h); the caller clears it

  // Embree's callbacks end here.
  void try_object(int object);
  void try_triangle(int mesh, std::uint32_t triangle);
  float reach_for_embree() const;

 private:
  void send_through_embree();
  bool place_embree_ray();  // false: it misses all boxes
  bool place_far_embree_ray();

  struct Nearest final : Crossed {
    Candidates candidates;
    void offer(const Candidate& crossing) override { candidates.offer(crossing); }
    double reach() const override { return candidates.reach(); }
  };

  const World& world_;
  const Ray* ray_ = nullptr;
  Crossed* crossed_ = nullptr;
  AnywhereTriangleRay triangle_ray_;
  Vec3d origin_in_camera_, direction_in_camera_;
  Vec3d start_;         // where Embree's ray starts, in scaled units
  double skipped_ = 0;  // scaled units between the ray's origin and there
  Nearest nearest_;
};

// s of a candidate in double-double; the candidate's own where rounding let the double see a crossing that is not there.
DoubleDouble exact_distance(const World& world, const Ray& ray, const Candidate& candidate);

// Up to which distances along a ray surfaces count as coincident: 2^-50 of the coordinates that are involved.
double coincidence_m(const World& world, const Ray& ray, double s);

// What the scene leaves of a light on its way to a point: lighting_model.md §3, τ.
struct Shadow {
  Bands share{1, 1, 1};    // τ
  int crossings = 0;       // transparent surfaces on the way
  std::uint64_t crossed = 0;  // which objects, for the path signature; 0: none, 1: blocked
};

// One shadow ray at a time; one per thread, reused.
class ShadowRays final : public Crossed {
 public:
  explicit ShadowRays(const World& world) : traversal_(world) {}

  // From the ray's origin to `distance` metres along it, infinity for a directional light. Crossings at either end do not count.
  Shadow shadow(const Ray& ray, double distance);

  bool& undecided() { return traversal_.undecided; }

  void offer(const Candidate& crossing) override;
  double reach() const override { return blocked_ ? -1 : end_; }

 private:
  bool is_between(const Candidate& crossing) const;
  bool seen_before(std::size_t index) const;

  Traversal traversal_;
  const Ray* ray_ = nullptr;
  double end_ = 0;
  bool blocked_ = false;
  std::vector<Candidate> between_;  // transparent ones
};

// Embree calls these back for a primitive whose box the ray meets. User data of a mesh: its MeshTag.
void transport_objects(const RTCIntersectFunctionNArguments* args);
void transport_mesh(const RTCIntersectFunctionNArguments* args);

// The same for packets of shadow rays; single ones ask for every crossing.
void objects_between(const RTCOccludedFunctionNArguments* args);
void mesh_between(const RTCOccludedFunctionNArguments* args);

}  // namespace equilux
