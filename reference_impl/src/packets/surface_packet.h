// The shaded points of W lanes: surface.cpp in the same operations.
#pragma once

#include "camera_packet.h"

namespace equilux::packets {

template <int W> struct Surfaces {
  Longs<W> hit;            // lanes with a surface
  Longs<W> object, mesh, triangle;
  Doubles<W> distance, position_size;
  ExactPoint<W> position, normal, to_viewer;
  Point<W> geometric;
};

template <int W> class SurfaceFinder {
 public:
  SurfaceFinder(const World& world, CameraRays<W>& rays) : world_(world), camera_(world.camera), rays_(rays) {}

  // Lanes that turn out to be less plain than they looked join rays.undecided.
  [[gnu::flatten]] Surfaces<W> find() {
    Surfaces<W> found;
    found.hit = rays_.active & ~rays_.undecided & (rays_.object >= 0);
    found.object = rays_.object;
    found.mesh = rays_.mesh;
    found.triangle = rays_.triangle;
    if (!any<W>(found.hit)) return found;
    const ExactPoint<W> right = all<W>(camera_.right), up = all<W>(camera_.up), forward = all<W>(camera_.forward);
    const ExactPoint<W> sideways = right * rays_.x + up * rays_.y;
    direction_ = camera_.perspective() ? sideways + forward : forward;
    if (!camera_.perspective()) origin_ = sideways;

    for (Longs<W> rest = found.hit & (rays_.mesh >= 0); any<W>(rest);) {
      const int mesh = static_cast<int>(rays_.mesh[__builtin_ctz(packed<W>(rest))]);
      const Longs<W> lanes = rest & (rays_.mesh == mesh);
      on_mesh(mesh, lanes, found);
      rest &= ~lanes;
    }
    const Longs<W> on_object = found.hit & (rays_.mesh < 0);
    if (any<W>(on_object)) on_objects(on_object, found);

    const Exactly<W> d_length = length_of<W>(direction_);
    found.to_viewer = -(direction_ * (one<W>() / d_length));
    found.distance = to_double(s_ * d_length);
    found.position_size = found.distance;
    if (!camera_.perspective()) {
      const Point<W> from = rounded<W>(origin_);
      found.position_size = square_root(dot(from, from)) + found.distance;
    }
    found.hit &= ~rays_.undecided;
    return found;
  }

 private:
  static ExactPoint<W> vertex(const MeshObject& mesh, const Vec3d* vertices, Longs<W> place) {
    const double* table = &vertices[0].x;
    const Point<W> v = gathered_point<W>(table, place * 3);
    return times<W>(mesh.placement.linear, {Exactly<W>(v.x), Exactly<W>(v.y), Exactly<W>(v.z)}) + all<W>(mesh.placement.origin);
  }

  ExactPoint<W> at_depth(const Exactly<W>& s) const {
    return camera_.perspective() ? direction_ * s : origin_ + direction_ * s;
  }

  void settle(Longs<W> lanes, Surfaces<W>& found, const Exactly<W>& s, const ExactPoint<W>& position, const ExactPoint<W>& normal,
              const Point<W>& geometric) {
    s_ = chosen<W>(lanes, s, s_);
    found.position = chosen<W>(lanes, position, found.position);
    found.normal = chosen<W>(lanes, normal, found.normal);
    found.geometric = chosen<W>(lanes, geometric, found.geometric);
  }

  void on_mesh(int index, Longs<W> lanes, Surfaces<W>& found) {
    const MeshObject& mesh = world_.meshes[static_cast<std::size_t>(index)];
    const Corners<W> corner(mesh, lanes, rays_.triangle);
    const Vec3d* vertices = mesh.given->vertices.data();
    const ExactPoint<W> a = vertex(mesh, vertices, corner.place[0]);
    const ExactPoint<W> u = vertex(mesh, vertices, corner.place[1]) - a, v = vertex(mesh, vertices, corner.place[2]) - a;
    const ExactPoint<W> winding = cross(u, v);
    const ExactPoint<W> to_plane = camera_.perspective() ? a : a - origin_;
    const Exactly<W> s = dot(winding, to_plane) / dot(winding, direction_);
    rays_.undecided |= lanes & ~(magnitude<W>(to_double(s) - rays_.s) <= 16.0 * rays_.error);
    const ExactPoint<W> position = at_depth(s);

    const Point<W> facing = rounded<W>(winding);
    // Which side is seen: plain where rounding cannot tip it.
    const Point<W> d = rounded<W>(direction_);
    const Doubles<W> outward = -dot(facing, d);
    const Point<W> sizes_w = magnitudes<W>(facing), sizes_d = magnitudes<W>(d);
    rays_.undecided |= lanes & ~(magnitude<W>(outward) > 0x1p-48 * dot(sizes_w, sizes_d));
    const Longs<W> outside = outward > 0.0;
    const ExactPoint<W> geometric = chosen<W>(outside, winding, -winding);
    ExactPoint<W> normal = geometric;
    if (!mesh.given->vertex_normals.empty()) {
      const Exactly<W> scale = one<W>() / dot(winding, winding);
      const ExactPoint<W> from_a = position - a;
      const Exactly<W> beta = dot(cross(from_a, v), winding) * scale, gamma = dot(cross(u, from_a), winding) * scale;
      const double* normals = &mesh.given->vertex_normals[0].x;
      const auto normal_of = [&](int k) -> ExactPoint<W> {
        const Point<W> n = gathered_point<W>(normals, corner.place[k] * 3);
        return {Exactly<W>(n.x), Exactly<W>(n.y), Exactly<W>(n.z)};
      };
      const ExactPoint<W> sum = normal_of(0) * (one<W>() - beta - gamma) + normal_of(1) * beta + normal_of(2) * gamma;
      const Matrix3<DoubleDouble>& back = world_.objects[static_cast<std::size_t>(mesh.object)].to_canonical_linear;
      normal = {dot(all<W>(back.column[0]), sum), dot(all<W>(back.column[1]), sum), dot(all<W>(back.column[2]), sum)};
      const Doubles<W> same_side = to_double(dot(normal, geometric));
      normal = chosen<W>(same_side < 0.0, -normal, normal);
    }
    Longs<W> failed{};
    const ExactPoint<W> unit_normal = direction_of<W>(normal, failed);
    rays_.undecided |= lanes & failed;
    settle(lanes, found, s, position, unit_normal, rounded<W>(geometric));
  }

  void on_objects(Longs<W> lanes, Surfaces<W>& found) {
    constexpr std::int64_t stride = sizeof(Object) / sizeof(double);
    static_assert(sizeof(Object) % sizeof(double) == 0);
    const Longs<W> place = (lanes ? rays_.object : Longs<W>{}) * stride;
    const Object& first = world_.objects.front();
    const auto frame_part = [&](const Vec3dd& part) { return gathered_exact_point<W>(&part.x.hi, place); };
    const ExactPoint<W> eye = frame_part(first.exact.eye), right = frame_part(first.exact.right), up = frame_part(first.exact.up),
                        forward = frame_part(first.exact.forward);
    const ExactPoint<W> sideways = right * rays_.x + up * rays_.y;
    const ExactPoint<W> o = camera_.perspective() ? eye : eye + sideways, d = camera_.perspective() ? sideways + forward : forward;

    Longs<W> flat{};
    for (int i = 0; i < W; ++i) {
      const bool is_round = lanes[i] == 0 || world_.objects[static_cast<std::size_t>(rays_.object[i])].solid == Solid::sphere;
      flat[i] = is_round ? 0 : -1;
    }
    Exactly<W> s;
    if (any<W>(flat)) s = -(o.z / d.z);
    if (any<W>(lanes & ~flat)) {
      const Exactly<W> dd = dot(d, d), s0 = -(dot(o, d) / dd);
      const ExactPoint<W> q = o + d * s0;
      const Exactly<W> rest = one<W>() - dot(q, q), half_chord = root<W>(rest / dd);
      rays_.undecided |= lanes & ~flat & ~(to_double(rest) > 0x1p-80);
      s = chosen<W>(flat, s, chosen<W>((rays_.face & 1) != 0, s0 + half_chord, s0 - half_chord));
    }
    const ExactPoint<W> at = o + d * s;
    const ExactPoint<W> upwards{Exactly<W>{}, Exactly<W>{}, one<W>()};
    const ExactPoint<W> canonical = chosen<W>(flat, upwards, at);
    ExactPoint<W> outward;
    Exactly<W>* const part[3] = {&outward.x, &outward.y, &outward.z};
    for (int k = 0; k < 3; ++k) *part[k] = dot(gathered_exact_point<W>(&first.to_canonical_linear.column[k].x.hi, place), canonical);
    const Longs<W> outside = to_double(dot(canonical, d)) < 0.0;
    Longs<W> failed{};
    const ExactPoint<W> normal = direction_of<W>(chosen<W>(outside, outward, -outward), failed);
    rays_.undecided |= lanes & failed;
    settle(lanes, found, s, at_depth(s), normal, rounded<W>(normal));
  }

  const World& world_;
  const Camera& camera_;
  CameraRays<W>& rays_;
  ExactPoint<W> direction_, origin_;
  Exactly<W> s_;
};

}  // namespace equilux::packets
