// Shapes that Embree has no geometry for, W rays at a time, in the frame in which they have radius 1: the same crossings as in
// shapes/, in float.
#pragma once

#include "lanes.h"
#include "tables.h"

namespace equilux::fast {

// Two crossings; infinite where there is none.
template <int W> struct TwoCrossings {
  Floats<W> first, second;
};

template <int W> inline Vectors<W> to_canonical(const Shape& shape, const Vectors<W>& v) {
  return {dot<W>(everywhere<W>(shape.row[0]), v), dot<W>(everywhere<W>(shape.row[1]), v), dot<W>(everywhere<W>(shape.row[2]), v)};
}

// |o + s d| ≤ 1 of o and d already projected; from the closest approach, whose distance does not cancel (shapes/interval.h).
template <int W> inline TwoCrossings<W> round_stretch(const Vectors<W>& o, const Vectors<W>& d) {
  const Floats<W> far = all_of<W>(__builtin_inff()), dd = dot<W>(d, d);
  const Mask<W> parallel = dd == 0.0f;
  const Floats<W> middle = -dot<W>(o, d) / dd;
  const Vectors<W> q = o + times<W>(d, middle);
  const Floats<W> rest = 1.0f - dot<W>(q, q);
  const Floats<W> half = root<W>((rest > 0.0f ? rest : Floats<W>{}) / dd);
  const Mask<W> inside = dot<W>(o, o) <= 1.0f, met = parallel ? inside : rest >= 0.0f;
  const Floats<W> first = parallel ? -far : middle - half, second = parallel ? far : middle + half;
  return {met ? first : far, met ? second : -far};
}

template <int W> inline TwoCrossings<W> crossings(const Shape& shape, const Vectors<W>& o, const Vectors<W>& d) {
  const Floats<W> far = all_of<W>(__builtin_inff());
  const Vectors<W> flat_o{o.x, o.y, Floats<W>{}}, flat_d{d.x, d.y, Floats<W>{}};
  switch (shape.form) {
    case ShapeForm::disc: {
      const Floats<W> t = -o.z / d.z, x = o.x + t * d.x, y = o.y + t * d.y;
      return {x * x + y * y <= 1.0f ? t : far, far};
    }
    case ShapeForm::ellipsoid: {
      const TwoCrossings<W> stretch = round_stretch<W>(o, d);
      return {stretch.first, stretch.first < stretch.second ? stretch.second : far};
    }
    case ShapeForm::cylinder_open: {
      const TwoCrossings<W> stretch = round_stretch<W>(flat_o, flat_d);
      const Mask<W> met = (stretch.first <= stretch.second) & (stretch.first > -far);
      const Mask<W> first = met & (magnitude<W>(o.z + stretch.first * d.z) <= 1.0f);
      const Mask<W> second = met & (magnitude<W>(o.z + stretch.second * d.z) <= 1.0f);
      return {first ? stretch.first : far, second ? stretch.second : far};
    }
    case ShapeForm::cylinder_capped: {
      const TwoCrossings<W> side = round_stretch<W>(flat_o, flat_d);
      const Mask<W> level = d.z == 0.0f, between = magnitude<W>(o.z) <= 1.0f;
      const Floats<W> a = (-1.0f - o.z) / d.z, b = (1.0f - o.z) / d.z;
      const Floats<W> low = level ? (between ? -far : far) : smaller<W>(a, b);
      const Floats<W> high = level ? (between ? far : -far) : larger<W>(a, b);
      const Floats<W> enter = larger<W>(side.first, low), leave = smaller<W>(side.second, high);
      return {enter <= leave ? enter : far, enter <= leave ? leave : far};
    }
  }
  return {far, far};
}

// Outward, in the frame of the scene, not unit. p: canonical.
template <int W> inline Vectors<W> round_normal(const Shape& shape, const Vectors<W>& p) {
  Vectors<W> n = p;
  if (shape.form == ShapeForm::cylinder_open) n.z = Floats<W>{};
  if (shape.form == ShapeForm::cylinder_capped) {
    const Mask<W> cap = p.z * p.z > p.x * p.x + p.y * p.y;
    n = chosen<W>(cap, {Floats<W>{}, Floats<W>{}, p.z}, {p.x, p.y, Floats<W>{}});
  }
  const auto& r = shape.row;
  return {n.x * r[0][0] + n.y * r[1][0] + n.z * r[2][0], n.x * r[0][1] + n.y * r[1][1] + n.z * r[2][1],
          n.x * r[0][2] + n.y * r[1][2] + n.z * r[2][2]};
}

// --- Embree's callbacks. Its rays are N in structures of arrays; N may be less than W where few are left. -------------

template <int W> inline Floats<W> part(const float* from, unsigned count) {
  if (count == W) return loaded<W>(from);
  Floats<W> result{};
  for (unsigned i = 0; i < count; ++i) result[i] = from[i];
  return result;
}

// The first crossing of each ray beyond tnear and before tfar, else infinite. ray: org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time,
// tfar, …, each of N floats.
template <int W> inline Floats<W> first_crossing(const Shape& shape, const float* ray, unsigned N, unsigned begin, unsigned count,
                                                 const int* valid) {
  const auto at = [&](unsigned member) { return part<W>(ray + member * N + begin, count); };
  const Vectors<W> origin{at(0), at(1), at(2)}, direction{at(4), at(5), at(6)};
  const Floats<W> near = at(3), far = at(8);
  Ints<W> taking{};
  for (unsigned i = 0; i < count; ++i) taking[i] = valid[begin + i];
  const TwoCrossings<W> both = crossings<W>(shape, to_canonical<W>(shape, origin) + everywhere<W>(shape.shift), to_canonical<W>(shape, direction));
  const Floats<W> none = all_of<W>(__builtin_inff());
  const auto ahead = [&](Floats<W> t) { return (t > near) & (t <= far) & (t < __builtin_inff()); };
  const Mask<W> first = ahead(both.first), second = ahead(both.second);
  const Floats<W> t = first ? both.first : second ? both.second : none;
  return taking != 0 ? t : none;
}

template <int W> void intersect_shapes(const RTCIntersectFunctionNArguments* args) {
  const Shape& shape = static_cast<const Shape*>(args->geometryUserPtr)[args->primID];
  float* const ray = reinterpret_cast<float*>(args->rayhit);
  const unsigned N = args->N;
  float* const hit = ray + 12 * N;  // Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID
  for (unsigned begin = 0; begin < N; begin += W) {
    const unsigned count = N - begin < W ? N - begin : W;
    const Floats<W> t = first_crossing<W>(shape, ray, N, begin, count, args->valid);
    const float* row[3] = {shape.row[0], shape.row[1], shape.row[2]};
    const auto at = [&](unsigned member) { return part<W>(ray + member * N + begin, count); };
    const Vectors<W> origin{at(0), at(1), at(2)}, direction{at(4), at(5), at(6)};
    const Floats<W> distance = t < __builtin_inff() ? t : Floats<W>{};
    const Vectors<W> p = to_canonical<W>(shape, origin + times<W>(direction, distance)) + everywhere<W>(shape.shift);
    const Vectors<W> normal = shape.form == ShapeForm::disc ? everywhere<W>(row[2]) : round_normal<W>(shape, p);
    for (unsigned i = 0; i < count; ++i) {
      if (!(t[i] < __builtin_inff())) continue;
      const unsigned k = begin + i;
      ray[8 * N + k] = t[i];
      hit[k] = normal.x[i];
      hit[N + k] = normal.y[i];
      hit[2 * N + k] = normal.z[i];
      hit[3 * N + k] = hit[4 * N + k] = 0;
      const unsigned ids[3] = {args->primID, args->geomID, RTC_INVALID_GEOMETRY_ID};
      for (unsigned m = 0; m < 3; ++m) __builtin_memcpy(hit + (5 + m) * N + k, &ids[m], 4);
    }
  }
}

template <int W> void occlude_shapes(const RTCOccludedFunctionNArguments* args) {
  const Shape& shape = static_cast<const Shape*>(args->geometryUserPtr)[args->primID];
  float* const ray = reinterpret_cast<float*>(args->ray);
  for (unsigned begin = 0; begin < args->N; begin += W) {
    const unsigned count = args->N - begin < W ? args->N - begin : W;
    const Floats<W> t = first_crossing<W>(shape, ray, args->N, begin, count, args->valid);
    for (unsigned i = 0; i < count; ++i) {
      if (t[i] < __builtin_inff()) ray[8 * args->N + begin + i] = -__builtin_inff();
    }
  }
}

}  // namespace equilux::fast
