#include "search.h"

#include <algorithm>
#include <utility>

#include "packets/packets.h"
#include "shapes/dispatch.h"

namespace equilux {
namespace {

struct QueryContext : embree::QueryContextBase {
  Search* search = nullptr;
};

// A crossing at the eye itself does not count (t > 0). In double-double, what lies within the error is at the eye.
template <class R> bool first_ahead(Crossings<R>& all, Crossing<R>& first) {
  for (int i = 0; i < all.count; ++i) {
    const Sign sign = sign_within(all.at[i].s, all.at[i].error);
    all.uncertain |= sign == Sign::zero;
    if (sign == Sign::positive) {
      first = all.at[i];
      return true;
    }
  }
  return false;
}

template <class R> Crossings<R> cross_object(const Object& object, const RayFrame<R>& frame, R x, R y, bool perspective) {
  return crossings(object.solid, local_ray(frame, x, y, perspective));
}

// Embree's tfar, in float, must not fall short of any crossing that could still win, nor of a tie. Its traversal of user geometry is
// not the robust one: distances to boxes carry a relative error of a few 2^-23, covered by 2^-20.
float reach_for_embree(const Search& search) {
  const double scaled = search.candidates.reach() * search.world->embree_scale * (1 + 0x1p-20);
  return std::nextafter(static_cast<float>(std::min(scaled, 3e38)), std::numeric_limits<float>::infinity());
}

void trace(Search& search) {
  const World& world = *search.world;
  const double x = search.film_ray.x_rounded, y = search.film_ray.y_rounded, scale = world.embree_scale;
  const bool perspective = world.camera.perspective();
  RTCRayHit query{};
  query.ray.org_x = perspective ? 0 : static_cast<float>(x * scale);
  query.ray.org_y = perspective ? 0 : static_cast<float>(y * scale);
  query.ray.dir_x = perspective ? static_cast<float>(x) : 0;
  query.ray.dir_y = perspective ? static_cast<float>(y) : 0;
  query.ray.dir_z = 1;
  // Embree's own arithmetic must not overflow; what a ray so steep meets is looked for without it.
  if (!(std::fmax(std::fabs(x), std::fabs(y)) * (perspective ? 1 : scale) < 0x1p60)) {
    for (const int object : world.bounded) try_object(search, object);
    for (std::size_t mesh = 0; mesh < world.meshes.size(); ++mesh) {
      const std::size_t triangles = world.meshes[mesh].given->faces.size();
      for (std::size_t i = 0; i < triangles; ++i) try_triangle(search, static_cast<int>(mesh), static_cast<std::uint32_t>(i));
    }
    return;
  }
  query.ray.tfar = reach_for_embree(search);
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  QueryContext context;
  embree::initialise(context);
  context.search = &search;
  embree::intersect(world.embree, context, query);
}

Search* search_of(const RTCIntersectFunctionNArguments* args) { return static_cast<QueryContext*>(args->context)->search; }

void shorten(const RTCIntersectFunctionNArguments* args, const Search& search) {
  RTCRayHit* query = reinterpret_cast<RTCRayHit*>(args->rayhit);
  query->ray.tfar = std::min(query->ray.tfar, reach_for_embree(search));
}

}  // namespace

// --- Embree's callbacks -----------------------------------------------------------------------------------------------

void intersect_objects(const RTCIntersectFunctionNArguments* args) {
  if (args->N > 1) return packets::query_of<1>(args).object(args);
  if (!args->valid[0]) return;
  Search& search = *search_of(args);
  try_object(search, search.world->bounded[args->primID]);
  shorten(args, search);
}

void intersect_mesh(const RTCIntersectFunctionNArguments* args) {
  if (args->N > 1) return packets::query_of<1>(args).triangle(args);
  if (!args->valid[0]) return;
  Search& search = *search_of(args);
  try_triangle(search, static_cast<const MeshTag*>(args->geometryUserPtr)->mesh, args->primID);
  shorten(args, search);
}

// --- candidates -------------------------------------------------------------------------------------------------------

void Candidates::offer(const Candidate& candidate) {
  if (candidate.s - candidate.error > reach_) return;
  reach_ = std::min(reach_, candidate.s + candidate.error + slack_);
  std::erase_if(found_, [this](const Candidate& other) { return other.s - other.error > reach_; });
  found_.push_back(candidate);
}

void try_object(Search& search, int index) {
  const World& world = *search.world;
  const Object& object = world.objects[static_cast<std::size_t>(index)];
  const bool perspective = world.camera.perspective();
  const FilmRay& ray = search.film_ray;

  Crossings<double> all = cross_object(object, object.rounded, ray.x_rounded, ray.y_rounded, perspective);
  Crossing<double> first;
  const bool found = first_ahead(all, first);
  if (!all.uncertain) {
    if (found) search.candidates.offer({index, -1, 0, first.face, first.s, first.error});
    return;
  }
  Crossings<DoubleDouble> exactly_all = cross_object(object, object.exact, ray.x, ray.y, perspective);
  Crossing<DoubleDouble> exact_first;
  if (first_ahead(exactly_all, exact_first)) {
    const double s = to_double(exact_first.s);
    search.candidates.offer({index, -1, 0, exact_first.face, s, s * 0x1p-48});
  }
}

void try_triangle(Search& search, int index, std::uint32_t triangle) {
  const MeshObject& mesh = search.world->meshes[static_cast<std::size_t>(index)];
  const auto& corner = mesh.given->faces[triangle];
  Crossing<double> crossing;
  if (!cross_triangle(search.triangle_ray, mesh.vertices[corner[0]], mesh.vertices[corner[1]], mesh.vertices[corner[2]], crossing)) {
    return;
  }
  Candidate candidate{mesh.object, index, triangle, 0, crossing.s, crossing.error};
  const Sign sign = sign_within(crossing.s, crossing.error);
  if (sign == Sign::negative) return;
  if (sign == Sign::zero) {  // at the eye, or just before or behind it
    const Camera& camera = search.world->camera;
    const ExactTriangle exact = mesh.triangle(triangle);
    const double steepness = std::fabs(to_double(dot(exact.normal, camera.direction(search.film_ray)))) / length(to_double(exact.normal));
    const double from_eye = length(to_double(exact.a - camera.origin(search.film_ray)));
    const DoubleDouble s = exact_depth(*search.world, search.film_ray, candidate);
    if (sign_within(s, rounding<DoubleDouble> * from_eye / steepness) != Sign::positive) return;
    candidate.s = to_double(s);
  }
  search.candidates.offer(candidate);
}

void find_candidates(Search& search) {
  const World& world = *search.world;
  search.candidates.clear(0x1p-50 * world.eye_size);
  search.triangle_ray = {search.film_ray.x_rounded, search.film_ray.y_rounded, world.camera.perspective()};
  for (const int plane : world.unbounded) try_object(search, plane);
  if (world.embree != nullptr) trace(search);
}

// --- the winner -------------------------------------------------------------------------------------------------------

DoubleDouble exact_depth(const World& world, const FilmRay& ray, const Candidate& candidate) {
  const Camera& camera = world.camera;
  if (candidate.mesh >= 0) {
    const ExactTriangle triangle = world.meshes[static_cast<std::size_t>(candidate.mesh)].triangle(candidate.triangle);
    const DoubleDouble s = triangle.crossing(camera.origin(ray), camera.direction(ray));
    // Seen edge-on to rounding, the exact plane may be crossed far outside the triangle.
    return std::fabs(to_double(s) - candidate.s) <= 16 * candidate.error ? s : DoubleDouble(candidate.s);
  }
  const Object& object = world.objects[static_cast<std::size_t>(candidate.object)];
  const Crossings<DoubleDouble> all = cross_object(object, object.exact, ray.x, ray.y, camera.perspective());
  for (int i = 0; i < all.count; ++i) {
    if (all.at[i].face == candidate.face) return all.at[i].s;
  }
  return candidate.s;
}

bool nearest_crossing(Search& search, Candidate& winner) {
  find_candidates(search);
  search.undecided = false;
  const std::vector<Candidate>& found = search.candidates.found();
  if (found.empty()) return false;
  winner = found.front();
  if (found.size() == 1) return true;

  // Several within rounding: decide in double-double. Surfaces count as coincident when they differ by no more than the rounding of the
  // coordinates that the spec itself gives them: 2^-50 of the distances from the world's origin that are involved.
  const World& world = *search.world;
  const auto depth = [&](const Candidate& candidate) { return exact_depth(world, search.film_ray, candidate); };
  DoubleDouble nearest = depth(winner);
  for (const Candidate& candidate : found) nearest = std::min(nearest, depth(candidate));
  const double spread = length(to_double(world.camera.direction(search.film_ray)));
  const double tie = 0x1p-50 * (world.eye_size / spread + to_double(nearest));
  bool chosen = false;
  for (const Candidate& candidate : found) {
    const double behind = to_double(depth(candidate) - nearest);
    search.undecided |= is_undecided(behind, tie);
    if (behind > tie) continue;
    const bool earlier = std::pair(candidate.object, candidate.triangle) < std::pair(winner.object, winner.triangle);
    if (!chosen || earlier) winner = candidate;
    chosen = true;
  }
  return true;
}

}  // namespace equilux
