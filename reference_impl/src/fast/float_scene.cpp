#include "float_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "../placement.h"
#include "../shapes/dispatch.h"

namespace equilux::fast {
namespace {

// Squares of scaled lengths, and products with them, must stay in float's range: 1e±38.
constexpr double farthest_scaled = 1e15, largest_strength = 1e30, smallest_strength = 1e-30;

float checked(double value, const std::string& what) {
  const double size = std::fabs(value);
  if (!(size < largest_strength) || (size > 0 && size < smallest_strength)) {
    throw TracerError("precision float: " + what + ": " + std::to_string(value) + " is beyond what single precision can hold (1e±30)");
  }
  return static_cast<float>(value);
}

void put(float* out, const Bands& bands, const std::string& what) {
  out[0] = checked(bands.r, what);
  out[1] = checked(bands.g, what);
  out[2] = checked(bands.b, what);
}

void put(float* out, const Vec3d& v) {
  out[0] = static_cast<float>(v.x);
  out[1] = static_cast<float>(v.y);
  out[2] = static_cast<float>(v.z);
}

RTCDevice device() {
  static const RTCDevice shared = rtcNewDevice(nullptr);
  if (shared == nullptr) throw TracerError("Embree could not be started");
  return shared;
}

bool runs_here(int width) {
#if defined(__x86_64__)
  if (width == 16) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512bw");
  }
  if (width == 8) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
  return width == 4;
}

const Kernels& kernels_of(int width) {
  for (const Kernels* kernels : {kernels_of_16(), kernels_of_8(), kernels_of_4()}) {
    if (kernels != nullptr && runs_here(kernels->width) && (width == 0 || width == kernels->width)) return *kernels;
  }
  throw TracerError("packets: got width " + std::to_string(width) + ", allowed 4, 8 or 16 as far as this machine has them, or 0");
}

Placement placement_of(const World& world, int index) {
  const ObjectDescription& given = world.description.objects[static_cast<std::size_t>(index)];
  return chained(canonical_to_object(given), object_to_eye(given, world.camera.eye));
}

// A sphere that is one in the world too, to what a float can tell.
bool is_round(const Placement& placement) {
  const Vec3d a = to_double(placement.linear.column[0]), b = to_double(placement.linear.column[1]), c = to_double(placement.linear.column[2]);
  const double square = dot(a, a), tolerance = 1e-9 * square;
  return std::fabs(dot(b, b) - square) < tolerance && std::fabs(dot(c, c) - square) < tolerance && std::fabs(dot(a, b)) < tolerance &&
         std::fabs(dot(b, c)) < tolerance && std::fabs(dot(a, c)) < tolerance;
}

double longest_axis(const Placement& placement) {
  double sum = 0;
  for (const Vec3dd& column : placement.linear.column) sum += length(to_double(column));
  return sum;
}

}  // namespace

void refuse_uncovered(const World& world) {
  const auto refuse = [](const char* what) { throw TracerError(std::string("precision: float packets do not cover ") + what + "; use \"exact\""); };
  if (world.description.model == Model::opengl) refuse("model opengl");
  if (world.description.model == Model::reflection_equation) refuse("model reflection-equation");
  if (world.description.rules.changed()) refuse("changed rules");
}

void refuse_crossings(int at_most) {
  throw TracerError("precision float: a shadow ray crosses more than " + std::to_string(at_most) + " transparent surfaces; use \"exact\"");
}

FloatScene::FloatScene(const World& world, int width) : world_(world), kernels_(&kernels_of(width)) {
  refuse_uncovered(world);
  const double extent = extent_of_scene();
  scale_ = extent > 0 ? std::ldexp(1.0, -std::ilogb(extent)) : 1;
  add_surfaces();
  add_lamps();
  for (const int object : world.unbounded) add_plane(object);
  add_meshes();
  add_bounded();
  if (embree_ != nullptr) {
    rtcCommitScene(embree_);
    const RTCError error = rtcGetDeviceError(device());
    if (error != RTC_ERROR_NONE) throw TracerError("Embree could not build the scene: error " + std::to_string(error));
  }
  find_features();

  const SceneDescription& scene = world.description;
  tables_.embree = embree_;
  tables_.perspective = world.camera.perspective();
  tables_.width = scene.width;
  tables_.height = scene.height;
  const double half_height = to_double(world.camera.scale) * (tables_.perspective ? 1 : scale_);
  tables_.film_step = checked(half_height / scene.height, "camera");
  tables_.geometries = geometries_.data();
  tables_.surfaces = surfaces_.data();
  tables_.surfaces_of_primitives = surfaces_of_primitives_.data();
  tables_.stored_normals = stored_normals_.data();
  tables_.corners = corners_.data();
  tables_.vertex_normals = vertex_normals_.data();
  tables_.curvatures = curvatures_.data();
  tables_.planes = planes_.data();
  tables_.plane_count = static_cast<int>(planes_.size());
  tables_.lamps = lamps_.data();
  tables_.lamp_count = static_cast<int>(lamps_.size());
  tables_.shapes = shapes_.data();
  put(tables_.background, scene.background, "background");
  tables_.recursion_limit = scene.model == Model::raytraced ? scene.recursion_limit : 0;
}

