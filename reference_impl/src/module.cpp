// The Python module equilux_tracer._tracer: a builder for the scene description, the world, and rendering into NumPy arrays.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <optional>

#include "embree_shim.h"
#include "fast/binding.h"
#include "kernel.h"
#include "packets/render_packets.h"
#include "rules_binding.h"
#include "sensitivity.h"

namespace nb = nanobind;

namespace equilux {
namespace {

struct Cancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

using Triple = std::array<double, 3>;
using Doubles = nb::ndarray<double, nb::numpy, nb::c_contig, nb::device::cpu>;
using ConstDoubles = nb::ndarray<const double, nb::numpy, nb::c_contig, nb::device::cpu>;
using ConstInts = nb::ndarray<const std::int64_t, nb::numpy, nb::c_contig, nb::device::cpu>;

Vec3d vec(const Triple& t) { return {t[0], t[1], t[2]}; }
Bands bands(const Triple& t) { return {t[0], t[1], t[2]}; }

std::vector<Vec3d> points(const ConstDoubles& array, const char* what) {
  if (array.ndim() != 2 || array.shape(1) != 3) throw TracerError(std::string(what) + ": expected shape (n, 3)");
  std::vector<Vec3d> result(array.shape(0));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double* row = array.data() + 3 * i;
    result[i] = {row[0], row[1], row[2]};
    if (!std::isfinite(row[0] + row[1] + row[2])) throw TracerError(std::string(what) + ": not finite");
  }
  return result;
}

void fill_mesh(MeshDescription& mesh, const ConstDoubles& vertices, const ConstInts& faces,
               const std::optional<ConstDoubles>& vertex_normals) {
  mesh.vertices = points(vertices, "mesh vertices");
  if (vertex_normals) mesh.vertex_normals = points(*vertex_normals, "mesh vertex normals");
  if (vertex_normals && mesh.vertex_normals.size() != mesh.vertices.size()) {
    throw TracerError("mesh vertex normals: expected one per vertex");
  }
  if (faces.ndim() != 2 || faces.shape(1) != 3) throw TracerError("mesh faces: expected shape (m, 3)");
  mesh.faces.resize(faces.shape(0));
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t index = faces.data()[3 * i + k];
      if (index < 0 || static_cast<std::size_t>(index) >= mesh.vertices.size()) {
        throw TracerError("mesh face " + std::to_string(i) + ": vertex " + std::to_string(index) + " does not exist");
      }
      mesh.faces[i][k] = static_cast<std::uint32_t>(index);
    }
  }
}

int add_mesh(SceneDescription& scene, std::shared_ptr<MeshDescription> mesh) {
  scene.meshes.push_back(std::move(mesh));
  return static_cast<int>(scene.meshes.size()) - 1;
}

void add_object(SceneDescription& scene, ShapeKind kind, int material, const std::array<double, 16>& matrix, const Triple& a,
                const Triple& b, const Triple& c, double radius, bool capped, int mesh) {
  if (material < 0 || static_cast<std::size_t>(material) >= scene.materials.size()) throw TracerError("object: no such material");
  if (kind == ShapeKind::mesh && (mesh < 0 || static_cast<std::size_t>(mesh) >= scene.meshes.size())) {
    throw TracerError("object: no such mesh");
  }
  scene.objects.push_back({kind, material, matrix, vec(a), vec(b), vec(c), radius, capped, mesh});
}

// KeyboardInterrupt and other signals, asked for on the calling thread with the GIL taken for a moment.
bool python_signal_pending() {
  const nb::gil_scoped_acquire gil;
  return PyErr_CheckSignals() != 0;
}

Samples samples_of(const World& world, const std::optional<ConstDoubles>& film_xy) {
  Samples samples;
  samples.film_width = world.description.width;
  if (!film_xy) {
    samples.count = static_cast<std::size_t>(world.description.width) * static_cast<std::size_t>(world.description.height);
    return samples;
  }
  if (film_xy->ndim() != 2 || film_xy->shape(1) != 2) throw TracerError("film_xy: expected shape (n, 2)");
  samples.film_xy = film_xy->data();
  samples.count = film_xy->shape(0);
  if (!std::all_of(samples.film_xy, samples.film_xy + 2 * samples.count, [](double v) { return std::fabs(v) < 1e30; })) {
    throw TracerError("film_xy: a position is not finite, or beyond 1e30 pixels");
  }
  return samples;
}

