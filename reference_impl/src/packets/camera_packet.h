// The camera rays of a packet, and the nearest crossing of each: search.cpp for 2 W rays at a time. Where a packet is told what its rays
// meet first, nothing is searched for: refined_point of fast/refined.cpp.
#pragma once

#include <limits>

#include "lane_math.h"
#include "packets.h"
#include "queries.h"

namespace equilux::packets {

// One register's share of a packet's camera rays.
template <int W> struct CameraRays {
  Exactly<W> x, y;                    // FilmRay
  Doubles<W> x_rounded, y_rounded;
  Longs<W> active;                    // lanes that stand for a sample
  Longs<W> undecided;                 // must be computed by themselves

  // The nearest crossing so far, as Candidates keeps it. reach: nothing beyond can win. lowest: the nearest that any of the candidates
  // within rounding of it may be. contested: there is more than one.
  Longs<W> object, mesh, triangle, face;
  Doubles<W> s, error, reach, lowest;
  Longs<W> contested;
  double slack;  // Candidates::slack_

  void clear(double coincident) {
    slack = coincident;
    undecided = contested = Longs<W>{};
    object = mesh = all_longs<W>(-1);
    triangle = face = Longs<W>{};
    s = error = Doubles<W>{};
    reach = lowest = all<W>(std::numeric_limits<double>::infinity());
  }

  // Candidates::offer, for the lanes of `found`.
  void offer(Longs<W> found, std::int64_t from_object, std::int64_t from_mesh, Longs<W> from_triangle, Longs<W> at_face, Doubles<W> at,
             Doubles<W> at_error) {
    const Longs<W> counts = found & (at - at_error <= reach);
    const Doubles<W> nearer = smaller<W>(reach, at + at_error + slack);
    const Longs<W> alone = counts & (lowest > nearer);  // what was there before is farther
    contested = (contested | counts) & ~alone;
    lowest = alone ? at - at_error : (counts ? smaller<W>(lowest, at - at_error) : lowest);
    reach = counts ? nearer : reach;
    object = alone ? all_longs<W>(from_object) : object;
    mesh = alone ? all_longs<W>(from_mesh) : mesh;
    triangle = alone ? from_triangle : triangle;
    face = alone ? at_face : face;
    s = alone ? at : s;
    error = alone ? at_error : error;
  }
};

// What the rays of one register are said to meet first, as Primitive has it.
template <int W> struct Expected {
  Longs<W> object, mesh, triangle;
};

// The vertices of W triangles of one mesh, by their places. Lanes that are not asked for get those of the first.
template <int W> struct Corners {
  Longs<W> place[3];

  Corners(const MeshObject& mesh, Longs<W> lanes, Longs<W> triangle) {
    const auto& faces = mesh.given->faces;
    for (int i = 0; i < W; ++i) {
      const auto& at = faces[lanes[i] != 0 ? static_cast<std::size_t>(triangle[i]) : 0];
      for (std::size_t k = 0; k < 3; ++k) place[k][i] = at[k];
    }
  }
};

template <int W> struct CameraPacket : Query {
  explicit CameraPacket(const World& world) : world(world), perspective(world.camera.perspective()) {
    embree::initialise(*this);
    this->Query::object = [](const RTCIntersectFunctionNArguments* args) { of(args).meet_object(args); };
    this->Query::triangle = [](const RTCIntersectFunctionNArguments* args) { of(args).meet_triangle(args); };
  }

  const World& world;
  const bool perspective;
  CameraRays<W> half[2];

  // half[·].x, y and active are given; finds the nearest crossings.
  void find();

  // The same of one half, where it is said what is met. Lanes whose ray does not cross that become undecided.
  void cross(int h, const Expected<W>& expected);

 private:
  static CameraPacket& of(const RTCIntersectFunctionNArguments* args) { return static_cast<CameraPacket&>(query_of<W>(args)); }
  void meet_object(const RTCIntersectFunctionNArguments* args);
  void meet_triangle(const RTCIntersectFunctionNArguments* args);
  void begin(CameraRays<W>& rays) const;
  bool cross_triangle(CameraRays<W>& rays, Longs<W> active, int index, Longs<W> triangle, const Point<W>& a, const Point<W>& b,
                      const Point<W>& c);
  void cross_mesh(CameraRays<W>& rays, Longs<W> active, int index, Longs<W> triangle);
  void cross_object(CameraRays<W>& rays, Longs<W> active, int index);
  void cross_round(CameraRays<W>& rays, Longs<W> active, int index);
  void cross_flat(CameraRays<W>& rays, Longs<W> active, int index);
  Doubles<W> reach_for_embree(const CameraRays<W>& rays) const {
    return smaller<W>(rays.reach * (world.embree_scale * (1 + 0x1p-19)), all<W>(3e38));  // rounding to float takes no more than 2^-24
  }
};

// A ray in a canonical frame and the sizes of its parts, as LocalRay<double> has them.
template <int W> struct LocalRays {
  Point<W> o, d, o_size, d_size;
};

template <int W> inline LocalRays<W> local_rays(const RayFrame<double>& frame, Doubles<W> x, Doubles<W> y, bool perspective) {
  const Point<W> eye = all<W>(frame.eye), right = all<W>(frame.right), up = all<W>(frame.up), forward = all<W>(frame.forward);
  const Point<W> sideways = right * x + up * y;
  const auto sizes = [&](const Point<W>& at) {
    return magnitudes<W>(at) + magnitudes<W>(right) * magnitude<W>(x) + magnitudes<W>(up) * magnitude<W>(y);
  };
  if (perspective) return {eye, sideways + forward, magnitudes<W>(eye), sizes(forward)};
  return {eye + sideways, forward, sizes(eye), magnitudes<W>(forward)};
}

// The two crossings of a canonical sphere (interval.h, clip_by_round). hit: lanes that certainly meet it; uncertain: it is not clear.
template <int W> struct RoundCrossings {
  Longs<W> hit, uncertain;
  Doubles<W> enter, leave, error;
};

template <int W> inline RoundCrossings<W> cross_sphere(const LocalRays<W>& ray) {
  constexpr double unit = rounding<double>;
  const Doubles<W> o_size = square_root(dot(ray.o_size, ray.o_size)), d_size = square_root(dot(ray.d_size, ray.d_size));
  const Doubles<W> dd = dot(ray.d, ray.d), d_length = square_root(dd);
  const Doubles<W> s0 = -(dot(ray.o, ray.d) / dd);
  const Point<W> q = ray.o + ray.d * s0;
  const Doubles<W> rest = 1.0 - dot(q, q), skew = d_size / d_length;
  const Doubles<W> q_error = unit * 2 * (1.0 + o_size * skew), rest_error = q_error * (2.0 + q_error);
  RoundCrossings<W> found;
  found.hit = rest > rest_error;
  found.uncertain = ~found.hit & ~(rest < -rest_error);
  if (!any<W>(found.hit)) return found;
  const Doubles<W> half_chord = square_root(found.hit ? rest / dd : Doubles<W>{});
  const Doubles<W> half = larger<W>(half_chord * d_length, square_root(rest_error));
  found.error = (unit * o_size * skew + rest_error / half) / d_length;
  found.enter = s0 - half_chord;
  found.leave = s0 + half_chord;
  found.uncertain |= found.hit & ~(found.leave - found.enter > found.error + found.error);
  return found;
}

// The crossing of a canonical plane, disc or rectangle (planar.h). hit, uncertain: as above.
template <int W> struct FlatCrossing {
  Longs<W> hit, uncertain;
  Doubles<W> s, error;
};

template <int W> inline FlatCrossing<W> cross_flat_shape(Solid solid, const LocalRays<W>& ray) {
  constexpr double unit = rounding<double>;
  const Doubles<W> d_error = unit * ray.d_size.z, steepness = magnitude<W>(ray.d.z);
  const Longs<W> steep = steepness > d_error;
  FlatCrossing<W> at;
  at.s = -(ray.o.z / ray.d.z);
  const Doubles<W> distance = magnitude<W>(at.s);
  at.error = (unit * ray.o_size.z + distance * d_error) / steepness;
  at.uncertain = ~steep & (ray.d.z != 0.0);
  at.hit = steep;
  if (solid == Solid::plane) return at;
  const Doubles<W> x = ray.o.x + at.s * ray.d.x, y = ray.o.y + at.s * ray.d.y;
  const Doubles<W> error_x = unit * (1.0 + ray.o_size.x + distance * ray.d_size.x) + at.error * magnitude<W>(ray.d.x);
  const Doubles<W> error_y = unit * (1.0 + ray.o_size.y + distance * ray.d_size.y) + at.error * magnitude<W>(ray.d.y);
  Longs<W> outside, inside;
  if (solid == Solid::disc) {
    const Doubles<W> rest = 1.0 - (x * x + y * y);
    const Doubles<W> error = (2.0 * magnitude<W>(x) + error_x) * error_x + (2.0 * magnitude<W>(y) + error_y) * error_y;
    outside = rest < -error;
    inside = rest > error;
  } else {
    outside = (1.0 - x < -error_x) | (1.0 + x < -error_x) | (1.0 - y < -error_y) | (1.0 + y < -error_y);
    inside = (1.0 - x > error_x) & (1.0 + x > error_x) & (1.0 - y > error_y) & (1.0 + y > error_y);
  }
  at.uncertain |= steep & ~outside & ~inside;
  at.hit &= inside;
  return at;
}

template <int W> void CameraPacket<W>::cross_round(CameraRays<W>& rays, Longs<W> active, int index) {
  const Object& object = world.objects[static_cast<std::size_t>(index)];
  const RoundCrossings<W> at = cross_sphere<W>(local_rays<W>(object.rounded, rays.x_rounded, rays.y_rounded, perspective));
  rays.undecided |= active & at.uncertain;
  const Longs<W> hit = active & at.hit & ~at.uncertain;
  if (!any<W>(hit)) return;
  const Longs<W> enters = at.enter > at.error, behind = at.enter < -at.error, leaves = at.leave > at.error,
                 passed = at.leave < -at.error;
  rays.undecided |= hit & ((~enters & ~behind) | (behind & ~leaves & ~passed));
  const Longs<W> from_inside = behind & leaves;
  rays.offer(hit & (enters | from_inside), index, -1, Longs<W>{}, from_inside & 1, enters ? at.enter : at.leave, at.error);
}

template <int W> void CameraPacket<W>::cross_flat(CameraRays<W>& rays, Longs<W> active, int index) {
  const Object& object = world.objects[static_cast<std::size_t>(index)];
  const FlatCrossing<W> at = cross_flat_shape<W>(object.solid, local_rays<W>(object.rounded, rays.x_rounded, rays.y_rounded, perspective));
  rays.undecided |= active & at.uncertain;
  const Longs<W> ahead = at.s > at.error, behind = at.s < -at.error, hit = active & at.hit & ~at.uncertain;
  rays.undecided |= hit & ~ahead & ~behind;
  if (any<W>(hit & ahead)) rays.offer(hit & ahead, index, -1, Longs<W>{}, Longs<W>{}, at.s, at.error);
}

template <int W> void CameraPacket<W>::cross_object(CameraRays<W>& rays, Longs<W> active, int index) {
  switch (world.objects[static_cast<std::size_t>(index)].solid) {
    case Solid::sphere: cross_round(rays, active, index); break;
    case Solid::plane:
    case Solid::disc:
    case Solid::rectangle: cross_flat(rays, active, index); break;
    default: rays.undecided |= active;
  }
}

template <int W> void CameraPacket<W>::meet_object(const RTCIntersectFunctionNArguments* args) {
  float* const tfar = &RTCRayN_tfar(RTCRayHitN_RayN(args->rayhit, args->N), args->N, 0);
  for (int h = 0; h < 2; ++h) {
    const Longs<W> active = mask_from<W>(args->valid + h * W);
    if (!any<W>(active)) continue;
    cross_object(half[h], active, world.bounded[args->primID]);
    store<W>(tfar + h * W, smaller<W>(load<W>(tfar + h * W), reach_for_embree(half[h])));
  }
}

// cross_triangle of shapes/triangle.h, each lane's of its own. False: no lane crosses it.
template <int W>
bool CameraPacket<W>::cross_triangle(CameraRays<W>& rays, Longs<W> active, int index, Longs<W> triangle, const Point<W>& a,
                                     const Point<W>& b, const Point<W>& c) {
  constexpr double unit = rounding<double>;
  const Doubles<W> x = rays.x_rounded, y = rays.y_rounded;
  const auto across = [&](Doubles<W> v, Doubles<W> ray, Doubles<W> z) -> Doubles<W> { return perspective ? v - ray * z : v - ray; };
  const Doubles<W> px = across(a.x, x, a.z), py = across(a.y, y, a.z), qx = across(b.x, x, b.z), qy = across(b.y, y, b.z),
                   rx = across(c.x, x, c.z), ry = across(c.y, y, c.z);
  const Doubles<W> u = qx * ry - qy * rx, v = rx * py - ry * px, w = px * qy - py * qx;
  const Doubles<W> area = u + v + w;
  const Longs<W> missed = ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0));
  const Longs<W> hit = active & ~missed & (area != 0.0);
  if (!any<W>(hit)) return false;
  const Doubles<W> near = smaller<W>(a.z, smaller<W>(b.z, c.z)), far = larger<W>(a.z, larger<W>(b.z, c.z));
  const Doubles<W> inside = (u * a.z + v * b.z + w * c.z) / area;
  const Doubles<W> s = inside < near ? near : (far < inside ? far : inside);
  const auto size_of = [&](const Point<W>& at) {
    const Doubles<W> depth = magnitude<W>(at.z), along = perspective ? depth : all<W>(1);
    return larger<W>(larger<W>(magnitude<W>(at.x) + magnitude<W>(x) * along, magnitude<W>(at.y) + magnitude<W>(y) * along), depth);
  };
  const auto widest = [](Doubles<W> i, Doubles<W> j) { return larger<W>(magnitude<W>(i), magnitude<W>(j)); };
  const Doubles<W> extent = larger<W>(widest(px, py), larger<W>(widest(qx, qy), widest(rx, ry)));
  const Doubles<W> moved = unit * larger<W>(size_of(a), larger<W>(size_of(b), size_of(c)));
  const Doubles<W> error = moved + smaller<W>(far - near, moved * 4.0 * (far - near) * extent / magnitude<W>(area));
  const Longs<W> ahead = s > error;
  rays.undecided |= hit & ~ahead & ~(s < -error);
  rays.offer(hit & ahead, world.meshes[static_cast<std::size_t>(index)].object, index, triangle, Longs<W>{}, s, error);
  return true;
}

