#include "rules_binding.h"

#include <nanobind/stl/string.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "scene_description.h"

namespace nb = nanobind;

namespace equilux {
namespace {

template <class Kind> using Names = std::array<std::pair<const char*, Kind>, 10>;  // shorter lists end in null

constexpr Names<NormalSide> normal_sides{{{"model", NormalSide::model}, {"as-given", NormalSide::as_given}, {"facing-viewer", NormalSide::facing_viewer}}};
constexpr Names<Viewer> viewers{{{"model", Viewer::model},
                                 {"from-eye", Viewer::from_eye},
                                 {"fixed", Viewer::fixed},
                                 {"from-eye-first", Viewer::from_eye_first},
                                 {"fixed-first", Viewer::fixed_first}}};
constexpr Names<TransparentShadow> transparent_shadows{{{"model", TransparentShadow::model},
                                                        {"opaque", TransparentShadow::opaque},
                                                        {"t-only", TransparentShadow::t_only},
                                                        {"k-only", TransparentShadow::k_only},
                                                        {"one-minus-t", TransparentShadow::one_minus_t},
                                                        {"once", TransparentShadow::once},
                                                        {"ignored", TransparentShadow::ignored}}};
constexpr Names<ShadowBias> shadow_biases{{{"along-ray", ShadowBias::along_ray},
                                           {"along-normal", ShadowBias::along_normal},
                                           {"along-lit-normal", ShadowBias::along_lit_normal},
                                           {"along-lit-face", ShadowBias::along_lit_face},
                                           {"not-aimed", ShadowBias::not_aimed},
                                           {"before-light", ShadowBias::before_light},
                                           {"both-ends", ShadowBias::both_ends}}};
constexpr Names<TotalReflection> total_reflections{{{"one", TotalReflection::one},
                                                    {"mirror", TotalReflection::mirror},
                                                    {"transmitted", TotalReflection::transmitted},
                                                    {"none", TotalReflection::none},
                                                    {"k-refl", TotalReflection::k_refl},
                                                    {"one-minus-t", TotalReflection::one_minus_t},
                                                    {"through", TotalReflection::through},
                                                    {"k-trans", TotalReflection::k_trans},
                                                    {"t", TotalReflection::t},
                                                    {"mirror-and-t", TotalReflection::mirror_and_t}}};
constexpr Names<TransmittedRay> transmitted_rays{{{"model", TransmittedRay::model},
                                                  {"none", TransmittedRay::none},
                                                  {"straight", TransmittedRay::straight},
                                                  {"inverted", TransmittedRay::inverted},
                                                  {"entering", TransmittedRay::entering}}};

class Fields {
 public:
  explicit Fields(const nb::kwargs& given) : given_(given) {}

  void read(const char* name, bool& field) { field = nb::cast<bool>(at(name)); }
  void read(const char* name, double& field) {
    const double value = nb::cast<double>(at(name));
    if (!(value >= 0 && std::isfinite(value))) refuse(name, std::to_string(value), "a finite number ≥ 0");
    field = value;
  }
  template <class Kind> void read(const char* name, Kind& field, const Names<Kind>& names) {
    const std::string got = nb::cast<std::string>(at(name));
    std::string allowed;
    for (const auto& [allowed_name, kind] : names) {
      if (allowed_name == nullptr) break;
      if (got == allowed_name) {
        field = kind;
        return;
      }
      allowed += (allowed.empty() ? "" : ", ") + std::string(allowed_name);
    }
    refuse(name, got, allowed);
  }
  void finish() const {
    if (given_.size() != read_) throw TracerError("rules: got " + std::to_string(given_.size()) + " fields, allowed " + std::to_string(read_));
  }

 private:
  nb::handle at(const char* name) {
    ++read_;
    if (!given_.contains(name)) throw TracerError(std::string("rules: ") + name + " is missing");
    return given_[name];
  }
  [[noreturn]] static void refuse(const char* name, const std::string& got, const std::string& allowed) {
    throw TracerError(std::string("rules: ") + name + ": got " + got + ", allowed " + allowed);
  }

  const nb::kwargs& given_;
  std::size_t read_ = 0;
};

}  // namespace

void set_rules(Rules& rules, const nb::kwargs& given) {
  Fields fields(given);
  fields.read("normal_side", rules.normal_side, normal_sides);
  fields.read("normals_reversed", rules.normals_reversed);
  fields.read("half_vector", rules.half_vector);
  fields.read("diffuse_two_sided", rules.diffuse_two_sided);
  fields.read("two_sided_behind", rules.two_sided_behind);
  fields.read("highlight_two_sided", rules.highlight_two_sided);
  fields.read("highlight_ungated", rules.highlight_ungated);
  fields.read("highlight_cosine", rules.highlight_cosine);
  fields.read("cosine_behind", rules.cosine_behind);
  fields.read("specular_floor", rules.specular_floor);
  fields.read("transmitted_highlight", rules.transmitted_highlight);
  fields.read("highlight_weighted", rules.highlight_weighted);
  fields.read("viewer", rules.viewer, viewers);
  fields.read("occlusion", rules.occlusion);
  fields.read("transparent_shadow", rules.transparent_shadow, transparent_shadows);
  fields.read("shadow_bias_m", rules.shadow_bias_m);
  fields.read("shadow_bias", rules.shadow_bias, shadow_biases);
  fields.read("weight_cut", rules.weight_cut);
  fields.read("weight_cut_alone", rules.weight_cut_alone);
  fields.read("total_reflection", rules.total_reflection, total_reflections);
  fields.read("transmitted_ray", rules.transmitted_ray, transmitted_rays);
  fields.read("always_entering", rules.always_entering);
  fields.read("nested_media", rules.nested_media);
  fields.read("media_counted", rules.media_counted);
  fields.read("transmission_counted", rules.transmission_counted);
  fields.read("front_weighted", rules.front_weighted);
  fields.read("behind_weighted", rules.behind_weighted);
  fields.read("opaque_behind", rules.opaque_behind);
  fields.read("vertex_lighting", rules.vertex_lighting);
  fields.finish();
}

}  // namespace equilux
