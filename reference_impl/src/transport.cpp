#include "transport.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "packets/packets.h"
#include "shapes/dispatch.h"

namespace equilux {
namespace {

struct TransportContext : embree::QueryContextBase {
  Traversal* traversal = nullptr;
};

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_flat(Solid solid) { return solid == Solid::plane || solid == Solid::disc || solid == Solid::rectangle; }

// Which crossings lie ahead. False: rounding leaves it open. The object that the ray leaves is crossed once at s = 0, to rounding; its
// other crossing counts, however near, but within `start` that is open to question.
template <class R> bool decide_ahead(const Crossings<R>& all, bool own, double start, bool* ahead, bool& undecided) {
  bool certain = !all.uncertain;
  int at_origin = 0;
  for (int i = 0; i < all.count; ++i) {
    const Sign sign = sign_within(all.at[i].s - R(own ? 0.0 : start), all.at[i].error);
    ahead[i] = sign == Sign::positive;
    const double s = to_double(all.at[i].s), error = all.at[i].error;
    undecided |= s < 4 * start + error && (own ? ahead[i] : s > 0.5 * start - error);
    if (sign == Sign::zero) {
      ++at_origin;
      certain &= own;
    }
  }
  return certain && (!own || at_origin == 1);
}

}  // namespace

Ray leaving(const World& world, const SurfacePoint& point, const Vec3dd& direction) {
  Ray ray;
  ray.origin = point.position;
  ray.direction = direction;
  ray.origin_size = point.position_size;
  ray.origin_rounded = to_double(ray.origin);
  ray.direction_rounded = to_double(ray.direction);
  const double across = std::fabs(dot(ray.direction_rounded, point.geometric)) / length(point.geometric);
  const double start = coincidence_m(world, ray, 0) / std::fmax(across, 0x1p-20);
  ray.from = {point.object, point.mesh, point.triangle, start};
  return ray;
}

double coincidence_m(const World& world, const Ray& ray, double s) {
  return 0x1p-50 * (world.eye_size + length(ray.origin_rounded) + s);
}

// --- Embree -----------------------------------------------------------------------------------------------------------

void Traversal::follow(const Ray& ray, Crossed& crossed) {
  ray_ = &ray;
  crossed_ = &crossed;
  for (const int plane : world_.unbounded) try_object(plane);
  if (world_.transport.embree != nullptr && crossed.reach() > 0) send_through_embree();
}

// The boxes fill [-1, 1]³. A ray that starts beyond 3 is brought to 2 before its middle, because rounding to float would move it by more
// than the boxes' padding. Up to 2^20 from the middle and from the eye a double has the digits for that.
bool Traversal::place_embree_ray() {
  const TransportBoxes& boxes = world_.transport;
  const Camera& camera = world_.camera;
  const Vec3d right = to_double(camera.right), up = to_double(camera.up), forward = to_double(camera.forward);
  const auto in_camera = [&](const Vec3d& v) { return Vec3d{dot(right, v), dot(up, v), dot(forward, v)}; };
  origin_in_camera_ = in_camera(ray_->origin_rounded);
  direction_in_camera_ = in_camera(ray_->direction_rounded);
  start_ = (origin_in_camera_ - boxes.centre) * boxes.scale;
  skipped_ = 0;
  if (std::fmax(length(start_), length(origin_in_camera_) * boxes.scale) > 0x1p20) return place_far_embree_ray();
  if (length(start_) <= 3) return true;
  const double to_middle = -dot(start_, direction_in_camera_);
  if (!(to_middle > 2)) return false;
  start_ = start_ + direction_in_camera_ * (to_middle - 2);
  skipped_ = to_middle - 2;
  return length(start_ + direction_in_camera_ * 2.0) <= 2 + boxes.padding;
}

bool Traversal::place_far_embree_ray() {
  const TransportBoxes& boxes = world_.transport;
  const Camera& camera = world_.camera;
  const auto in_camera = [&](const Vec3dd& v) { return Vec3dd{dot(camera.right, v), dot(camera.up, v), dot(camera.forward, v)}; };
  const Vec3dd direction = in_camera(ray_->direction);
  Vec3dd start = (in_camera(ray_->origin) - exactly(boxes.centre)) * DoubleDouble(boxes.scale);
  start_ = to_double(start);
  if (length(start_) <= 3) return true;
  const DoubleDouble to_middle = -dot(start, direction);
  if (!(to_middle.hi > 2)) return false;
  start = start + direction * (to_middle - DoubleDouble(2.0));
  start_ = to_double(start);
  skipped_ = to_double(to_middle) - 2;
  return length(to_double(start + direction * DoubleDouble(2.0))) <= 2 + boxes.padding;
}

void Traversal::send_through_embree() {
  if (!place_embree_ray()) return;
  if (!world_.meshes.empty()) triangle_ray_ = AnywhereTriangleRay(origin_in_camera_, direction_in_camera_);
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(start_.x);
  query.ray.org_y = static_cast<float>(start_.y);
  query.ray.org_z = static_cast<float>(start_.z);
  query.ray.dir_x = static_cast<float>(direction_in_camera_.x);
  query.ray.dir_y = static_cast<float>(direction_in_camera_.y);
  query.ray.dir_z = static_cast<float>(direction_in_camera_.z);
  if (!std::isfinite(length(start_) + length(direction_in_camera_))) {
    throw TracerError("a ray has left the range of numbers: sizes, distances or indices of refraction are too far apart");
  }
  query.ray.tfar = reach_for_embree();
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  TransportContext context;
  embree::initialise(context);
  context.traversal = this;
  embree::intersect(world_.transport.embree, context, query);
}

// Must not fall short of any crossing within reach. Distances to boxes carry a relative error of a few 2^-23, and `skipped` one of 2^-52.
float Traversal::reach_for_embree() const {
  const double reach = crossed_->reach();
  if (reach < 0) return -1;
  const double scaled = reach * world_.transport.scale;
  const double ahead = (scaled - skipped_) * (1 + 0x1p-20) + 0x1p-48 * scaled + 0x1p-14;
  return std::nextafter(static_cast<float>(std::min(ahead, 3e38)), std::numeric_limits<float>::infinity());
}

namespace {

Traversal& traversal_of(const RTCIntersectFunctionNArguments* args) {
  return *static_cast<TransportContext*>(args->context)->traversal;
}

void shorten(const RTCIntersectFunctionNArguments* args, const Traversal& traversal) {
  RTCRayHit* query = reinterpret_cast<RTCRayHit*>(args->rayhit);
  query->ray.tfar = std::min(query->ray.tfar, traversal.reach_for_embree());
}

}  // namespace

void transport_objects(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  Traversal& traversal = traversal_of(args);
  traversal.try_object(traversal.world().bounded[args->primID]);
  shorten(args, traversal);
}

void transport_mesh(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  Traversal& traversal = traversal_of(args);
  traversal.try_triangle(static_cast<const MeshTag*>(args->geometryUserPtr)->mesh, args->primID);
  shorten(args, traversal);
}

void objects_between(const RTCOccludedFunctionNArguments* args) { packets::query_of<1>(args).object_between(args); }

void mesh_between(const RTCOccludedFunctionNArguments* args) { packets::query_of<1>(args).triangle_between(args); }

// --- crossings --------------------------------------------------------------------------------------------------------

void Traversal::try_object(int index) {
  const Object& object = world_.objects[static_cast<std::size_t>(index)];
  const bool left = index == ray_->from.object, own = left && !ray_->from.displaced;
  if (left && is_flat(object.solid)) return;
  bool ahead[2];
  const Crossings<double> all = crossings(object.solid, object.canonical.rounded(*ray_));
  bool close = false;
  if (decide_ahead(all, own, ray_->from.start, ahead, close) && !close) {
    for (int i = 0; i < all.count; ++i) {
      if (ahead[i]) crossed_->offer({index, -1, 0, all.at[i].face, all.at[i].s, all.at[i].error});
    }
    return;
  }
  const Crossings<DoubleDouble> exactly_all = crossings(object.solid, object.canonical.exact(*ray_));
  decide_ahead(exactly_all, own, ray_->from.start, ahead, undecided);
  for (int i = 0; i < exactly_all.count; ++i) {
    const double s = to_double(exactly_all.at[i].s);
    if (ahead[i]) crossed_->offer({index, -1, 0, exactly_all.at[i].face, s, s * 0x1p-48});
  }
}

void Traversal::try_triangle(int index, std::uint32_t triangle) {
  if (index == ray_->from.mesh && triangle == ray_->from.triangle) return;
  const MeshObject& mesh = world_.meshes[static_cast<std::size_t>(index)];
  const auto& corner = mesh.given->faces[triangle];
  Crossing<double> crossing;
  if (!cross_triangle(triangle_ray_, mesh.vertices[corner[0]], mesh.vertices[corner[1]], mesh.vertices[corner[2]], crossing)) return;
  Candidate candidate{mesh.object, index, triangle, crossing.face, crossing.s, crossing.error};
  const double start = ray_->from.start;
  if (crossing.s + crossing.error < 0.5 * start) return;
  if (crossing.s - crossing.error < 4 * start) {
    candidate.s = to_double(exact_distance(world_, *ray_, candidate));
    undecided |= is_undecided(candidate.s, start);
    if (!(candidate.s > start)) return;
  }
  crossed_->offer(candidate);
}

DoubleDouble exact_distance(const World& world, const Ray& ray, const Candidate& candidate) {
  if (candidate.mesh >= 0) {
    const ExactTriangle triangle = world.meshes[static_cast<std::size_t>(candidate.mesh)].triangle(candidate.triangle);
    const DoubleDouble s = triangle.crossing(ray.origin, ray.direction);
    // Met edge-on to rounding, the exact plane may be crossed far outside the triangle.
    return std::fabs(to_double(s) - candidate.s) <= 16 * candidate.error ? s : DoubleDouble(candidate.s);
  }
  const Object& object = world.objects[static_cast<std::size_t>(candidate.object)];
  const Crossings<DoubleDouble> all = crossings(object.solid, object.canonical.exact(ray));
  for (int i = 0; i < all.count; ++i) {
    if (all.at[i].face == candidate.face) return all.at[i].s;
  }
  return candidate.s;
}

// --- the first surface ------------------------------------------------------------------------------------------------

bool Traversal::nearest(const Ray& ray, Candidate& winner) {
  nearest_.candidates.clear(coincidence_m(world_, ray, 0));
  follow(ray, nearest_);
  const std::vector<Candidate>& found = nearest_.candidates.found();
  if (found.empty()) return false;
  winner = found.front();
  if (found.size() == 1) return true;

  DoubleDouble first = exact_distance(world_, ray, winner);
  for (const Candidate& candidate : found) first = std::min(first, exact_distance(world_, ray, candidate));
  const double tie = coincidence_m(world_, ray, to_double(first));
  bool chosen = false;
  for (const Candidate& candidate : found) {
    const double behind = to_double(exact_distance(world_, ray, candidate) - first);
    undecided |= is_undecided(behind, tie);
    if (behind > tie) continue;
    const bool earlier = std::pair(candidate.object, candidate.triangle) < std::pair(winner.object, winner.triangle);
    if (!chosen || earlier) winner = candidate;
    chosen = true;
  }
  return true;
}

// --- shadows ----------------------------------------------------------------------------------------------------------

bool ShadowRays::is_between(const Candidate& crossing) const {
  if (crossing.s + crossing.error < end_) return true;
  if (crossing.s - crossing.error > end_) return false;
  return to_double(exact_distance(traversal_.world(), *ray_, crossing)) < end_;
}

void ShadowRays::offer(const Candidate& crossing) {
  const World& world = traversal_.world();
  const Casts& casts = world.casts[static_cast<std::size_t>(crossing.object)];
  if (blocked_ || casts.skipped) return;
  if (!is_between(crossing)) return;
  if (casts.blocks) {
    blocked_ = true;
  } else {
    between_.push_back(crossing);
  }
}

// Through an edge of a mesh, two triangles that face the same way are crossed where there is one surface.
bool ShadowRays::seen_before(std::size_t index) const {
  const Candidate& crossing = between_[index];
  if (crossing.mesh < 0 || !(crossing.face & triangle_on_border)) return false;
  return std::any_of(between_.begin(), between_.begin() + static_cast<std::ptrdiff_t>(index), [&](const Candidate& other) {
    return other.mesh == crossing.mesh && other.face == crossing.face && std::fabs(other.s - crossing.s) <= other.error + crossing.error;
  });
}

Shadow ShadowRays::shadow(const Ray& ray, double distance) {
  ray_ = &ray;
  end_ = distance < infinity ? distance - coincidence_m(traversal_.world(), ray, distance) : infinity;
  blocked_ = false;
  between_.clear();
  if (end_ > 0) traversal_.follow(ray, *this);

  Shadow result;
  if (blocked_) {
    result.share = {};
    result.crossed = 1;
    return result;
  }
  const auto in_file_order = [](const Candidate& a, const Candidate& b) {
    return std::tuple(a.object, a.s, a.triangle) < std::tuple(b.object, b.s, b.triangle);
  };
  std::sort(between_.begin(), between_.end(), in_file_order);
  const bool once = traversal_.world().description.rules.transparent_shadow == TransparentShadow::once;
  for (std::size_t i = 0; i < between_.size(); ++i) {
    if (seen_before(i)) continue;
    if (once && i > 0 && between_[i - 1].object == between_[i].object) continue;
    result.share = result.share * traversal_.world().casts[static_cast<std::size_t>(between_[i].object)].share;
    result.crossings += 1;
    result.crossed = (result.crossed + static_cast<std::uint64_t>(between_[i].object) + 2) * 0x9e3779b97f4a7c15u;
  }
  return result;
}

}  // namespace equilux
