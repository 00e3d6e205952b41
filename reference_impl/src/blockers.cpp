#include "blockers.h"

#include "placement.h"
#include "shapes/dispatch.h"

namespace equilux {
namespace {

constexpr double touching = 1e-12;  // of the lengths involved: surfaces nearer than that coincide
constexpr std::size_t cluster_size = 24;

Matrix3<double> to_double(const Matrix3<DoubleDouble>& m) {
  return {{equilux::to_double(m.column[0]), equilux::to_double(m.column[1]), equilux::to_double(m.column[2])}};
}

double bounding_radius(Solid solid, const Matrix3<double>& columns) {
  double sum = 0;  // of the box around the canonical shape; exact enough for culling
  for (const Vec3d& column : columns.column) sum += dot(column, column);
  const bool round = solid == Solid::sphere;
  if (round) {
    double size = 0;
    for (const Vec3d& column : columns.column) size = std::max(size, length(column));
    return std::min(std::sqrt(sum), size * std::sqrt(3.0));
  }
  return std::sqrt(sum);
}

bool is_flat(Solid solid) { return solid == Solid::plane || solid == Solid::disc || solid == Solid::rectangle; }
bool is_convex(Solid solid) { return solid != Solid::cylinder_open && solid != Solid::mesh; }

// Does the ball meet the hull of the point and the emitter, above the horizon?
bool ball_may_block(const Vec3d& centre, double radius, const Vec3d& normal, const EmitterView& emitter) {
  if (dot(normal, centre) + radius <= touching * (length(centre) + radius)) return false;
  const double distance = length(centre);
  if (distance <= radius || emitter.half_angle >= pi) return true;
  const double apart = std::atan2(length(cross(emitter.towards, centre)), dot(emitter.towards, centre));
  if (apart > emitter.half_angle + std::asin(radius / distance) + 1e-9) return false;
  if (emitter.flat()) return dot(emitter.normal, centre) + emitter.height > -radius;
  return emitter.kind == EmitterView::Kind::environment || distance - radius < length(emitter.centre);
}

// A plane through the point that has the emitter on its other side shows that a shape on this side is not in between.
template <class Shape> bool beside(const Shape& shape, const Vec3d& m, double tolerance) {
  return dot(m, shape.centre) - half_extent(shape.solid, transposed_times(shape.columns, m)) >= -tolerance;
}

}  // namespace

Obstacles::Obstacles(const World& given) : world(given) {
  if (!world.description.rules.occlusion) return;  // nothing is in between
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const Object& object = world.objects[i];
    if (object.solid == Solid::mesh) continue;
    const ObjectDescription& described = world.description.objects[i];
    const Placement placement = chained(canonical_to_object(described), object_to_eye(described, world.camera.eye));
    shapes.push_back({object.solid, static_cast<int>(i), to_double(object.to_canonical_linear), to_double(placement.linear), placement});
  }
  for (const MeshObject& mesh : world.meshes) {
    for (std::size_t first = 0; first < mesh.given->faces.size(); first += cluster_size) {
      Cluster cluster{mesh.object, {}, 0, triangles.size(), 0};
      Vec3d lower{1e300, 1e300, 1e300}, upper = -lower;
      for (std::size_t i = first; i < std::min(first + cluster_size, mesh.given->faces.size()); ++i) {
        std::array<Vec3d, 3> triangle;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3d v = triangle[k] = equilux::to_double(mesh.vertex(mesh.given->faces[i][k]));
          lower = {std::min(lower.x, v.x), std::min(lower.y, v.y), std::min(lower.z, v.z)};
          upper = {std::max(upper.x, v.x), std::max(upper.y, v.y), std::max(upper.z, v.z)};
        }
        triangles.push_back(triangle);
      }
      cluster.last = triangles.size();
      cluster.centre = (lower + upper) * 0.5;
      cluster.radius = 0.5 * length(upper - lower) * (1 + 1e-9);
      clusters.push_back(cluster);
    }
  }
}