// The data of a requested channel, if its array has the size that the samples need.
template <class T> T* output(nb::dict& arrays, const char* name, std::size_t size) {
  if (!arrays.contains(name)) return nullptr;
  auto array = nb::cast<nb::ndarray<T, nb::numpy, nb::c_contig, nb::device::cpu>>(arrays[name]);
  if (array.size() != size) throw TracerError(std::string(name) + ": array of the wrong size");
  return array.data();
}

void finish(bool complete) {
  if (complete) return;
  if (PyErr_Occurred() != nullptr) throw nb::python_error();
  throw Cancelled("cancelled");
}

void trace(const World& world, const std::optional<ConstDoubles>& film_xy, nb::dict arrays, int threads, const Cancel* cancel) {
  const Samples samples = samples_of(world, film_xy);
  const std::size_t n = samples.count, lights = world.light_count();
  Outputs out;
  out.radiance = output<double>(arrays, "radiance", 3 * n);
  out.emission = output<double>(arrays, "emission", 3 * n);
  out.ambient = output<double>(arrays, "ambient", 3 * n);
  out.light_ambient = output<double>(arrays, "light_ambient", 3 * n * lights);
  out.diffuse = output<double>(arrays, "diffuse", 3 * n * lights);
  out.specular = output<double>(arrays, "specular", 3 * n * lights);
  out.reflected = output<double>(arrays, "reflected", 3 * n);
  out.transmitted = output<double>(arrays, "transmitted", 3 * n);
  out.rounding = output<double>(arrays, "rounding", 3 * n);
  out.quadrature = output<double>(arrays, "quadrature", 3 * n);
  out.object_id = output<std::int32_t>(arrays, "object_id", n);
  out.depth = output<double>(arrays, "depth", n);
  out.normal = output<double>(arrays, "normal", 3 * n);
  out.position = output<double>(arrays, "position", 3 * n);
  out.signature = output<std::uint64_t>(arrays, "signature", n);
  bool complete;
  {
    const nb::gil_scoped_release release;
    complete = render(world, samples, out, threads, cancel, python_signal_pending);
  }
  finish(complete);
}

std::vector<double> per_object(const ConstDoubles& array, std::size_t objects, const char* what) {
  const auto usable = [](double v) { return v >= 0 && std::isfinite(v); };
  if (array.size() != objects) throw TracerError(std::string(what) + ": expected one number per object");
  if (!std::all_of(array.data(), array.data() + objects, usable)) throw TracerError(std::string(what) + ": negative or not finite");
  return {array.data(), array.data() + objects};
}

void trace_sensitivity(const World& world, const std::optional<ConstDoubles>& film_xy, const ConstDoubles& normal,
                       const ConstDoubles& position_m, Doubles result, int threads, const Cancel* cancel) {
  const Samples samples = samples_of(world, film_xy);
  const std::size_t objects = static_cast<std::size_t>(world.first_emitter());
  const GeometricBounds bounds{per_object(normal, objects, "normal"), per_object(position_m, objects, "position_m")};
  if (result.size() != 3 * samples.count) throw TracerError("result: array of the wrong size");
  bool complete;
  {
    const nb::gil_scoped_release release;
    complete = sensitivity(world, samples, bounds, result.data(), threads, cancel, python_signal_pending);
  }
  finish(complete);
}

// --- the module -------------------------------------------------------------------------------------------------------

