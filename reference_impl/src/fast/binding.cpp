#include "binding.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

#include <optional>

#include "float_mode.h"

namespace nb = nanobind;

namespace equilux::fast {
namespace {

template <class T> using Array = nb::ndarray<T, nb::numpy, nb::c_contig, nb::device::cpu>;

void (*finish_picture)(bool complete) = nullptr;

bool signal_pending() {
  const nb::gil_scoped_acquire gil;
  return PyErr_CheckSignals() != 0;
}

template <class T> T* data_of(const FloatMode& mode, const Array<T>& array, const char* name) {
  if (array.size() != 3 * mode.pixels()) throw TracerError(std::string(name) + ": array of the wrong size");
  return array.data();
}

// float: by packets throughout; double: refined.
template <class T>
void render(const FloatMode& mode, const Array<T>& radiance, const std::optional<Array<T>>& rounding, int threads, const Cancel* cancel) {
  T* const out = data_of(mode, radiance, "radiance");
  T* const bound = rounding ? data_of(mode, *rounding, "rounding") : nullptr;
  bool complete;
  {
    const nb::gil_scoped_release release;
    if constexpr (sizeof(T) == sizeof(float)) {
      complete = mode.render(out, bound, threads, cancel, signal_pending);
    } else {
      complete = mode.refine(out, bound, threads, cancel, signal_pending);
    }
  }
  finish_picture(complete);
}

nb::tuple traverse(const FloatMode& mode, int threads) {
  TraversalTime time;
  {
    const nb::gil_scoped_release release;
    time = mode.traverse(threads);
  }
  return nb::make_tuple(time.eye_rays, time.shadow_rays, time.seconds);
}

}  // namespace

void bind_float_mode(nb::module_& m, void (*finish)(bool complete)) {
  finish_picture = finish;
  nb::class_<FloatMode>(m, "FloatMode", "A world in single precision, for packets of rays.")
      .def(
          "__init__",
          [](FloatMode* self, const World& world, int width) {
            const nb::gil_scoped_release release;
            new (self) FloatMode(world, width);
          },
          nb::arg("world"), nb::arg("width") = 0, nb::keep_alive<1, 2>())
      .def_prop_ro("width", &FloatMode::width)
      .def_prop_ro("displacement_px", &FloatMode::displacement_px)
      .def("render", &render<float>, nb::kw_only(), nb::arg("radiance"), nb::arg("rounding").none(), nb::arg("threads"),
           nb::arg("cancel").none())
      .def("refine", &render<double>, nb::kw_only(), nb::arg("radiance"), nb::arg("rounding").none(), nb::arg("threads"),
           nb::arg("cancel").none())
      .def("traverse", &traverse, nb::kw_only(), nb::arg("threads"));
}

}  // namespace equilux::fast
