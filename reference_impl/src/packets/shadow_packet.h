// What stands between the points of a packet and one light: transport.cpp for 2 W rays at a time, where nothing lets light through.
#pragma once

#include "surface_packet.h"

namespace equilux::packets {

// One register's share of a packet's shadow rays.
template <int W> struct RaysToLight {
  Longs<W> active, blocked, undecided;
  Longs<W> from_object, from_mesh, from_triangle;  // Departure
  Point<W> origin, direction, origin_in_camera, direction_in_camera;
  Doubles<W> origin_size, start, end;
  // AnywhereTriangleRay
  Longs<W> along;             // the axis along which the ray runs furthest
  int common_axis = -1;       // the same for all lanes, or −1
  Doubles<W> shear_x, shear_y, reciprocal, origin_largest;

  // A crossing that is certainly ahead, of something that blocks.
  void meet(Longs<W> crossed, Doubles<W> s, Doubles<W> error) {
    const Longs<W> before = s + error < end, beyond = s - error > end;
    blocked |= crossed & before;
    undecided |= crossed & ~before & ~beyond;
  }
};

template <int W> struct ShadowPacket : Query {
  explicit ShadowPacket(const World& world)
      : world(world),
        right(to_double_of(world.camera.right)),
        up(to_double_of(world.camera.up)),
        forward(to_double_of(world.camera.forward)) {
    embree::initialise(*this);
    this->Query::object_between = [](const RTCOccludedFunctionNArguments* args) { of(args).meet_object(args); };
    this->Query::triangle_between = [](const RTCOccludedFunctionNArguments* args) { of(args).meet_triangle(args); };
  }

  const World& world;
  RaysToLight<W> half[2];

  // Readies the rays of `active` lanes from points of `from`; toward: exact, unit; distance: metres along it.
  void aim(int h, Longs<W> active, const Surfaces<W>& from, const ExactPoint<W>& toward, Doubles<W> distance);

  // Fills blocked and undecided.
  void trace();

 private:
  static Vec3d to_double_of(const Vec3dd& v) { return {v.x.hi + v.x.lo, v.y.hi + v.y.lo, v.z.hi + v.z.lo}; }
  static ShadowPacket& of(const RTCOccludedFunctionNArguments* args) { return static_cast<ShadowPacket&>(query_of<W>(args)); }
  void meet_object(const RTCOccludedFunctionNArguments* args);
  void meet_triangle(const RTCOccludedFunctionNArguments* args);
  void cross_object(RaysToLight<W>& rays, Longs<W> active, int index);
  void cross_round(RaysToLight<W>& rays, Longs<W> active, Longs<W> own, const LocalRays<W>& ray);
  void cross_flat(RaysToLight<W>& rays, Longs<W> active, Solid solid, const LocalRays<W>& ray);
  void cross_triangle(RaysToLight<W>& rays, Longs<W> active, const CameraPoint& a, const CameraPoint& b, const CameraPoint& c);

  Point<W> in_camera(const Point<W>& v) const { return {dot(all<W>(right), v), dot(all<W>(up), v), dot(all<W>(forward), v)}; }

  // Lanes that nothing more can change leave the packet.
  void end_decided(const RTCOccludedFunctionNArguments* args, int h) {
    float* const tfar = &RTCRayN_tfar(args->ray, args->N, 0) + h * W;
    const Longs<W> done = half[h].blocked | half[h].undecided;
    if (any<W>(done)) store<W>(tfar, done ? all<W>(-std::numeric_limits<double>::infinity()) : load<W>(tfar));
  }

  const Vec3d right, up, forward;
};

template <int W>
void ShadowPacket<W>::aim(int h, Longs<W> active, const Surfaces<W>& from, const ExactPoint<W>& toward, Doubles<W> distance) {
  RaysToLight<W>& rays = half[h];
  rays.blocked = rays.undecided = Longs<W>{};
  rays.active = active;
  if (!any<W>(active)) return;
  rays.from_object = from.object;
  rays.from_mesh = from.mesh;
  rays.from_triangle = from.triangle;
  rays.origin = rounded<W>(from.position);
  rays.direction = rounded<W>(toward);
  rays.origin_size = from.position_size;
  const auto length = [](const Point<W>& v) -> Doubles<W> { return square_root(dot(v, v)); };
  const auto coincidence = [&](Doubles<W> s) -> Doubles<W> { return 0x1p-50 * (world.eye_size + length(rays.origin) + s); };
  const Doubles<W> across = magnitude<W>(dot(rays.direction, from.geometric)) / length(from.geometric);
  rays.start = coincidence(Doubles<W>{}) / larger<W>(across, all<W>(0x1p-20));
  rays.end = distance - coincidence(distance < std::numeric_limits<double>::infinity() ? distance : Doubles<W>{});
  rays.origin_in_camera = in_camera(rays.origin);
  rays.direction_in_camera = in_camera(rays.direction);

  const Point<W>& d = rays.direction_in_camera;
  const Point<W> size = magnitudes<W>(d);
  rays.along = size.x > size.y ? Longs<W>{} : all_longs<W>(1);
  rays.along = size.z >= (size.x > size.y ? size.x : size.y) ? all_longs<W>(2) : rays.along;
  const Longs<W> is_x = rays.along == 0, is_y = rays.along == 1;
  rays.reciprocal = 1.0 / (is_x ? d.x : (is_y ? d.y : d.z));
  rays.shear_x = (is_x ? d.y : (is_y ? d.z : d.x)) * rays.reciprocal;
  rays.shear_y = (is_x ? d.z : (is_y ? d.x : d.y)) * rays.reciprocal;
  rays.origin_largest = largest<W>(rays.origin_in_camera);
  const std::int64_t first = rays.along[__builtin_ctz(packed<W>(active))];
  rays.common_axis = any<W>(active & (rays.along != first)) ? -1 : static_cast<int>(first);
}

template <int W> void ShadowPacket<W>::trace() {
  alignas(64) typename EmbreePacket<W>::Ray query;
  alignas(64) int valid[2 * W];
  const TransportBoxes& boxes = world.transport;
  bool sent = false;
  for (int h = 0; h < 2; ++h) {
    RaysToLight<W>& rays = half[h];
    if (any<W>(rays.active)) {
      for (const int plane : world.unbounded) cross_object(rays, rays.active, plane);
    }
    Longs<W> goes = rays.active & ~rays.blocked & ~rays.undecided & (rays.end > 0.0);
    const int at = h * W;
    if (any<W>(goes) && boxes.embree != nullptr) {
      const Point<W> start = (rays.origin_in_camera - all<W>(boxes.centre)) * all<W>(boxes.scale);
      const auto length = [](const Point<W>& v) -> Doubles<W> { return square_root(dot(v, v)); };
      const Longs<W> near = (length(start) <= 3.0) & (length(rays.origin_in_camera) * boxes.scale <= 0x1p20);
      rays.undecided |= goes & ~near;
      goes &= near;
      store<W>(query.org_x + at, start.x);
      store<W>(query.org_y + at, start.y);
      store<W>(query.org_z + at, start.z);
      store<W>(query.dir_x + at, rays.direction_in_camera.x);
      store<W>(query.dir_y + at, rays.direction_in_camera.y);
      store<W>(query.dir_z + at, rays.direction_in_camera.z);
      store<W>(query.tnear + at, Doubles<W>{});
      store<W>(query.time + at, Doubles<W>{});
      const Doubles<W> reach = rays.end * boxes.scale * (1 + 0x1p-19) + 0x1p-13;  // Traversal::reach_for_embree, rounding to float included
      store<W>(query.tfar + at, smaller<W>(reach, all<W>(3e38)));
      for (int i = at; i < at + W; ++i) {
        query.mask[i] = 0xffffffffu;
        query.flags[i] = 0;
      }
      sent |= any<W>(goes);
    } else {
      goes = Longs<W>{};
    }
    store<W>(valid + at, goes);
  }
  if (sent) occluded<W>(valid, boxes.embree, *this, query);
}

template <int W> void ShadowPacket<W>::cross_round(RaysToLight<W>& rays, Longs<W> active, Longs<W> own, const LocalRays<W>& ray) {
  const RoundCrossings<W> at = cross_sphere<W>(ray);
  rays.undecided |= active & at.uncertain;
  const Longs<W> hit = active & at.hit & ~at.uncertain;
  if (!any<W>(hit)) return;
  // The object that the ray leaves is crossed once at s = 0, to rounding; all others are crossed beyond `start`.
  const Doubles<W> from = own ? Doubles<W>{} : rays.start;
  const Longs<W> enters = at.enter - from > at.error, before = at.enter - from < -at.error, leaves = at.leave - from > at.error,
                 passed = at.leave - from < -at.error;
  const Longs<W> enters_here = ~enters & ~before, leaves_here = ~leaves & ~passed;
  rays.undecided |= hit & (own ? ~(enters_here ^ leaves_here) : (enters_here | leaves_here));
  rays.meet(hit & enters, at.enter, at.error);
  rays.meet(hit & leaves, at.leave, at.error);
}

template <int W> void ShadowPacket<W>::cross_flat(RaysToLight<W>& rays, Longs<W> active, Solid solid, const LocalRays<W>& ray) {
  const FlatCrossing<W> at = cross_flat_shape<W>(solid, ray);
  rays.undecided |= active & at.uncertain;
  const Longs<W> hit = active & at.hit & ~at.uncertain;
  const Doubles<W> beyond = at.s - rays.start;
  rays.undecided |= hit & ~(magnitude<W>(beyond) > at.error);
  rays.meet(hit & (beyond > at.error), at.s, at.error);
}

template <int W> void ShadowPacket<W>::cross_object(RaysToLight<W>& rays, Longs<W> active, int index) {
  const Object& object = world.objects[static_cast<std::size_t>(index)];
  const Longs<W> own = rays.from_object == index;
  const CanonicalFrame& frame = object.canonical;
  const auto turned = [&](const Point<W>& v) {
    const Vec3d* column = frame.linear_rounded.column;
    return all<W>(column[0]) * v.x + all<W>(column[1]) * v.y + all<W>(column[2]) * v.z;
  };
  const Point<W> row_size = all<W>(frame.row_size);
  const LocalRays<W> ray{turned(rays.origin) + all<W>(frame.eye_rounded), turned(rays.direction),
                         row_size * rays.origin_size + magnitudes<W>(all<W>(frame.eye_rounded)), row_size};
  switch (object.solid) {
    case Solid::sphere: cross_round(rays, active, own, ray); break;
    case Solid::plane:
    case Solid::disc:
    case Solid::rectangle: cross_flat(rays, active & ~own, object.solid, ray); break;
    default: rays.undecided |= active;
  }
}

template <int W> void ShadowPacket<W>::meet_object(const RTCOccludedFunctionNArguments* args) {
  for (int h = 0; h < 2; ++h) {
    const Longs<W> active = mask_from<W>(args->valid + h * W);
    if (!any<W>(active)) continue;
    cross_object(half[h], active, world.bounded[args->primID]);
    end_decided(args, h);
  }
}

template <int W> void ShadowPacket<W>::meet_triangle(const RTCOccludedFunctionNArguments* args) {
  const int index = static_cast<const MeshTag*>(args->geometryUserPtr)->mesh;
  const MeshObject& mesh = world.meshes[static_cast<std::size_t>(index)];
  const std::uint32_t* corner = mesh.given->faces[args->primID].data();
  for (int h = 0; h < 2; ++h) {
    RaysToLight<W>& rays = half[h];
    const Longs<W> own = (rays.from_mesh == index) & (rays.from_triangle == static_cast<std::int64_t>(args->primID));
    const Longs<W> active = mask_from<W>(args->valid + h * W) & ~own;
    if (!any<W>(active)) continue;
    cross_triangle(rays, active, mesh.vertices[corner[0]], mesh.vertices[corner[1]], mesh.vertices[corner[2]]);
    end_decided(args, h);
  }
}

// cross_triangle of shapes/triangle.h, and Traversal::try_triangle.
template <int W>
void ShadowPacket<W>::cross_triangle(RaysToLight<W>& rays, Longs<W> active, const CameraPoint& a, const CameraPoint& b,
                                     const CameraPoint& c) {
  constexpr double unit = rounding<double>;
  const Point<W>& o = rays.origin_in_camera;
  const Longs<W> is_x = rays.along == 0, is_y = rays.along == 1;
  const auto project = [&](const CameraPoint& v) -> Point<W> {
    const Point<W> p{v.x - o.x, v.y - o.y, v.z - o.z};
    Point<W> turned;
    switch (rays.common_axis) {
      case 0: turned = {p.y, p.z, p.x}; break;
      case 1: turned = {p.z, p.x, p.y}; break;
      case 2: turned = p; break;
      default: turned = chosen<W>(is_x, {p.y, p.z, p.x}, chosen<W>(is_y, {p.z, p.x, p.y}, p));
    }
    return {turned.x - rays.shear_x * turned.z, turned.y - rays.shear_y * turned.z, turned.z * rays.reciprocal};
  };
  const Point<W> p = project(a), q = project(b), r = project(c);
  const Doubles<W> u = q.x * r.y - q.y * r.x, v = r.x * p.y - r.y * p.x, w = p.x * q.y - p.y * q.x;
  const Doubles<W> area = u + v + w;
  const Longs<W> missed = ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0));
  const Longs<W> hit = active & ~missed & (area != 0.0);
  if (!any<W>(hit)) return;
  const Doubles<W> near = smaller<W>(p.z, smaller<W>(q.z, r.z)), far = larger<W>(p.z, larger<W>(q.z, r.z));
  const Doubles<W> inside = (u * p.z + v * q.z + w * r.z) / area;
  const Doubles<W> s = inside < near ? near : (far < inside ? far : inside);
  const auto widest = [](const Point<W>& at) { return larger<W>(magnitude<W>(at.x), magnitude<W>(at.y)); };
  const Doubles<W> extent = larger<W>(widest(p), larger<W>(widest(q), widest(r)));
  const auto most = [](const CameraPoint& at) {
    const double x = std::fabs(at.x), y = std::fabs(at.y), z = std::fabs(at.z), xy = x > y ? x : y;
    return xy > z ? xy : z;
  };
  const double ab = most(a) > most(b) ? most(a) : most(b), corners = ab > most(c) ? ab : most(c);
  const Doubles<W> moved = unit * (4.0 * larger<W>(all<W>(corners), rays.origin_largest));
  const Doubles<W> error = moved + smaller<W>(far - near, moved * 4.0 * (far - near) * extent / magnitude<W>(area));
  const Longs<W> clear = s - error >= 4.0 * rays.start, before = s + error < 0.5 * rays.start;
  rays.undecided |= hit & ~clear & ~before;
  rays.meet(hit & clear, s, error);
}

}  // namespace equilux::packets