void bind_kinds(nb::module_& m) {
  nb::enum_<Projection>(m, "Projection").value("perspective", Projection::perspective).value("orthographic", Projection::orthographic);
  nb::enum_<LightKind>(m, "LightKind")
      .value("point", LightKind::point)
      .value("directional", LightKind::directional)
      .value("spot", LightKind::spot);
  nb::enum_<Model>(m, "Model")
      .value("phong", Model::phong)
      .value("opengl", Model::opengl)
      .value("raytraced", Model::raytraced)
      .value("reflection_equation", Model::reflection_equation);
  nb::enum_<EmitterKind>(m, "EmitterKind")
      .value("sphere", EmitterKind::sphere)
      .value("disc", EmitterKind::disc)
      .value("rectangle", EmitterKind::rectangle);
  nb::enum_<Brdf>(m, "Brdf")
      .value("lambert", Brdf::lambert)
      .value("phong_classic", Brdf::phong_classic)
      .value("phong_cosine", Brdf::phong_cosine);
  nb::enum_<ShapeKind>(m, "ShapeKind")
      .value("sphere", ShapeKind::sphere)
      .value("plane", ShapeKind::plane)
      .value("box", ShapeKind::box)
      .value("disc", ShapeKind::disc)
      .value("rectangle", ShapeKind::rectangle)
      .value("cylinder", ShapeKind::cylinder)
      .value("mesh", ShapeKind::mesh);
}

void bind_description(nb::module_& m) {
  nb::class_<MeshDescription>(m, "Mesh", "Triangles in object coordinates; any number of descriptions may hold them.")
      .def(
          "__init__",
          [](MeshDescription* self, const ConstDoubles& vertices, const ConstInts& faces, const std::optional<ConstDoubles>& vertex_normals) {
            MeshDescription mesh;
            fill_mesh(mesh, vertices, faces, vertex_normals);
            new (self) MeshDescription(std::move(mesh));
          },
          nb::kw_only(), nb::arg("vertices"), nb::arg("faces"), nb::arg("vertex_normals").none());

  nb::class_<SceneDescription>(m, "SceneDescription", "The scene as plain numbers, world coordinates, SI units.")
      .def(nb::init<>())
      .def(
          "set_model",
          [](SceneDescription& scene, Model model, int recursion_limit, bool attenuated_shadows, bool infinite_viewer) {
            scene.model = model;
            scene.recursion_limit = recursion_limit;
            scene.attenuated_shadows = attenuated_shadows;
            scene.infinite_viewer = infinite_viewer;
          },
          nb::kw_only(), nb::arg("model"), nb::arg("recursion_limit"), nb::arg("attenuated_shadows"), nb::arg("infinite_viewer"))
      .def(
          "set_camera",
          [](SceneDescription& scene, Projection projection, const Triple& eye, const Triple& target, const Triple& up,
             double fov_y_deg, double height_m) {
            scene.camera = {projection, vec(eye), vec(target), vec(up), fov_y_deg, height_m};
          },
          nb::kw_only(), nb::arg("projection"), nb::arg("eye"), nb::arg("target"), nb::arg("up"), nb::arg("fov_y_deg") = 0.0,
          nb::arg("height_m") = 0.0)
      .def(
          "set_error_target",
          [](SceneDescription& scene, double error_target) {
            if (!(error_target > 0 && error_target < 1)) throw TracerError("error_target: allowed a number in the open interval (0, 1)");
            scene.error_target = error_target;
          },
          nb::arg("error_target"))
      .def("set_rules", [](SceneDescription& scene, const nb::kwargs& fields) { set_rules(scene.rules, fields); })
      .def(
          "set_film",
          [](SceneDescription& scene, int width, int height) {
            if (width < 1 || height < 1) throw TracerError("film: width and height must be at least 1");
            scene.width = width;
            scene.height = height;
          },
          nb::arg("width"), nb::arg("height"))
      .def(
          "set_surroundings",
          [](SceneDescription& scene, const Triple& ambient, const Triple& background, bool has_environment) {
            scene.ambient = bands(ambient);
            scene.background = bands(background);
            scene.has_environment = has_environment;
          },
          nb::kw_only(), nb::arg("ambient"), nb::arg("background"), nb::arg("has_environment") = false)
      .def(
          "add_light",
          [](SceneDescription& scene, LightKind kind, const Triple& strength, const Triple& position, const Triple& direction,
             const Triple& attenuation, double cone_half_angle_deg, double exponent, const Triple& ambient, const Triple& diffuse,
             const Triple& specular) {
            scene.lights.push_back({kind, vec(position), vec(direction), bands(strength), attenuation[0], attenuation[1],
                                    attenuation[2], cone_half_angle_deg, exponent, bands(ambient), bands(diffuse), bands(specular)});
          },
          nb::kw_only(), nb::arg("kind"), nb::arg("strength"), nb::arg("position") = Triple{}, nb::arg("direction") = Triple{},
          nb::arg("attenuation") = Triple{0, 0, 1}, nb::arg("cone_half_angle_deg") = 90.0, nb::arg("exponent") = 0.0, nb::arg("ambient") = Triple{0, 0, 0},
          nb::arg("diffuse") = Triple{1, 1, 1}, nb::arg("specular") = Triple{1, 1, 1})
      .def(
          "add_emitter",
          [](SceneDescription& scene, EmitterKind kind, const Triple& radiance, const Triple& a, const Triple& b, const Triple& c,
             double radius) { scene.emitters.push_back({kind, vec(a), vec(b), vec(c), radius, bands(radiance)}); },
          nb::kw_only(), nb::arg("kind"), nb::arg("radiance"), nb::arg("a"), nb::arg("b") = Triple{}, nb::arg("c") = Triple{},
          nb::arg("radius") = 0.0)
      .def(
          "add_material",
          [](SceneDescription& scene, const Triple& diffuse, const Triple& specular, double exponent, const Triple& ambient,
             const Triple& emission, const Triple& reflection, const Triple& transmission, double transparency, double ior, Brdf brdf) {
            scene.materials.push_back({bands(diffuse), bands(specular), exponent, bands(ambient), bands(emission), bands(reflection),
                                       bands(transmission), transparency, ior, brdf});
            return static_cast<int>(scene.materials.size()) - 1;
          },
          nb::kw_only(), nb::arg("diffuse"), nb::arg("specular"), nb::arg("exponent"), nb::arg("ambient"), nb::arg("emission"),
          nb::arg("reflection") = Triple{}, nb::arg("transmission") = Triple{}, nb::arg("transparency") = 0.0, nb::arg("ior") = 1.0,
          nb::arg("brdf") = Brdf::phong_classic)
      .def("add_mesh", &add_mesh, nb::arg("mesh"))
      .def("add_object", &add_object, nb::kw_only(), nb::arg("kind"), nb::arg("material"), nb::arg("matrix"),
           nb::arg("a") = Triple{}, nb::arg("b") = Triple{}, nb::arg("c") = Triple{}, nb::arg("radius") = 0.0,
           nb::arg("capped") = true, nb::arg("mesh") = -1);
}