void Blockers::gather(const Obstacles& obstacles, const ShadedPoint& point, const EmitterView& emitter, int emitter_object) {
  emitter_ = &emitter;
  shapes_.clear();
  triangles_.clear();
  bundles_.clear();
  const Vec3d position = to_double(point.position);
  const double eye_distance = length(position);

  for (const Obstacles::Shape& given : obstacles.shapes) {
    if (given.object == emitter_object) continue;
    const bool own = given.object == point.object;
    if (own && (is_flat(given.solid) || (point.outside && is_convex(given.solid)))) continue;
    Shape shape{given.solid, own, false, false, {}, given.back, given.columns, {}};
    const Object& object = obstacles.world.objects[static_cast<std::size_t>(given.object)];
    shape.o = to_double(object.to_canonical_linear * point.position + object.exact.eye);
    shape.centre = to_double(given.placement.origin - point.position);
    if (is_flat(given.solid) && std::fabs(shape.o.z) <= touching * (1 + length(shape.o))) continue;  // seen edge-on
    const Vec3d row_z = {shape.back.column[0].z, shape.back.column[1].z, shape.back.column[2].z};
    const double tolerance = touching * (length(shape.centre) + bounding_radius(given.solid, shape.columns));
    if (emitter.kind != EmitterView::Kind::environment) {
      if (is_flat(given.solid)) {  // point and emitter on one side of it
        const double middle = shape.o.z + dot(row_z, emitter.centre), reach = emitter.reach(row_z);
        if (shape.o.z > 0 ? middle - reach >= -touching * shape.o.z : middle + reach <= -touching * shape.o.z) continue;
      }
    }
    if (given.solid != Solid::plane) {
      if (beside(shape, -point.normal, tolerance)) continue;
      if (!ball_may_block(shape.centre, bounding_radius(given.solid, shape.columns), point.normal, emitter)) continue;
      if (emitter.flat() && beside(shape, -emitter.normal, -(emitter.height - tolerance))) continue;  // beyond it
      if (emitter.kind == EmitterView::Kind::rectangle) {
        bool apart = false;
        for (int k = 0; k < 4 && !apart; ++k) {
          Vec3d m = cross(emitter.corner[k], emitter.corner[(k + 1) % 4]);
          const double size = length(m);
          if (!(size > 0)) continue;
          m = m * ((dot(m, emitter.centre) > 0 ? -1 : 1) / size);
          apart = beside(shape, m, tolerance);
        }
        if (apart) continue;
      } else if (emitter.half_angle < 0.49 * pi) {
        const Vec3d across = shape.centre - emitter.towards * dot(shape.centre, emitter.towards);
        const double size = length(across);
        if (size > 0 && beside(shape, across * (std::cos(emitter.half_angle) / size) - emitter.towards * std::sin(emitter.half_angle), tolerance)) {
          continue;
        }
        // the visible part of a sphere ends where the cone touches it
        if (emitter.kind == EmitterView::Kind::sphere) {
          const double depth = length(emitter.centre) * std::cos(emitter.cone) * std::cos(emitter.cone);
          if (beside(shape, emitter.towards, -depth)) continue;
        }
      }
    }
    switch (given.solid) {
      case Solid::sphere: shape.inside = own || dot(shape.o, shape.o) <= 1; break;
      case Solid::cylinder_capped:
      case Solid::cylinder_open: shape.inside = shape.o.x * shape.o.x + shape.o.y * shape.o.y <= 1 + (own ? 1e-9 : 0); break;
      default: break;
    }
    if (emitter.flat()) {  // does part of it lie beyond the emitter's plane?
      const Vec3d m = emitter.normal;
      shape.pierces = given.solid == Solid::plane ||
                      dot(m, shape.centre) + emitter.height < half_extent(given.solid, transposed_times(shape.columns, m)) + tolerance;
    } else if (emitter.kind == EmitterView::Kind::sphere) {
      shape.pierces = true;
      const Vec3d at = shape.o + shape.back * emitter.centre;  // the emitter's centre in the canonical frame
      const double coordinate[3] = {at.x, at.y, at.z};
      for (int k = 0; k < 3; ++k) {
        const auto component = [k](const Vec3d& v) { return k == 0 ? v.x : k == 1 ? v.y : v.z; };
        const double row = std::sqrt(component(shape.back.column[0]) * component(shape.back.column[0]) +
                                     component(shape.back.column[1]) * component(shape.back.column[1]) +
                                     component(shape.back.column[2]) * component(shape.back.column[2]));
        if (given.solid == Solid::plane && k != 2) continue;
        const double half = is_flat(given.solid) && k == 2 ? 0 : 1;
        if (std::fabs(coordinate[k]) > half + emitter.radius * row) shape.pierces = false;
      }
      if (given.solid != Solid::plane &&
          length(shape.centre - emitter.centre) > emitter.radius + bounding_radius(given.solid, shape.columns)) {
        shape.pierces = false;
      }
    }
    shapes_.push_back(shape);
  }

  for (const Obstacles::Cluster& cluster : obstacles.clusters) {
    if (!ball_may_block(cluster.centre - position, cluster.radius, point.normal, emitter)) continue;
    const std::size_t first = triangles_.size();
    for (std::size_t i = cluster.first; i < cluster.last; ++i) {
      const std::array<Vec3d, 3>& given = obstacles.triangles[i];
      Triangle triangle{{given[0] - position, given[1] - position, given[2] - position}};
      const auto& [a, b, c] = triangle.corner;
      const Vec3d m = cross(b - a, c - a);
      const double size = eye_distance + length(a) + length(b) + length(c), here = dot(m, a);
      if (std::fabs(here) <= 1e-13 * size * length(m)) continue;  // seen edge-on, the point's own triangle among them
      if (std::max({dot(point.normal, a), dot(point.normal, b), dot(point.normal, c)}) <= touching * size) continue;
      if (emitter.kind != EmitterView::Kind::environment) {
        const double far = dot(m, emitter.centre) - here, reach = emitter.reach(m);  // the point is at −here
        if (here > 0 ? far + reach <= 0 : far - reach >= 0) continue;
      }
      if (emitter.kind == EmitterView::Kind::rectangle) {
        bool apart = false;
        for (int k = 0; k < 4 && !apart; ++k) {
          Vec3d side = cross(emitter.corner[k], emitter.corner[(k + 1) % 4]);
          if (dot(side, emitter.centre) > 0) side = -side;
          apart = dot(side, a) >= 0 && dot(side, b) >= 0 && dot(side, c) >= 0;
        }
        if (apart) continue;
      }
      if (emitter.flat()) {
        const auto above = [&](const Vec3d& v) { return dot(emitter.normal, v) + emitter.height; };
        if (std::max({above(a), above(b), above(c)}) <= touching * size) continue;
      }
      triangles_.push_back(triangle);
    }
    if (triangles_.size() > first) bundles_.push_back({cluster.centre - position, cluster.radius, first, triangles_.size()});
  }
}