template <int W> void CameraPacket<W>::meet_triangle(const RTCIntersectFunctionNArguments* args) {
  const int index = static_cast<const MeshTag*>(args->geometryUserPtr)->mesh;
  const MeshObject& mesh = world.meshes[static_cast<std::size_t>(index)];
  const std::uint32_t* corner = mesh.given->faces[args->primID].data();
  const auto vertex = [&](int k) -> Point<W> {
    const CameraPoint& at = mesh.vertices[corner[k]];
    return {all<W>(at.x), all<W>(at.y), all<W>(at.z)};
  };
  const Point<W> a = vertex(0), b = vertex(1), c = vertex(2);
  float* const tfar = &RTCRayN_tfar(RTCRayHitN_RayN(args->rayhit, args->N), args->N, 0);
  for (int h = 0; h < 2; ++h) {
    const Longs<W> active = mask_from<W>(args->valid + h * W);
    if (!any<W>(active) || !cross_triangle(half[h], active, index, all_longs<W>(args->primID), a, b, c)) continue;
    store<W>(tfar + h * W, smaller<W>(load<W>(tfar + h * W), reach_for_embree(half[h])));
  }
}

template <int W> void CameraPacket<W>::cross_mesh(CameraRays<W>& rays, Longs<W> active, int index, Longs<W> triangle) {
  const MeshObject& mesh = world.meshes[static_cast<std::size_t>(index)];
  const Corners<W> corner(mesh, active, triangle);
  static_assert(sizeof(CameraPoint) == 3 * sizeof(double));
  const auto vertex = [&](int k) { return gathered_point<W>(&mesh.vertices[0].x, corner.place[k] * 3); };
  cross_triangle(rays, active, index, triangle, vertex(0), vertex(1), vertex(2));
}

