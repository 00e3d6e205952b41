#include "emitter_view.h"

#include <limits>

namespace equilux {
bool rim_crossings(const EmitterView::Rim& rim, const Vec3d& m, double turn[2]) {
  const double constant = dot(m, rim.middle), cosine = dot(m, rim.cosine), sine = dot(m, rim.sine), swing = std::hypot(cosine, sine);
  if (!(std::fabs(constant) < swing)) return false;
  const double middle = std::atan2(sine, cosine), apart = std::acos(-constant / swing);
  turn[0] = middle - apart;
  turn[1] = middle + apart;
  return true;
}

Stretch EmitterView::stretch(const HalfPlane& plane) const {
  switch (kind) {
    case Kind::sphere:
      return {0, cone};
    case Kind::disc: {
      // along the disc, in the half-plane: g = b − a (n·b)/(n·a); the rim is at centre + (radius/|g|) g
      const double slope = dot(normal, plane.b) / dot(normal, plane.a);
      const double reach = radius / std::sqrt(1 + slope * slope);
      return {0, std::atan2(reach, length(centre) - reach * slope)};
    }
    case Kind::rectangle: {
      const double across = height / -dot(plane.b, normal);
      return {std::atan2(across, u_high), std::atan2(across, u_low)};
    }
    case Kind::environment:
      break;
  }
  return {0, half_angle};
}

double EmitterView::reach(const Vec3d& m) const {
  switch (kind) {
    case Kind::sphere: return radius * length(m);
    case Kind::disc: return radius * length(m - normal * dot(m, normal));
    case Kind::rectangle: return 0.5 * (std::fabs(dot(m, corner[1] - corner[0])) + std::fabs(dot(m, corner[3] - corner[0])));
    case Kind::environment: break;
  }
  return 0;
}

double EmitterView::distance(const Vec3d& direction) const {
  switch (kind) {
    case Kind::sphere: {
      const Vec3d off = cross(centre, direction);
      return dot(centre, direction) - std::sqrt(std::max(0.0, radius * radius - dot(off, off)));
    }
    case Kind::disc:
    case Kind::rectangle:
      return height / -dot(normal, direction);
    case Kind::environment:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

EmitterView::Rim EmitterView::rim() const {
  if (kind == Kind::sphere) return {pencil.axis * std::cos(cone), pencil.zero * std::sin(cone), pencil.quarter * std::sin(cone)};
  return {centre, across[0] * radius, across[1] * radius};
}

double EmitterView::turn_of(double azimuth) const {
  if (kind != Kind::disc) return azimuth;
  const HalfPlane plane = pencil.at(azimuth);
  const Vec3d along = plane.b - plane.a * (dot(normal, plane.b) / dot(normal, plane.a));
  return std::atan2(dot(along, across[1]), dot(along, across[0]));
}

double EmitterView::azimuth_of(double turn, double& slope) const {
  slope = 1;
  if (kind != Kind::disc) return turn;
  const double c = std::cos(turn), s = std::sin(turn);
  const Vec3d out = across[0] * c + across[1] * s, on = across[1] * c - across[0] * s;  // the rim about the centre, which is on the axis
  const double x = dot(out, pencil.zero), y = dot(out, pencil.quarter);
  slope = (x * dot(on, pencil.quarter) - y * dot(on, pencil.zero)) / (x * x + y * y);
  return std::atan2(y, x);
}

void EmitterView::crossings_with(const Vec3d& m, std::vector<Breakpoint>& out) const {
  switch (kind) {
    case Kind::sphere:
    case Kind::disc: {
      const Rim around = rim();
      double turn[2];
      if (!rim_crossings(around, m, turn)) break;
      for (const double at : turn) out.push_back({pencil.azimuth(around.at(at)), false});
      break;
    }
    case Kind::rectangle:
      for (const int side : {0, 1}) {  // the two edges along edge_v
        const Vec3d& from = corner[side == 0 ? 0 : 1];
        const Vec3d& to = corner[side == 0 ? 3 : 2];
        const double here = dot(m, from), there = dot(m, to);
        if ((here < 0) != (there < 0)) out.push_back({pencil.azimuth(from + (to - from) * (here / (here - there))), false});
      }
      break;
    case Kind::environment:
      break;
  }
}

bool view_of_sphere(const Vec3d& centre, double radius, const Vec3d& zero, EmitterView& view) {
  const double distance = length(centre), free = (distance - radius) * (distance + radius);
  if (!(distance > radius) || !(free > 0)) return false;
  view.kind = EmitterView::Kind::sphere;
  view.centre = centre;
  view.radius = radius;
  view.cone = std::atan2(radius, std::sqrt(free));
  view.pencil = pencil_about(centre * (1 / distance), zero);
  view.towards = view.pencil.axis;
  view.half_angle = view.cone;
  return true;
}

bool view_of_disc(const Vec3d& centre, const Vec3d& normal, double radius, const Vec3d& zero, EmitterView& view) {
  view.height = -dot(normal, centre);
  const double distance = length(centre);
  if (!(view.height > 1e-13 * (distance + radius))) return false;
  view.kind = EmitterView::Kind::disc;
  view.centre = centre;
  view.normal = normal;
  view.radius = radius;
  view.pencil = pencil_about(centre * (1 / distance), zero);
  complete_frame(-normal, view.across[0], view.across[1]);
  view.towards = view.pencil.axis;
  view.half_angle = distance > radius ? std::asin(radius / distance) : 0.5 * pi;
  return true;
}

bool view_of_rectangle(const Vec3d& corner, const Vec3d& edge_u, const Vec3d& edge_v, EmitterView& view) {
  const double u = length(edge_u), v = length(edge_v);
  const Vec3d along_u = edge_u * (1 / u), along_v = unit(edge_v - along_u * dot(edge_v, along_u));
  view.normal = cross(along_u, along_v);
  view.height = -dot(view.normal, corner);
  if (!(view.height > 1e-13 * (length(corner) + u + v))) return false;
  view.kind = EmitterView::Kind::rectangle;
  view.centre = corner + edge_u * 0.5 + edge_v * 0.5;
  view.pencil = {along_u, -view.normal, along_v};
  const double v_low = dot(corner, along_v);
  view.first = std::atan2(v_low, view.height);
  view.last = std::atan2(v_low + v, view.height);
  view.u_low = dot(corner, along_u);
  view.u_high = view.u_low + u;
  view.corner[0] = corner;
  view.corner[1] = corner + edge_u;
  view.corner[2] = corner + edge_u + edge_v;
  view.corner[3] = corner + edge_v;
  const double distance = length(view.centre), reach = 0.5 * std::hypot(u, v);
  view.towards = view.centre * (1 / distance);
  view.half_angle = distance > reach ? std::asin(reach / distance) : 0.5 * pi;
  return true;
}

void view_of_environment(const Vec3d& axis, double half_angle, const Vec3d& zero, EmitterView& view) {
  view.kind = EmitterView::Kind::environment;
  view.pencil = pencil_about(axis, zero);
  view.towards = axis;
  view.half_angle = half_angle;
}

}  // namespace equilux
