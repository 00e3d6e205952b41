// Python's face of the kernel: checks shapes, owns the planes, lets go of the GIL.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "compare.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using Image = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;
using Floats = nb::ndarray<const float, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;
using Plane = nb::ndarray<float, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;
using Mask = nb::ndarray<const std::uint8_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;

nb::ndarray<nb::numpy, std::uint8_t> owned(std::unique_ptr<std::uint8_t[]>& data, std::initializer_list<std::size_t> shape) {
  std::uint8_t* raw = data.release();
  nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<std::uint8_t*>(p); });
  return nb::ndarray<nb::numpy, std::uint8_t>(raw, shape, owner);
}

void require(bool holds, const char* message) {
  if (!holds) throw nb::value_error(message);
}

/// Where to write a plane: the caller's memory, because NumPy asks for huge pages, without which page faults take longer than the scoring.
float* plane(const std::optional<Plane>& out, std::size_t height, std::size_t width) {
  require(!out || (out->shape(0) == height && out->shape(1) == width), "a plane must have the size of the image");
  return out ? out->data() : nullptr;
}

equilux::Side side(const Image& image, const Image& shape, double abs, double rel, const std::optional<Floats>& per_pixel,
                   const std::optional<Floats>& sigma) {
  const bool is_double = image.dtype() == nb::dtype<double>();
  require(is_double || image.dtype() == nb::dtype<float>(), "an image must be float32 or float64");
  require(image.ndim() == 3 && image.shape(2) == 3, "an image must have the shape (height, width, 3)");
  const auto alike = [&](const auto& other) { return other.shape(0) == shape.shape(0) && other.shape(1) == shape.shape(1); };
  require(alike(image), "both images must have the same size");
  require(!per_pixel || alike(*per_pixel), "per-pixel bounds must have the size of the image");
  require(!sigma || alike(*sigma), "standard deviations must have the size of the image");
  require(std::isfinite(abs) && std::isfinite(rel) && abs >= 0 && rel >= 0, "a bound must be finite and not negative");
  return {image.data(), is_double, abs, rel, per_pixel ? per_pixel->data() : nullptr, sigma ? sigma->data() : nullptr};
}

nb::dict kinds(const equilux::InvalidKinds& counts) {
  nb::dict out;
  out["nan"] = counts.nan;
  out["+inf"] = counts.plus_inf;
  out["-inf"] = counts.minus_inf;
  out["negative"] = counts.negative;
  return out;
}

nb::dict to_dict(const equilux::Result& result) {
  nb::dict out;
  out["agree"] = result.counts[0];
  out["diverge"] = result.counts[1];
  out["edge"] = result.counts[2];
  out["invalid"] = result.counts[3];
  out["invalid_a"] = kinds(result.invalid_a);
  out["invalid_b"] = kinds(result.invalid_b);
  out["scored_values"] = result.scored_values;
  out["max_abs"] = result.max_abs;
  out["max_rel"] = result.max_rel;
  out["sum"] = result.sum;
  out["sum_of_squares"] = result.sum_of_squares;
  out["p50"] = result.percentiles[0];
  out["p95"] = result.percentiles[1];
  out["p99"] = result.percentiles[2];
  out["edge_max_abs"] = result.edge_max_abs;
  out["en_max"] = result.en_max;
  out["en_infinite"] = result.en_infinite;
  out["worst_pixel"] = result.worst_pixel;
  out["farthest_pixel"] = result.farthest_pixel;
  out["first_invalid"] = result.first_invalid;
  nb::list counts;
  for (const std::uint64_t count : result.en_counts) counts.append(count);
  out["en_counts"] = counts;
  return out;
}

nb::dict compare(const Image& a, const Image& b, double abs_a, double rel_a, const std::optional<Floats>& per_pixel_a,
                 const std::optional<Floats>& sigma_a, double abs_b, double rel_b, const std::optional<Floats>& per_pixel_b,
                 const std::optional<Floats>& sigma_b, double coverage_factor, const std::optional<Mask>& edge,
                 const std::vector<double>& en_edges, const std::optional<Plane>& difference,
                 const std::optional<Plane>& normalised_error, unsigned threads) {
  equilux::Job job;
  job.a = side(a, a, abs_a, rel_a, per_pixel_a, sigma_a);
  job.b = side(b, a, abs_b, rel_b, per_pixel_b, sigma_b);
  require(std::isfinite(coverage_factor) && coverage_factor >= 0, "the coverage factor must be finite and not negative");
  require(en_edges.size() >= 2, "the histogram of E_n needs at least two edges");
  require(!edge || (edge->shape(0) == a.shape(0) && edge->shape(1) == a.shape(1)), "the edge mask must have the size of the image");
  const std::size_t height = a.shape(0), width = a.shape(1);
  job.pixels = height * width;
  require(job.pixels > 0, "an image must have at least one pixel");
  require(job.pixels <= 0xffffffffu / 3, "an image must have at most 1431655765 pixels");
  job.coverage_factor = coverage_factor;
  job.edge = edge ? edge->data() : nullptr;
  job.en_edges = en_edges;
  job.threads = threads;

  std::unique_ptr<std::uint8_t[]> classes(new std::uint8_t[job.pixels]);  // uninitialised: the kernel writes every element
  job.classes = classes.get();
  job.difference = plane(difference, height, width);
  job.normalised_error = plane(normalised_error, height, width);

  equilux::Result result;
  {
    nb::gil_scoped_release released;
    result = equilux::compare(job);
  }
  nb::dict out = to_dict(result);
  out["classes"] = owned(classes, {height, width});
  return out;
}

}  // namespace

NB_MODULE(_compare, m) {
  m.doc() = "Comparison kernel of equilux: classes, normalised error and statistics of a pair of radiance images.";
  m.def("compare", &compare, "a"_a, "b"_a, nb::kw_only(), "abs_a"_a = 0.0, "rel_a"_a = 0.0, "per_pixel_a"_a = nb::none(),
        "sigma_a"_a = nb::none(), "abs_b"_a = 0.0, "rel_b"_a = 0.0, "per_pixel_b"_a = nb::none(), "sigma_b"_a = nb::none(),
        "coverage_factor"_a = 0.0, "edge"_a = nb::none(), "en_edges"_a, "difference"_a = nb::none(),
        "normalised_error"_a = nb::none(), "threads"_a = 0u,
        "Classes, normalised error and statistics; see the typed stub.");
}