template <int W> void CameraPacket<W>::cross(int h, const Expected<W>& expected) {
  CameraRays<W>& rays = half[h];
  begin(rays);
  const Longs<W> meets = rays.active & (expected.object >= 0);
  for (Longs<W> rest = meets; any<W>(rest);) {
    const int first = __builtin_ctz(packed<W>(rest));
    const Longs<W> lanes = rest & (expected.object == expected.object[first]);
    const int mesh = static_cast<int>(expected.mesh[first]);
    if (mesh >= 0) {
      cross_mesh(rays, lanes, mesh, expected.triangle);
    } else {
      cross_object(rays, lanes, static_cast<int>(expected.object[first]));
    }
    rest &= ~lanes;
  }
  rays.undecided |= meets & (rays.object < 0);
}

template <int W> void CameraPacket<W>::begin(CameraRays<W>& rays) const {
  rays.clear(0x1p-50 * world.eye_size);
  rays.x_rounded = to_double(rays.x);
  rays.y_rounded = to_double(rays.y);
}

template <int W> void CameraPacket<W>::find() {
  const double scale = world.embree_scale;
  alignas(64) typename EmbreePacket<W>::RayHit query;
  alignas(64) int valid[2 * W];
  for (int h = 0; h < 2; ++h) {
    CameraRays<W>& rays = half[h];
    begin(rays);
    // Embree's own arithmetic must not overflow.
    const double unit = perspective ? 1 : scale;
    rays.undecided |= ~(larger<W>(magnitude<W>(rays.x_rounded), magnitude<W>(rays.y_rounded)) * unit < 0x1p60);
    for (const int plane : world.unbounded) cross_flat(rays, rays.active, plane);
    const int at = h * W;
    const Doubles<W> none{}, x = perspective ? none : rays.x_rounded * scale, y = perspective ? none : rays.y_rounded * scale;
    store<W>(query.ray.org_x + at, x);
    store<W>(query.ray.org_y + at, y);
    store<W>(query.ray.org_z + at, none);
    store<W>(query.ray.dir_x + at, perspective ? rays.x_rounded : none);
    store<W>(query.ray.dir_y + at, perspective ? rays.y_rounded : none);
    store<W>(query.ray.dir_z + at, all<W>(1));
    store<W>(query.ray.tnear + at, none);
    store<W>(query.ray.time + at, none);
    store<W>(query.ray.tfar + at, reach_for_embree(rays));
    store<W>(valid + at, rays.active & ~rays.undecided);
    for (int i = at; i < at + W; ++i) {
      query.ray.mask[i] = 0xffffffffu;
      query.ray.flags[i] = 0;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
  }
  if (world.embree != nullptr) intersect<W>(valid, world.embree, *this, query);
  for (CameraRays<W>& rays : half) rays.undecided |= rays.contested;
}

}  // namespace equilux::packets