FloatScene::~FloatScene() {
  if (embree_ != nullptr) rtcReleaseScene(embree_);
}

Vec3d FloatScene::in_camera(const Vec3dd& v) const {
  const Camera& camera = world_.camera;
  return {to_double(dot(camera.right, v)), to_double(dot(camera.up, v)), to_double(dot(camera.forward, v))};
}

// The farthest coordinate of anything with bounds; of planes, where there is nothing else.
double FloatScene::extent_of_scene() const {
  double extent = 0;
  const Vec3dd axes[3] = {world_.camera.right, world_.camera.up, world_.camera.forward};
  for (const int index : world_.bounded) {
    const Placement placement = placement_of(world_, index);
    for (const Vec3dd& axis : axes) {
      const double half = half_extent(world_.objects[static_cast<std::size_t>(index)].solid, to_double(transposed_times(placement.linear, axis)));
      extent = std::max(extent, std::fabs(to_double(dot(axis, placement.origin))) + half);
    }
  }
  for (const MeshObject& mesh : world_.meshes) {
    for (const CameraPoint& v : mesh.vertices) extent = std::max({extent, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  }
  if (extent > 0) return extent;
  for (const int index : world_.unbounded) extent = std::max(extent, largest(in_camera(placement_of(world_, index).origin)));
  return extent;
}

std::uint32_t FloatScene::mask_of(int object) const {
  const Casts& casts = world_.casts[static_cast<std::size_t>(object)];
  if (casts.blocks) return mask_opaque;
  return casts.skipped ? mask_skipped : mask_transparent;
}

void FloatScene::add_surfaces() {
  const SceneDescription& scene = world_.description;
  const bool secondary = scene.model == Model::raytraced;
  for (std::size_t i = 0; i < world_.objects.size(); ++i) {
    const MaterialDescription& material = material_of(world_, static_cast<int>(i));
    const std::string what = "objects[" + std::to_string(i) + "].material";
    surfaces_.resize(surfaces_.size() + surface_stride);
    float* const row = surfaces_.data() + surfaces_.size() - surface_stride;
    const double t = secondary ? material.transparency : 0;
    put(row + column_constant, material.emission + material.ambient * scene.ambient, what);
    put(row + column_diffuse, material.diffuse, what);
    put(row + column_specular, material.specular, what);
    row[column_exponent] = static_cast<float>(material.exponent);
    put(row + column_mirrored, material.reflection * (1 - t), what);
    put(row + column_through, material.transmission * t, what);
    row[column_front] = static_cast<float>(1 - t);
    row[column_behind] = static_cast<float>(t);
    row[column_ior] = static_cast<float>(material.ior);
    put(row + column_shadow, world_.casts[i].share, what);
    row[column_curvature] = static_cast<float>(world_.objects[i].curvature / scale_);
    tables_.transparent_shadows |= mask_of(static_cast<int>(i)) == mask_transparent;
  }
}

// A point light's attenuation is divided by its largest coefficient, its strength likewise, so that neither leaves the range.
void FloatScene::add_lamps() {
  for (std::size_t i = 0; i < world_.lights.size(); ++i) {
    const Light& light = world_.lights[i];
    const std::string what = "lights[" + std::to_string(i) + "]";
    Lamp lamp;
    lamp.kind = light.given.kind == LightKind::directional ? LampKind::directional
                : light.given.kind == LightKind::spot      ? LampKind::spot
                                                           : LampKind::point;
    double divisor = 1;
    if (lamp.kind == LampKind::directional) {
      put(lamp.position, in_camera(light.to_light));
    } else {
      const Vec3d position = in_camera(light.position);
      if (!(largest(position) * scale_ < farthest_scaled)) {
        throw TracerError("precision float: " + what + ": more than 1e15 times as far from the eye as the objects");
      }
      put(lamp.position, {position.x * scale_, position.y * scale_, position.z * scale_});
      const double c = light.given.constant, l = light.given.linear / scale_, q = light.given.quadratic / (scale_ * scale_);
      divisor = std::max({c, l, q});
      lamp.constant = static_cast<float>(c / divisor);
      lamp.linear = static_cast<float>(l / divisor);
      lamp.quadratic = static_cast<float>(q / divisor);
    }
    put(lamp.strength, light.given.strength * (1 / divisor), what);
    if (lamp.kind == LampKind::spot) {
      put(lamp.axis, in_camera(light.axis));
      lamp.cone_cosine = static_cast<float>(to_double(light.cone_cosine));
      lamp.exponent = static_cast<float>(light.given.exponent);
    }
    lamps_.push_back(lamp);
  }
}

void FloatScene::add_plane(int object) {
  const Object& plane = world_.objects[static_cast<std::size_t>(object)];
  const Vec3dd normal = direction_of(transposed_times(plane.to_canonical_linear, Vec3dd{0.0, 0.0, 1.0}));
  Plane row;
  put(row.normal, in_camera(normal));
  row.level = static_cast<float>(to_double(dot(normal, placement_of(world_, object).origin)) * scale_);
  row.surface = object;
  row.mask = mask_of(object);
  planes_.push_back(row);
}

void FloatScene::attach(RTCGeometry geometry, std::uint32_t mask, const Geometry& row) {
  if (embree_ == nullptr) {
    embree_ = rtcNewScene(device());
    rtcSetSceneFlags(embree_, RTC_SCENE_FLAG_ROBUST);
  }
  rtcSetGeometryMask(geometry, mask);
  rtcCommitGeometry(geometry);
  const unsigned id = rtcAttachGeometry(embree_, geometry);
  rtcReleaseGeometry(geometry);
  geometries_.resize(std::max<std::size_t>(geometries_.size(), id + 1));
  geometries_[id] = row;
}

namespace {

// As spread.cpp has it of one point: |∂N| ≤ Σ |n_k − n_0| / (height of vertex k) / the least length of the interpolated normal.
double curvature_of_triangle(const MeshObject& mesh, const std::array<std::uint32_t, 3>& face, const std::vector<Vec3d>& normals) {
  Vec3d p[3], n[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const CameraPoint& v = mesh.vertices[face[k]];
    p[k] = {v.x, v.y, v.z};
    n[k] = normals[face[k]];
  }
  const double doubled_area = length(cross(p[1] - p[0], p[2] - p[0]));
  if (!(doubled_area > 0)) return 0;  // no ray meets it
  double sum = 0;
  for (int k = 1; k < 3; ++k) sum += length(p[3 - k] - p[0]) / doubled_area * length(n[k] - n[0]);
  const Vec3d middle = n[0] + n[1] + n[2];
  const double total = length(n[0]) + length(n[1]) + length(n[2]);
  double least = 1e300;
  for (const Vec3d& normal : n) least = std::min(least, std::fabs(dot(normal, middle)) / length(middle));
  return sum / std::max(least, 1e-3 * total);
}

}  // namespace

// --- meshes -----------------------------------------------------------------------------------------------------------

void FloatScene::add_meshes() {
  for (std::size_t i = 0; i < world_.meshes.size(); ++i) {
    if (!world_.meshes[i].given->faces.empty()) add_mesh(static_cast<int>(i));
  }
}

void FloatScene::add_mesh(int index) {
  const MeshObject& mesh = world_.meshes[static_cast<std::size_t>(index)];
  const auto& faces = mesh.given->faces;
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* const vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const CameraPoint& v = mesh.vertices[i];
    put(vertices + 3 * i, Vec3d{v.x * scale_, v.y * scale_, v.z * scale_});
  }
  auto* const corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), faces.size()));
  double longest = 0;
  const auto at = [&](std::uint32_t i) { return Vec3d{mesh.vertices[i].x, mesh.vertices[i].y, mesh.vertices[i].z}; };
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      corners[3 * i + k] = faces[i][k];
      longest = std::max(longest, largest(at(faces[i][k]) - at(faces[i][(k + 1) % 3])));
    }
  }
  surfaces_[static_cast<std::size_t>(mesh.object * surface_stride + column_reach)] = static_cast<float>(longest * scale_);

  Geometry row;
  row.surface = mesh.object;
  row.mesh = index;
  if (mesh.given->vertex_normals.empty()) {
    row.facing = Facing::stored;
    row.first = static_cast<std::int32_t>(stored_normals_.size() / 4);
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
      const Vec3d n = in_camera(direction_of(mesh.triangle(i).normal));
      stored_normals_.insert(stored_normals_.end(), {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z), 0});
    }
  } else {
    row.facing = Facing::interpolated;
    row.first = static_cast<std::int32_t>(corners_.size() / 3);
    const auto first_vertex = static_cast<std::int32_t>(vertex_normals_.size() / 4);
    for (const auto& face : faces) {
      for (const std::uint32_t corner : face) corners_.push_back(4 * (first_vertex + static_cast<std::int32_t>(corner)));
    }
    const Matrix3<DoubleDouble>& back = world_.objects[static_cast<std::size_t>(mesh.object)].to_canonical_linear;
    std::vector<Vec3d> normals;
    double size = 0;
    for (const Vec3d& given : mesh.given->vertex_normals) {
      normals.push_back(in_camera(transposed_times(back, exactly(given))));
      size = std::max(size, largest(normals.back()));
    }
    const double factor = size > 0 ? std::ldexp(1.0, -std::ilogb(size)) : 1;  // they keep their ratios
    for (const auto& face : faces) curvatures_.push_back(static_cast<float>(curvature_of_triangle(mesh, face, normals) / scale_));
    for (const Vec3d& n : normals) {
      vertex_normals_.insert(vertex_normals_.end(), {static_cast<float>(n.x * factor), static_cast<float>(n.y * factor), static_cast<float>(n.z * factor), 0});
    }
  }
  attach(geometry, mask_of(mesh.object), row);
}

