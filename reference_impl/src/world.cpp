#include "world.h"

#include <algorithm>
#include <string>

#include "emitters.h"
#include "placement.h"

namespace equilux {

namespace {

// Lengths whose fourth power over- or underflows are refused: nothing physical is lost, and no product needs a guard.
constexpr double largest_length = 1e60, smallest_length = 1e-60;

// Below, the double-double directions of light and axis do not tell any more what is inside.
constexpr double narrowest_cone_deg = 1e-12;

// Of refraction: squares of ratios of indices need no guard. Beyond, no path keeps a digit.
constexpr double largest_index = 1e60;

void refuse(int object, const std::string& what) { throw TracerError("objects[" + std::to_string(object) + "]: " + what); }

Solid solid_of(const ObjectDescription& object) {
  switch (object.kind) {
    case ShapeKind::sphere: return Solid::sphere;
    case ShapeKind::plane: return Solid::plane;
    case ShapeKind::box: return Solid::box;
    case ShapeKind::disc: return Solid::disc;
    case ShapeKind::rectangle: return Solid::rectangle;
    case ShapeKind::cylinder: return object.capped ? Solid::cylinder_capped : Solid::cylinder_open;
    case ShapeKind::mesh: break;
  }
  return Solid::mesh;
}

void check_placement(int index, const Placement& placement) {
  double product = 1;
  for (const Vec3dd& column : placement.linear.column) {
    const double size = length(to_double(column));
    if (!(size < largest_length)) refuse(index, "its size is beyond 1e60 m");
    if (!(size > smallest_length)) refuse(index, "its size is below 1e-60 m, or its transform is singular");
    product *= size;
  }
  if (!(largest(to_double(placement.origin)) < largest_length)) refuse(index, "it is farther than 1e60 m from the eye");
  if (!(std::fabs(to_double(determinant(placement.linear))) > product * 0x1p-80)) refuse(index, "its transform is singular");
}

RayFrame<double> rounded(const RayFrame<DoubleDouble>& frame) {
  return {to_double(frame.eye), to_double(frame.right), to_double(frame.up), to_double(frame.forward)};
}

double frobenius(const Matrix3<DoubleDouble>& m) {
  double sum = 0;
  for (const Vec3dd& column : m.column) sum += to_double(dot(column, column));
  return std::sqrt(sum);
}

// N ∝ A⁻ᵀ n of the canonical n = A⁻¹ P, so that |∂N| ≤ |A⁻¹|² / |A⁻ᵀ n| ≤ σ_max / σ_min²; 1/r for a sphere that is one in the world too.
double curvature_of(Solid solid, const Matrix3<DoubleDouble>& to_world, const Matrix3<DoubleDouble>& to_canonical) {
  if (solid != Solid::sphere && solid != Solid::cylinder_capped && solid != Solid::cylinder_open) return 0;
  const double largest = frobenius(to_world), reciprocal = frobenius(to_canonical);
  // √3 r and √3 / r: their product is 3 for a similarity, and larger for everything else.
  if (largest * reciprocal < 3 * (1 + 5e-10)) return reciprocal / std::sqrt(3.0) * (1 + 1e-4);
  return largest * reciprocal * reciprocal;
}

double rounding_size_of(Solid solid, const Placement& placement, const Matrix3<DoubleDouble>& to_canonical) {
  const double size = frobenius(placement.linear), distance = length(to_double(placement.origin));
  return solid == Solid::plane ? distance : (distance + size) * size * frobenius(to_canonical) / 3;
}

}  // namespace

World::World(SceneDescription scene) : description(with_emitters(std::move(scene))), camera(description) {
  eye_size = largest(camera.eye);
  if (!(eye_size < largest_length)) throw TracerError("camera: the eye is farther than 1e60 m from the origin");
  const bool secondary = description.model == Model::raytraced || description.model == Model::reflection_equation;
  if (!description.meshes.empty()) boxes = shared_boxes(description, secondary);
  const bool ready = boxes != nullptr;
  if (!ready) boxes = std::make_shared<Boxes>(description, secondary);
  objects.resize(description.objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) place_object(static_cast<int>(i));
  prepare_lights();
  find_features();
  prepare_shadows();
  if (!ready) build_boxes();
  embree = boxes->embree;
  embree_scale = boxes->embree_scale;
  transport = boxes->transport;
}

// Without a mesh they are as quickly built as looked for.
void World::build_boxes() {
  build_embree();
  if (boxes->with_transport) build_transport_boxes();
  if (!meshes.empty()) share(boxes);
}

void World::place_object(int index) {
  const ObjectDescription& given = description.objects[static_cast<std::size_t>(index)];
  Object& object = objects[static_cast<std::size_t>(index)];
  object.solid = solid_of(given);
  object.material = given.material;
  const Placement placement = chained(canonical_to_object(given), object_to_eye(given, camera.eye));
  check_placement(index, placement);
  object.to_canonical_linear = inverse(placement.linear);
  if (object.solid == Solid::mesh) {
    place_mesh(index, placement);
    return;
  }
  const Matrix3<DoubleDouble>& back = object.to_canonical_linear;
  object.exact = {-(back * placement.origin), back * camera.right, back * camera.up, back * camera.forward};
  object.rounded = rounded(object.exact);
  object.canonical = CanonicalFrame(back, object.exact.eye);
  object.curvature = curvature_of(object.solid, placement.linear, back);
  object.rounding_size = rounding_size_of(object.solid, placement, back);
  (object.solid == Solid::plane ? unbounded : bounded).push_back(index);
}

void World::place_mesh(int index, const Placement& placement) {
  MeshObject mesh;
  mesh.object = index;
  mesh.given = description.meshes[static_cast<std::size_t>(description.objects[static_cast<std::size_t>(index)].mesh)].get();
  mesh.placement = placement;
  if (description.rules.media_counted) mesh.inside_out = wound_inwards(mesh);
  if (meshes.size() == boxes->vertices.size()) boxes->vertices.push_back(seen_by_camera(index, mesh));
  mesh.vertices = boxes->vertices[meshes.size()];
  meshes.push_back(std::move(mesh));
}

bool World::wound_inwards(const MeshObject& mesh) {
  const Vec3d middle = to_double(mesh.vertex(mesh.given->faces.front()[0]));
  double volume = 0;
  for (const auto& corner : mesh.given->faces) {
    const auto at = [&](std::size_t k) { return to_double(mesh.vertex(corner[k])) - middle; };
    volume += dot(at(0), cross(at(1), at(2)));
  }
  return volume < 0;
}

// The mesh's vertices in the camera's frame.
std::vector<CameraPoint> World::seen_by_camera(int index, const MeshObject& mesh) const {
  const Placement& placement = mesh.placement;
  std::vector<CameraPoint> vertices;
  vertices.reserve(mesh.given->vertices.size());
  // camera frame = rows (right, up, forward) · placement, folded into one matrix
  const auto folded = [&](const Vec3dd& axis) { return transposed_times(placement.linear, axis); };
  const Vec3dd row[3] = {folded(camera.right), folded(camera.up), folded(camera.forward)};
  const DoubleDouble shift[3] = {dot(camera.right, placement.origin), dot(camera.up, placement.origin),
                                 dot(camera.forward, placement.origin)};
  for (const Vec3d& given : mesh.given->vertices) {
    const Vec3dd v = exactly(given);
    const auto along = [&](int k) { return to_double(dot(row[k], v) + shift[k]); };
    vertices.push_back({along(0), along(1), along(2)});
    if (!(std::max({std::fabs(vertices.back().x), std::fabs(vertices.back().y), std::fabs(vertices.back().z)}) < largest_length)) {
      refuse(index, "a vertex is farther than 1e60 m from the eye");
    }
  }
  return vertices;
}

void World::prepare_lights() {
  for (const LightDescription& given : description.lights) {
    if (!(largest(given.position) < largest_length)) throw TracerError("lights: one is farther than 1e60 m from the origin");
    Light light;
    light.given = given;
    light.position = difference(given.position, camera.eye);
    if (given.kind != LightKind::point) {
      light.axis = direction_of(given.direction);
      light.to_light = -light.axis;
      light.axis_rounded = to_double(light.axis);
      light.to_light_rounded = to_double(light.to_light);
    }
    if (given.kind == LightKind::spot) {
      if (given.cone_half_angle_deg < narrowest_cone_deg) throw TracerError("lights: a cone is narrower than 1e-12 degrees");
      light.cone_cosine = sine_cosine_of_degrees(given.cone_half_angle_deg).cosine;
      const DoubleDouble half_sine = sine_cosine_of_degrees(DoubleDouble(given.cone_half_angle_deg) * 0.5).sine;
      light.cone_versine = half_sine * half_sine * 2.0;
      features.spot = true;
    }
    lights.push_back(light);
  }
}

// lighting_model.md §3, τ, or what a changed rule has in its place.
void World::prepare_shadows() {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const MaterialDescription& material = material_of(*this, static_cast<int>(i));
    const double t = material.transparency;
    Casts shadow;
    if (t > 0) {
      shadow.blocks = false;
      switch (description.rules.transparent_shadow) {
        case TransparentShadow::model:
          shadow.skipped = !description.attenuated_shadows;
          shadow.share = material.transmission * t;
          break;
        case TransparentShadow::opaque: shadow.blocks = true; break;
        case TransparentShadow::t_only: shadow.share = {t, t, t}; break;
        case TransparentShadow::k_only: shadow.share = material.transmission; break;
        case TransparentShadow::one_minus_t: shadow.share = {1 - t, 1 - t, 1 - t}; break;
        case TransparentShadow::once: shadow.share = material.transmission * t; break;
        case TransparentShadow::ignored: shadow.skipped = true; break;
      }
    }
    casts.push_back(shadow);
  }
}

void World::find_features() {
  bool flat = true;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const MaterialDescription& material = material_of(*this, static_cast<int>(i));
    if (!(material.ior < largest_index && material.ior > 1 / largest_index)) {
      refuse(static_cast<int>(i), "its index of refraction is beyond 1e60 or below 1e-60");
    }
    features.specular |= material.specular.any() && !lights.empty();
    features.transparency |= material.transparency > 0;
    features.reflection |= material.reflection.any() && material.transparency < 1 && description.recursion_limit > 0;
    flat &= objects[i].solid == Solid::plane || objects[i].solid == Solid::disc || objects[i].solid == Solid::rectangle;
  }
  features.occlusion = !lights.empty() && !(flat && objects.size() <= 1);
}

}  // namespace equilux
