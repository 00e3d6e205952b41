// What the tracer does otherwise than the lighting model says. What each field means: equilux_tracer/shading_rules.py.
//
// Kernels that know these rules are compiled beside the model's own, which have no code for them.
#pragma once

namespace equilux {

enum class NormalSide { model, as_given, facing_viewer };
enum class Viewer { model, from_eye, fixed, from_eye_first, fixed_first };
enum class TransparentShadow { model, opaque, t_only, k_only, one_minus_t, once, ignored };
enum class ShadowBias { along_ray, along_normal, along_lit_normal, along_lit_face, not_aimed, before_light, both_ends };
enum class TotalReflection { one, mirror, transmitted, none, k_refl, one_minus_t, through, k_trans, t, mirror_and_t };
enum class TransmittedRay { model, none, straight, inverted, entering };

struct Rules {
  NormalSide normal_side = NormalSide::model;
  bool normals_reversed = false;
  bool half_vector = false;
  bool diffuse_two_sided = false;
  bool two_sided_behind = true;
  bool highlight_two_sided = false;
  bool highlight_ungated = false;
  bool highlight_cosine = false;
  bool cosine_behind = true;
  double specular_floor = 0;
  bool transmitted_highlight = true;
  bool highlight_weighted = true;
  Viewer viewer = Viewer::model;
  bool occlusion = true;
  TransparentShadow transparent_shadow = TransparentShadow::model;
  double shadow_bias_m = 0;
  ShadowBias shadow_bias = ShadowBias::along_ray;
  double weight_cut = 0;
  bool weight_cut_alone = false;
  TotalReflection total_reflection = TotalReflection::one;
  TransmittedRay transmitted_ray = TransmittedRay::model;
  bool always_entering = false;
  bool nested_media = false;
  bool media_counted = false;
  bool transmission_counted = true;
  bool front_weighted = true;
  bool behind_weighted = true;
  bool opaque_behind = false;
  bool vertex_lighting = false;

  bool operator==(const Rules&) const = default;
  bool changed() const { return !(*this == Rules{}); }
};

// Of all secondary rays of a path, where transmitted ones do not count.
constexpr int most_uncounted = 256;

}  // namespace equilux