// --- analytic shapes --------------------------------------------------------------------------------------------------

// One Embree geometry per kind and mask: as many as there are objects would cost more.
void FloatScene::add_bounded() {
  for (const std::uint32_t mask : {mask_opaque, mask_transparent, mask_skipped}) {
    std::vector<int> quads, spheres, shapes;
    for (const int index : world_.bounded) {
      if (mask_of(index) != mask) continue;
      const Placement placement = placement_of(world_, index);
      switch (world_.objects[static_cast<std::size_t>(index)].solid) {
        case Solid::rectangle:
        case Solid::box: quads.push_back(index); break;
        case Solid::sphere: (is_round(placement) ? spheres : shapes).push_back(index); break;
        default: shapes.push_back(index); break;
      }
      surfaces_[static_cast<std::size_t>(index * surface_stride + column_reach)] = static_cast<float>(2 * longest_axis(placement) * scale_);
    }
    add_quads(quads, mask);
    add_spheres(spheres, mask);
    add_shapes(shapes, mask);
  }
}

// Rectangles, and the six faces of boxes.
void FloatScene::add_quads(const std::vector<int>& objects, std::uint32_t mask) {
  if (objects.empty()) return;
  struct Face {
    Vec3d corner[4], normal;
    int object;
  };
  std::vector<Face> faces;
  for (const int index : objects) {
    const Placement placement = placement_of(world_, index);
    const Matrix3<DoubleDouble>& back = world_.objects[static_cast<std::size_t>(index)].to_canonical_linear;
    const bool box = world_.objects[static_cast<std::size_t>(index)].solid == Solid::box;
    // Canonical axes of the face: two along it, one out of it.
    const auto add = [&](int along, int across, int out, double side, double level) {
      Face face;
      face.object = index;
      constexpr double turn[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
      for (int k = 0; k < 4; ++k) {
        Vec3dd p = placement.origin + placement.linear.column[along] * DoubleDouble(turn[k][0]) +
                   placement.linear.column[across] * DoubleDouble(turn[k][1]);
        p = p + placement.linear.column[out] * DoubleDouble(level);
        face.corner[k] = in_camera(p);
      }
      Vec3dd n;
      (out == 0 ? n.x : out == 1 ? n.y : n.z) = DoubleDouble(side);
      face.normal = in_camera(direction_of(transposed_times(back, n)));
      faces.push_back(face);
    };
    if (!box) {
      add(0, 1, 2, 1, 0);
      continue;
    }
    for (int out = 0; out < 3; ++out) {
      add((out + 1) % 3, (out + 2) % 3, out, -1, -1);
      add((out + 1) % 3, (out + 2) % 3, out, 1, 1);
    }
  }

  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_QUAD);
  auto* const vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * faces.size()));
  auto* const corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(std::uint32_t), faces.size()));
  Geometry row;
  row.facing = Facing::stored;
  row.first = static_cast<std::int32_t>(stored_normals_.size() / 4);
  row.first_surface = static_cast<std::int32_t>(surfaces_of_primitives_.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      put(vertices + 3 * (4 * i + k), faces[i].corner[k] * scale_);
      corners[4 * i + k] = static_cast<std::uint32_t>(4 * i + k);
    }
    const Vec3d& n = faces[i].normal;
    stored_normals_.insert(stored_normals_.end(), {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z), 0});
    surfaces_of_primitives_.push_back(faces[i].object);
  }
  attach(geometry, mask, row);
}