namespace {

// a + b cos + c sin + d cos 2 + e sin 2, through its values at five points.
struct SecondHarmonics {
  double a = 0, b = 0, c = 0, d = 0, e = 0;

  template <class F> explicit SecondHarmonics(const F& f) {
    for (int k = 0; k < 5; ++k) {
      const double turn = 2 * pi * k / 5, value = f(turn) / 5;
      a += value;
      b += 2 * value * std::cos(turn);
      c += 2 * value * std::sin(turn);
      d += 2 * value * std::cos(2 * turn);
      e += 2 * value * std::sin(2 * turn);
    }
  }
  double at(double t) const {
    const double x = std::cos(t), y = std::sin(t);
    return a + b * x + c * y + d * (x * x - y * y) + 2 * e * x * y;
  }
  double slope(double t) const {
    const double x = std::cos(t), y = std::sin(t);
    return c * x - b * y + 2 * e * (x * x - y * y) - 4 * d * x * y;
  }

  // Its zeros: at most four. Between samples also those on both sides of an extremum that just reaches over.
  template <class G> void zeros(const G& found) const {
    constexpr int samples = 24;
    for (int k = 0; k < samples; ++k) {
      const double low = 2 * pi * k / samples, high = 2 * pi * (k + 1) / samples, here = at(low), there = at(high);
      if ((here > 0) != (there > 0)) {
        found(crossing(low, high, [this](double t) { return at(t); }));
      } else if ((slope(low) > 0) != (slope(high) > 0)) {
        const double top = crossing(low, high, [this](double t) { return slope(t); });
        if ((at(top) > 0) == (here > 0)) continue;
        found(crossing(low, top, [this](double t) { return at(t); }));
        found(crossing(top, high, [this](double t) { return at(t); }));
      }
    }
  }