void bind_world(nb::module_& m) {
  nb::class_<Cancel>(m, "Cancel", "Stops a render from another thread: pass it as `cancel`, then call `cancel()`.")
      .def(nb::init<>())
      .def("cancel", &Cancel::cancel, "Ask to stop; the render raises Cancelled soon after.")
      .def_prop_ro("cancelled", &Cancel::cancelled);

  nb::class_<World>(m, "World", "A scene prepared for tracing; read-only, any number of threads may trace it.")
      .def(
          "__init__",
          [](World* self, const SceneDescription& scene) {
            const nb::gil_scoped_release release;
            new (self) World(scene);
          },
          nb::arg("scene"))
      .def("trace", &trace, nb::kw_only(), nb::arg("film_xy").none(), nb::arg("arrays"), nb::arg("threads"), nb::arg("cancel").none())
      .def("sensitivity", &trace_sensitivity, nb::kw_only(), nb::arg("film_xy").none(), nb::arg("normal"), nb::arg("position_m"),
           nb::arg("result"), nb::arg("threads"), nb::arg("cancel").none());
}

}  // namespace
}  // namespace equilux

NB_MODULE(_tracer, m) {
  using namespace equilux;
  m.doc() = "The exact tracer of equilux: Embree finds candidates, double and double-double decide and shade.";
  m.attr("embree_version") = RTC_VERSION_STRING;
  m.def("limit_packets", &packets::limit_lanes, nb::arg("lanes"));
  nb::exception<TracerError>(m, "TracerError", PyExc_ValueError);
  nb::exception<Cancelled>(m, "Cancelled", PyExc_RuntimeError);
  bind_kinds(m);
  bind_description(m);
  bind_world(m);
  fast::bind_float_mode(m, finish);
}