void FloatScene::add_spheres(const std::vector<int>& objects, std::uint32_t mask) {
  if (objects.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* const spheres = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), objects.size()));
  Geometry row;
  row.facing = Facing::sphere;
  row.first_surface = static_cast<std::int32_t>(surfaces_of_primitives_.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Placement placement = placement_of(world_, objects[i]);
    put(spheres + 4 * i, in_camera(placement.origin) * scale_);
    spheres[4 * i + 3] = static_cast<float>(length(to_double(placement.linear.column[0])) * scale_);
    surfaces_of_primitives_.push_back(objects[i]);
  }
  attach(geometry, mask, row);
}

static void bounds_of_shape(const RTCBoundsFunctionArguments* args) {
  const Shape& shape = static_cast<const Shape*>(args->geometryUserPtr)[args->primID];
  args->bounds_o->lower_x = shape.lower[0];
  args->bounds_o->lower_y = shape.lower[1];
  args->bounds_o->lower_z = shape.lower[2];
  args->bounds_o->upper_x = shape.upper[0];
  args->bounds_o->upper_y = shape.upper[1];
  args->bounds_o->upper_z = shape.upper[2];
}

void FloatScene::add_shapes(const std::vector<int>& objects, std::uint32_t mask) {
  if (objects.empty()) return;
  shapes_.reserve(world_.bounded.size());  // Embree keeps a pointer
  Geometry row;
  row.facing = Facing::round;
  row.first = static_cast<std::int32_t>(shapes_.size());
  row.first_surface = static_cast<std::int32_t>(surfaces_of_primitives_.size());
  const Vec3dd axes[3] = {world_.camera.right, world_.camera.up, world_.camera.forward};
  for (const int index : objects) {
    const Object& object = world_.objects[static_cast<std::size_t>(index)];
    const Placement placement = placement_of(world_, index);
    Shape shape;
    shape.form = object.solid == Solid::disc              ? ShapeForm::disc
                 : object.solid == Solid::sphere          ? ShapeForm::ellipsoid
                 : object.solid == Solid::cylinder_capped ? ShapeForm::cylinder_capped
                                                          : ShapeForm::cylinder_open;
    const RayFrame<double>& frame = object.rounded;
    const Vec3d right = frame.right * (1 / scale_), up = frame.up * (1 / scale_), forward = frame.forward * (1 / scale_);
    put(shape.row[0], {right.x, up.x, forward.x});
    put(shape.row[1], {right.y, up.y, forward.y});
    put(shape.row[2], {right.z, up.z, forward.z});
    put(shape.shift, frame.eye);
    for (int k = 0; k < 3; ++k) {
      const double centre = to_double(dot(axes[k], placement.origin)) * scale_;
      const double half = half_extent(object.solid, to_double(transposed_times(placement.linear, axes[k]))) * scale_;
      const double padding = 0x1p-19 * (std::fabs(centre) + half);
      shape.lower[k] = static_cast<float>(centre - half - padding);
      shape.upper[k] = static_cast<float>(centre + half + padding);
    }
    shapes_.push_back(shape);
    surfaces_of_primitives_.push_back(index);
  }
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(objects.size()));
  rtcSetGeometryUserData(geometry, shapes_.data() + row.first);
  rtcSetGeometryBoundsFunction(geometry, bounds_of_shape, nullptr);
  rtcSetGeometryIntersectFunction(geometry, kernels_->intersect_shapes);
  rtcSetGeometryOccludedFunction(geometry, kernels_->occlude_shapes);
  attach(geometry, mask, row);
}

// --- what the kernel is chosen by -------------------------------------------------------------------------------------

void FloatScene::find_features() {
  const bool raytraced = world_.description.model == Model::raytraced;
  features_.specular = world_.features.specular;
  features_.shadows = raytraced && world_.features.occlusion;
  features_.secondary = raytraced && (world_.features.reflection || world_.features.transparency);
  const bool plain = lamps_.size() == 1 && lamps_[0].kind == LampKind::point && lamps_[0].constant == 0 && lamps_[0].linear == 0;
  features_.lamps = !plain;
  features_.meshes = !world_.meshes.empty();
  features_.planes = !world_.unbounded.empty();
}

}  // namespace equilux::fast