 private:
  template <class F> static double crossing(double low, double high, const F& f) {
    const bool positive = f(low) > 0;
    for (int step = 0; step < 44; ++step) ((f(0.5 * (low + high)) > 0) == positive ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }
};

}  // namespace

// --- one half-plane ---------------------------------------------------------------------------------------------------

namespace {

void add_angle(double along, double across, std::vector<double>& out) {
  if (across > 0) out.push_back(std::atan2(across, along));
}

// Where the chord of the half-plane with the canonical plane z = level, clipped by `clip`, ends. A', B': the half-plane's axes there.
template <class Clip>
void chord_angles(const Vec3d& o, const Vec3d& A, const Vec3d& B, double level, const Clip& clip, std::vector<double>& out) {
  const double slope = std::hypot(A.z, B.z);
  if (!(slope > 0)) return;
  const double nearest = (level - o.z) / slope, na = A.z / slope, nb = B.z / slope;  // (x, y) = nearest (na, nb) + s (−nb, na)
  const Vec3d from = o + A * (nearest * na) + B * (nearest * nb), along = B * na - A * nb;
  double low, high;
  if (!clip(from, along, low, high)) return;
  for (const double s : {low, high}) {
    if (std::isfinite(s)) add_angle(nearest * na - s * nb, nearest * nb + s * na, out);
  }
}

bool clip_by_disc(const Vec3d& from, const Vec3d& along, double& low, double& high) {
  const double dd = along.x * along.x + along.y * along.y;
  if (!(dd > 0)) return false;
  const double middle = -(from.x * along.x + from.y * along.y) / dd;
  const double x = from.x + middle * along.x, y = from.y + middle * along.y, rest = (1 - (x * x + y * y)) / dd;
  if (!(rest > 0)) return false;
  low = middle - std::sqrt(rest);
  high = middle + std::sqrt(rest);
  return true;
}

bool clip_by_square(const Vec3d& from, const Vec3d& along, double& low, double& high) {
  low = -std::numeric_limits<double>::infinity();
  high = -low;
  const double position[2] = {from.x, from.y}, direction[2] = {along.x, along.y};
  for (int k = 0; k < 2; ++k) {
    if (direction[k] == 0) {
      if (std::fabs(position[k]) > 1) return false;
      continue;
    }
    const double a = (-1 - position[k]) / direction[k], b = (1 - position[k]) / direction[k];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  return low < high;
}

void box_angles(const Vec3d& centre, const Matrix3<double>& columns, const HalfPlane& plane, std::vector<double>& out) {
  Vec3d corner[8];
  double side[8];
  for (int i = 0; i < 8; ++i) {
    corner[i] = centre + columns.column[0] * (i & 1 ? 1.0 : -1.0) + columns.column[1] * (i & 2 ? 1.0 : -1.0) +
                columns.column[2] * (i & 4 ? 1.0 : -1.0);
    side[i] = dot(plane.normal, corner[i]);
  }
  for (int i = 0; i < 8; ++i) {
    for (int axis = 1; axis < 8; axis *= 2) {
      const int j = i | axis;
      if (j == i || (side[i] < 0) == (side[j] < 0)) continue;
      const Vec3d at = corner[i] + (corner[j] - corner[i]) * (side[i] / (side[i] - side[j]));
      add_angle(dot(at, plane.a), dot(at, plane.b), out);
    }
  }
}

}  // namespace

void Blockers::outline_angles(const Shape& shape, const HalfPlane& plane, std::vector<double>& out) const {
  if (shape.solid == Solid::box) return box_angles(shape.centre, shape.columns, plane, out);
  const Vec3d A = shape.back * plane.a, B = shape.back * plane.b;
  const Vec3d& o = shape.o;
  switch (shape.solid) {
    case Solid::plane: {
      double angle = std::atan2(A.z, -B.z);
      if (angle < 0) angle += pi;
      out.push_back(angle);
      break;
    }
    case Solid::sphere: {
      if (shape.inside) break;
      const Vec3d P = cross(o, A), Q = cross(o, B);  // the line touches where |o × d| = |d|
      double root[2];
      if (roots_of_form(dot(A, A) - dot(P, P), dot(A, B) - dot(P, Q), dot(B, B) - dot(Q, Q), root)) out.insert(out.end(), root, root + 2);
      break;
    }
    case Solid::disc:
      chord_angles(o, A, B, 0, clip_by_disc, out);
      break;
    case Solid::rectangle:
      chord_angles(o, A, B, 0, clip_by_square, out);
      break;
    case Solid::cylinder_capped:
    case Solid::cylinder_open: {
      chord_angles(o, A, B, -1, clip_by_disc, out);
      chord_angles(o, A, B, 1, clip_by_disc, out);
      if (shape.inside) break;
      const double P = o.x * A.y - o.y * A.x, Q = o.x * B.y - o.y * B.x;
      double root[2];
      if (roots_of_form(A.x * A.x + A.y * A.y - P * P, A.x * B.x + A.y * B.y - P * Q, B.x * B.x + B.y * B.y - Q * Q, root)) {
        out.insert(out.end(), root, root + 2);
      }
      break;
    }
    default:
      break;
  }
}

bool Blockers::blocks(const Shape& shape, const Vec3d& direction) const {
  const Vec3d d = shape.back * direction;
  const LocalRay<double> ray{shape.o, d, magnitudes(shape.o), magnitudes(d)};
  const Crossings<double> all = crossings(shape.solid, ray);
  const double nearest = shape.own ? 1e-9 / length(d) : 0, farthest = emitter_->distance(direction) * (1 - 1e-10);
  for (int i = 0; i < all.count; ++i) {
    if (all.at[i].s > nearest && all.at[i].s < farthest) return true;
  }
  return false;
}

void Blockers::piercing_angles(const Shape& shape, const HalfPlane& plane, std::vector<double>& out) const {
  if (emitter_->flat()) {  // along the line where the half-plane meets the emitter's plane
    const double na = dot(emitter_->normal, plane.a), nb = dot(emitter_->normal, plane.b), slope2 = na * na + nb * nb;
    if (!(slope2 > 0)) return;
    const double x0 = -emitter_->height * na / slope2, y0 = -emitter_->height * nb / slope2;
    const Vec3d A = shape.back * plane.a, B = shape.back * plane.b, o = shape.o + A * x0 + B * y0, d = B * na - A * nb;
    const LocalRay<double> line{o, d, magnitudes(shape.o) + magnitudes(A * x0) + magnitudes(B * y0), magnitudes(d)};
    const Crossings<double> all = crossings(shape.solid, line);
    for (int i = 0; i < all.count; ++i) add_angle(x0 - all.at[i].s * nb, y0 + all.at[i].s * na, out);
    return;
  }
  if (emitter_->kind != EmitterView::Kind::sphere) return;
  // The half-plane cuts the sphere in a circle, and every flat face, o_k + x A_k + y B_k = level, in a line.
  const Vec3d A = shape.back * plane.a, B = shape.back * plane.b;
  const double cx = dot(emitter_->centre, plane.a), cy = dot(emitter_->centre, plane.b), off = dot(emitter_->centre, plane.normal);
  const double radius2 = emitter_->radius * emitter_->radius - off * off;
  const auto meet = [&](double p, double q, double constant) {  // p x + q y + constant = 0
    const double size2 = p * p + q * q, distance = p * cx + q * cy + constant, rest = radius2 - distance * distance / size2;
    if (!(rest > 0)) return;
    const double along = std::sqrt(rest / size2), x = cx - p * distance / size2, y = cy - q * distance / size2;
    add_angle(x - q * along, y + p * along, out);
    add_angle(x + q * along, y - p * along, out);
  };
  switch (shape.solid) {
    case Solid::plane:
    case Solid::disc:
    case Solid::rectangle: meet(A.z, B.z, shape.o.z); return;
    case Solid::box:
      for (const double level : {-1.0, 1.0}) {
        meet(A.x, B.x, shape.o.x - level);
        meet(A.y, B.y, shape.o.y - level);
        meet(A.z, B.z, shape.o.z - level);
      }
      return;
    default: break;
  }
  // A round side: around that circle it is a trigonometric polynomial with two harmonics.
  if (!(radius2 > 0)) return;
  const double radius = std::sqrt(radius2);
  const bool cylinder = shape.solid != Solid::sphere;
  const SecondHarmonics around([&](double turn) {
    const Vec3d q = shape.o + A * (cx + radius * std::cos(turn)) + B * (cy + radius * std::sin(turn));
    return q.x * q.x + q.y * q.y + (cylinder ? 0 : q.z * q.z) - 1;
  });
  around.zeros([&](double turn) { add_angle(cx + radius * std::cos(turn), cy + radius * std::sin(turn), out); });
  if (cylinder) {
    meet(A.z, B.z, shape.o.z - 1);
    meet(A.z, B.z, shape.o.z + 1);
  }
}

void Blockers::triangle_gap(const Triangle& triangle, const HalfPlane& plane, Gaps& out) const {
  double side[3];
  for (int k = 0; k < 3; ++k) side[k] = dot(plane.normal, triangle.corner[k]);
  Vec3d end[2];
  int count = 0;
  for (int k = 0; k < 3 && count < 2; ++k) {
    const int j = (k + 1) % 3;
    if ((side[k] < 0) == (side[j] < 0)) continue;
    end[count++] = triangle.corner[k] + (triangle.corner[j] - triangle.corner[k]) * (side[k] / (side[k] - side[j]));
  }
  if (count < 2) return;
  if (emitter_->flat()) {  // only what is on this side of the emitter's plane
    const auto above = [&](const Vec3d& v) { return dot(emitter_->normal, v) + emitter_->height * (1 - 1e-10); };
    const double first = above(end[0]), second = above(end[1]);
    if (first <= 0 && second <= 0) return;
    if (first <= 0) end[0] = end[0] + (end[1] - end[0]) * (first / (first - second));
    if (second <= 0) end[1] = end[1] + (end[0] - end[1]) * (second / (second - first));
  }
  double x[2], y[2];
  for (int k = 0; k < 2; ++k) x[k] = dot(end[k], plane.a), y[k] = dot(end[k], plane.b);
  if (y[0] <= 0 && y[1] <= 0) return;
  for (int k = 0; k < 2; ++k) {
    if (y[k] >= 0) continue;
    const int other = 1 - k;
    x[k] += (x[other] - x[k]) * (y[k] / (y[k] - y[other]));
    y[k] = 0;
  }
  const double first = std::atan2(y[0], x[0]), second = std::atan2(y[1], x[1]);
  Stretch gap{std::min(first, second), std::max(first, second)};
  if (emitter_->kind == EmitterView::Kind::sphere) {
    // Parts of the segment beyond the sphere's surface do not block: the line and the circle in which the half-plane cuts the sphere.
    const auto nearer = [&](double angle) {
      const Vec3d direction = plane.direction(angle);
      const double c = std::cos(angle), s = std::sin(angle), dx = x[1] - x[0], dy = y[1] - y[0];
      const double along = (x[0] * dy - y[0] * dx) / (c * dy - s * dx);
      return along < emitter_->distance(direction) * (1 - 1e-10);
    };
    const double cx = dot(emitter_->centre, plane.a), cy = dot(emitter_->centre, plane.b), off = dot(emitter_->centre, plane.normal);
    const double dx = x[1] - x[0], dy = y[1] - y[0], dd = dx * dx + dy * dy, middle = ((cx - x[0]) * dx + (cy - y[0]) * dy) / dd;
    const double qx = x[0] + middle * dx - cx, qy = y[0] + middle * dy - cy;
    const double rest = (emitter_->radius * emitter_->radius - off * off - qx * qx - qy * qy) / dd;
    double cut[4] = {gap.low, gap.high, gap.high, gap.high};
    int cuts = 1;
    if (rest > 0) {
      for (const double s : {middle - std::sqrt(rest), middle + std::sqrt(rest)}) {
        const double angle = std::atan2(y[0] + s * dy, x[0] + s * dx);
        if (s > 0 && s < 1 && angle > gap.low && angle < gap.high) cut[cuts++] = angle;
      }
      if (cuts == 3 && cut[1] > cut[2]) std::swap(cut[1], cut[2]);
      cut[cuts] = gap.high;
    }
    for (int k = 0; k < cuts; ++k) {
      if (nearer(0.5 * (cut[k] + cut[k + 1]))) out.add(cut[k], cut[k + 1]);
    }
    return;
  }
  out.add(gap.low, gap.high);
}

void Blockers::gaps(const HalfPlane& plane, Stretch within, Gaps& out) {
  out.clear();
  for (const Shape& shape : shapes_) {
    angles_.clear();
    outline_angles(shape, plane, angles_);
    if (shape.pierces) piercing_angles(shape, plane, angles_);
    std::erase_if(angles_, [&](double angle) { return !(angle > within.low && angle < within.high); });
    angles_.push_back(within.high);
    std::sort(angles_.begin(), angles_.end());
    double from = within.low;
    for (const double to : angles_) {
      if (to > from && blocks(shape, plane.direction(0.5 * (from + to)))) out.add(from, to);
      from = to;
    }
  }
  for (const Bundle& bundle : bundles_) {
    if (std::fabs(dot(plane.normal, bundle.centre)) > bundle.radius || dot(plane.b, bundle.centre) < -bundle.radius) continue;
    for (std::size_t i = bundle.first; i < bundle.last; ++i) triangle_gap(triangles_[i], plane, out);
  }
}

// --- across half-planes -----------------------------------------------------------------------------------------------

// Only what is above the horizon (or on it) and about the emitter can bend what is seen of it. Where a shape pierces a sphere emitter not
// all bends are found, and the others fence them in.
bool Blockers::matters(const Vec3d& direction) const {
  constexpr double margin = 1e-9;
  if (pierced_) return true;
  const double size = length(direction);
  if (dot(direction, circles_[0]) < -margin * size) return false;
  return emitter_->half_angle >= 0.5 * pi || dot(direction, emitter_->towards) >= std::cos(emitter_->half_angle) * size - margin * size;
}

// The half-planes that touch an ellipsoid (three columns) or an ellipse (two): m·centre = ± |Mᵀ m|, m = axis × b(α).
void Blockers::tangents(const Vec3d& centre, const Vec3d* columns, int count, std::vector<Breakpoint>& out) const {
  const Pencil& pencil = emitter_->pencil;
  const Vec3d& f = pencil.quarter;
  const Vec3d g = -pencil.zero;  // m = f cos α + g sin α
  double P = dot(f, centre) * dot(f, centre), Q = dot(f, centre) * dot(g, centre), R = dot(g, centre) * dot(g, centre);
  for (int k = 0; k < count; ++k) {
    P -= dot(f, columns[k]) * dot(f, columns[k]);
    Q -= dot(f, columns[k]) * dot(g, columns[k]);
    R -= dot(g, columns[k]) * dot(g, columns[k]);
  }
  double root[2];
  if (!roots_of_form(P, Q, R, root)) return;
  for (const double at : root) {
    for (const double azimuth : {at, at - pi}) {
      // The other half of the same plane touches it on the far side of the axis: only the half that holds the point of contact counts.
      const Vec3d m = f * std::cos(azimuth) + g * std::sin(azimuth);
      Vec3d contact = centre;
      double size2 = 0;
      for (int k = 0; k < count; ++k) size2 += dot(m, columns[k]) * dot(m, columns[k]);
      if (!(size2 > 0)) continue;
      for (int k = 0; k < count; ++k) contact = contact - columns[k] * (dot(m, columns[k]) * dot(m, centre) / size2);
      const Vec3d b = pencil.zero * std::cos(azimuth) + pencil.quarter * std::sin(azimuth);
      if (dot(contact, b) >= 0 && matters(contact)) out.push_back({azimuth, true});
    }
  }
}

void Blockers::extent_of(const Shape& shape, std::vector<Breakpoint>& out) const {
  const Vec3d* column = shape.columns.column;
  switch (shape.solid) {
    case Solid::sphere:
      if (!shape.inside) tangents(shape.centre, column, 3, out);
      break;
    case Solid::disc:
      tangents(shape.centre, column, 2, out);
      break;
    case Solid::cylinder_capped:
    case Solid::cylinder_open:
      tangents(shape.centre - column[2], column, 2, out);
      tangents(shape.centre + column[2], column, 2, out);
      break;
    default:
      break;
  }
}

// The straight edges of a shape's outline: of a box those between a face that shows itself to the point and one that does not, of a
// cylinder the two lines along which its side is touched.
void Blockers::edges_of(const Shape& shape, std::vector<std::array<Vec3d, 2>>& out) const {
  const Vec3d* column = shape.columns.column;
  if (shape.solid == Solid::rectangle) {
    Vec3d last = shape.centre + column[0] - column[1];
    for (const auto& [u, v] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
      const Vec3d next = shape.centre + column[0] * double(u) + column[1] * double(v);
      out.push_back({last, next});
      last = next;
    }
  }
  if ((shape.solid == Solid::cylinder_capped || shape.solid == Solid::cylinder_open) && !shape.inside) {
    const double distance = std::hypot(shape.o.x, shape.o.y), middle = std::atan2(shape.o.y, shape.o.x);
    const double apart = std::acos(std::min(1.0, 1 / distance));  // to the lines along which the side is touched
    for (const double at : {middle - apart, middle + apart}) {
      const Vec3d side = shape.centre + column[0] * std::cos(at) + column[1] * std::sin(at);
      out.push_back({side - column[2], side + column[2]});
    }
  }
  if (shape.solid != Solid::box) return;
  const double o[3] = {shape.o.x, shape.o.y, shape.o.z};
  for (int along = 0; along < 3; ++along) {
    const int p = (along + 1) % 3, q = (along + 2) % 3;
    for (const double u : {-1.0, 1.0}) {
      for (const double v : {-1.0, 1.0}) {
        if ((o[p] * u > 1) == (o[q] * v > 1)) continue;
        const Vec3d middle = shape.centre + column[p] * u + column[q] * v;
        out.push_back({middle - column[along], middle + column[along]});
      }
    }
  }
}

// The round parts of a shape's outline: the circle along which a sphere is touched; the rims of a disc and of a cylinder's ends.
void Blockers::rims_of(const Shape& shape, std::vector<Rim>& out) const {
  const Vec3d* column = shape.columns.column;
  switch (shape.solid) {
    case Solid::sphere: {
      const double o2 = dot(shape.o, shape.o);
      if (shape.inside || !(o2 > 1)) break;
      Vec3d u, v;
      complete_frame(unit(shape.o), u, v);
      const double radius = std::sqrt(1 - 1 / o2);
      out.push_back({shape.centre + shape.columns * (shape.o * (1 / o2)), shape.columns * (u * radius), shape.columns * (v * radius)});
      break;
    }
    case Solid::disc:
      out.push_back({shape.centre, column[0], column[1]});
      break;
    case Solid::cylinder_capped:
    case Solid::cylinder_open:
      out.push_back({shape.centre - column[2], column[0], column[1]});
      out.push_back({shape.centre + column[2], column[0], column[1]});
      break;
    default:
      break;
  }
}

namespace {

// Directions between two others, on the shorter arc.
bool within(const std::array<Vec3d, 2>& edge, const Vec3d& m, const Vec3d& direction) {
  return dot(cross(edge[0], direction), m) >= 0 && dot(cross(direction, edge[1]), m) >= 0;
}

}  // namespace

// Where two outlines cross, as directions. A round outline is a cone with a quadratic form that is 0 on it,
//     sphere: |d|² − |o × d|²      rim of a disc or of a cylinder's end: d_z² − |o_xy d_z + (z − o_z) d_xy|²,      d = ω in the canonical frame
// and along another rim that form is a trigonometric polynomial with two harmonics.
template <class F> void Blockers::crossings_of_edges(const Outline& a, const Outline& b, const F& found) const {
  for (const auto& edge : a.edges) {
    const Vec3d m = cross(edge[0], edge[1]);
    for (const auto& other : b.edges) {
      const Vec3d m_other = cross(other[0], other[1]), direction = cross(m, m_other);
      for (const Vec3d& along : {direction, -direction}) {
        if (within(edge, m, along) && within(other, m_other, along)) found(along);
      }
    }
  }
}

template <class F> void Blockers::crossings_with_rims(const Outline& a, const std::vector<Rim>& rims, const F& found) const {
  for (const Rim& rim : rims) {
    for (const auto& edge : a.edges) {
      const Vec3d m = cross(edge[0], edge[1]);
      double turn[2];
      if (!rim_crossings(rim, m, turn)) continue;
      for (const double at : turn) {
        if (within(edge, m, rim.at(at))) found(rim.at(at));
      }
    }
    const Shape& shape = *a.shape;
    const Vec3d& o = shape.o;
    const auto on_cone = [&](const auto& form) {
      const SecondHarmonics around([&](double turn) { return form(shape.back * rim.at(turn)); });
      around.zeros([&](double turn) { found(rim.at(turn)); });
    };
    const auto end = [&](double z) {
      on_cone([&](const Vec3d& d) {
        const double x = o.x * d.z + (z - o.z) * d.x, y = o.y * d.z + (z - o.z) * d.y;
        return d.z * d.z - x * x - y * y;
      });
    };
    switch (shape.solid) {
      case Solid::sphere:
        if (shape.inside) break;
        on_cone([&](const Vec3d& d) {
          const Vec3d off = cross(o, d);
          return dot(d, d) - dot(off, off);
        });
        break;
      case Solid::disc:
        end(0);
        break;
      case Solid::cylinder_capped:
      case Solid::cylinder_open:
        end(-1);
        end(1);
        break;
      case Solid::plane: {
        double turn[2];
        if (!rim_crossings(rim, transposed_times(shape.back, Vec3d{0, 0, 1}), turn)) break;
        for (const double at : turn) found(rim.at(at));
        break;
      }
      default:
        break;
    }
  }
}

// The circles in which a shape's flat faces cut a sphere emitter: where half-planes touch them.
void Blockers::add_cuts(const Shape& shape, std::vector<Breakpoint>& out) const {
  const Matrix3<double>& back = shape.back;
  const Vec3d rows[3] = {{back.column[0].x, back.column[1].x, back.column[2].x},
                         {back.column[0].y, back.column[1].y, back.column[2].y},
                         {back.column[0].z, back.column[1].z, back.column[2].z}};
  const double o[3] = {shape.o.x, shape.o.y, shape.o.z};
  const auto cut = [&](int k, double level) {
    const double size = length(rows[k]), distance = (o[k] + dot(rows[k], emitter_->centre) - level) / size;
    const double rest = emitter_->radius * emitter_->radius - distance * distance;
    if (!(rest > 0)) return;
    const Vec3d normal = rows[k] * (1 / size);
    Vec3d columns[2];
    complete_frame(normal, columns[0], columns[1]);
    for (Vec3d& column : columns) column = column * std::sqrt(rest);
    tangents(emitter_->centre - normal * distance, columns, 2, out);
  };
  if (is_flat(shape.solid)) cut(2, 0);
  if (shape.solid == Solid::box) {
    for (const int k : {0, 1, 2}) cut(k, -1), cut(k, 1);
  }
  if (shape.solid == Solid::cylinder_capped) cut(2, -1), cut(2, 1);
}

void Blockers::breakpoints(const std::vector<Vec3d>& circles, std::vector<Breakpoint>& out) {
  const Pencil& pencil = emitter_->pencil;
  const bool round = emitter_->kind == EmitterView::Kind::sphere || emitter_->kind == EmitterView::Kind::disc;
  circles_ = circles;
  if (emitter_->kind == EmitterView::Kind::rectangle) {  // its edges along edge_v
    circles_.push_back(unit(cross(emitter_->corner[0], emitter_->corner[3])));
    circles_.push_back(unit(cross(emitter_->corner[1], emitter_->corner[2])));
  }
  const std::vector<Rim> emitter_rim = round ? std::vector<Rim>{emitter_->rim()} : std::vector<Rim>{};
  const auto add = [&](const Vec3d& direction) {
    if (matters(direction)) out.push_back({pencil.azimuth(direction), false});
  };

  outlines_.resize(shapes_.size());
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Shape& shape = shapes_[i];
    Outline& outline = outlines_[i];
    outline.shape = &shape;
    outline.edges.clear();
    outline.rims.clear();
    edges_of(shape, outline.edges);
    rims_of(shape, outline.rims);
    pierced_ = shape.pierces && emitter_->kind == EmitterView::Kind::sphere;
    extent_of(shape, out);
    for (const auto& [from, to] : outline.edges) {
      add(from);
      add(to);
    }
    if (pierced_) add_cuts(shape, out);
    crossings_with_rims(outline, emitter_rim, add);
    for (std::size_t j = 0; j < i; ++j) {
      crossings_of_edges(outline, outlines_[j], add);
      crossings_with_rims(outline, outlines_[j].rims, add);
      for (const Rim& rim : outline.rims) {
        for (const auto& edge : outlines_[j].edges) {
          const Vec3d m = cross(edge[0], edge[1]);
          double turn[2];
          if (!rim_crossings(rim, m, turn)) continue;
          for (const double at : turn) {
            if (within(edge, m, rim.at(at))) add(rim.at(at));
          }
        }
      }
    }
    for (const Vec3d& normal : circles_) {
      HalfPlane circle;
      complete_frame(normal, circle.a, circle.b);
      circle.normal = normal;
      for (const double turn : {1.0, -1.0}) {
        const HalfPlane half{circle.a, circle.b * turn, circle.normal * turn};
        angles_.clear();
        outline_angles(shape, half, angles_);
        for (const double angle : angles_) add(half.direction(angle));
      }
    }
  }
  pierced_ = false;
  constexpr std::size_t few = 16;
  if (triangles_.size() > few) return;
  for (const Triangle& triangle : triangles_) {
    for (const int k : {0, 1, 2}) {
      const std::array<Vec3d, 2> edge{triangle.corner[k], triangle.corner[(k + 1) % 3]};
      out.push_back({pencil.azimuth(edge[0]), false});
      const Vec3d m = cross(edge[0], edge[1]);
      double turn[2];
      if (!round || !rim_crossings(emitter_rim[0], m, turn)) continue;
      for (const double at : turn) {
        if (within(edge, m, emitter_rim[0].at(at))) add(emitter_rim[0].at(at));
      }
    }
  }
}

}  // namespace equilux
