"""Every single fault: one mutant or more per cause id, with its parameter varied, as whoever writes renderers may get it wrong.

Written from the words of the ids (docs and `equilux_scenes.causes`), not from the rules that recognise them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from equilux_scenes.case import Case
from mutation import edits, pictures
from mutation.faults import Faults
from mutation.mutant import ALL, LOCAL, RAYTRACED, Mutant


def _m(cause: str, variation: str, faults: Faults, models: tuple[str, ...] = ALL, *needs: str, **more: Any) -> Mutant:
    return Mutant(f"{cause}: {variation}" if variation else cause, (cause,), (faults,), models, needs, **more)


def _picture(*edit: Callable[[Any], Any]) -> Faults:
    return Faults(picture=edit)


def _case(*edit: Callable[[Case], Case]) -> Faults:
    return Faults(case=edit)


def _material(change: Callable[[Any], dict[str, Any]]) -> Faults:
    return _case(edits.materials(change))


def _square(case: Case) -> bool:
    return case.scene.film.width == case.scene.film.height


def _wide(case: Case) -> bool:
    return not _square(case)


def _curved(case: Case) -> bool:
    return any(obj.kind in ("sphere", "cylinder") for obj in case.scene.objects)


def _some_triangles(case: Case) -> bool:
    return bool(case.meshes)


def _terms_of_falloff(*terms: str) -> Callable[[Case], bool]:
    """Some light has all of these."""

    def has(light: Any) -> bool:
        return hasattr(light, "attenuation") and all(getattr(light.attenuation, term) > 0 for term in terms)

    return lambda case: any(has(light) for light in case.scene.lights.values())


def _two_lights(case: Case) -> bool:
    return 2 <= len(case.scene.lights) <= 11


IMAGE = (
    _m("flipped-x", "", _picture(pictures.flipped_x)),
    _m("flipped-y", "", _picture(pictures.flipped_y)),
    _m("transposed", "", _picture(pictures.transposed), suits=_square, variant="square", on_corpus=False),
    _m("shifted", "half a pixel right", Faults(film=(pictures.looks_aside(0.5, 0.0),))),
    _m("shifted", "half a pixel both ways", Faults(film=(pictures.looks_aside(0.5, 0.5),))),
    _m("shifted", "(-0.5, -0.5) px", Faults(film=(pictures.looks_aside(-0.5, -0.5),))),
    _m("shifted", "1 px down, black above", _picture(pictures.filled_by(0, 1))),
    _m("shifted", "2 px left, wrapped", _picture(pictures.wrapped_by(-2, 0))),
    _m("shifted", "(3, -1) px, resampled", Faults(film=(pictures.looks_aside(3.0, -1.0),))),
    _m("gamma-encoded", "sRGB", _picture(pictures.srgb)),
    _m("gamma-encoded", "2.2", _picture(pictures.power_law(2.2))),
    _m("gamma-encoded", "1.8", _picture(pictures.power_law(1.8))),
    _m("gamma-encoded", "Rec.709", _picture(pictures.rec709)),
    _m("gamma-encoded", "decoded, 1/2.2", _picture(pictures.power_law(1 / 2.2))),
    _m("clamped", "1", _picture(pictures.clamped_at(1.0)), LOCAL),
    _m("clamped", "0.25", _picture(pictures.clamped_at(0.25))),
    _m("quantised", "8 bits, rounded", _picture(pictures.rounded_to(8))),
    _m("quantised", "8 bits, truncated", _picture(pictures.truncated_to(8))),
    _m("quantised", "10 bits", _picture(pictures.rounded_to(10))),
    _m("quantised", "12 bits", _picture(pictures.rounded_to(12))),
    _m("quantised", "half float", _picture(pictures.half_float)),
    _m("bands-swapped", "B G R", _picture(pictures.bands((2, 1, 0)))),
    _m("bands-swapped", "G B R", _picture(pictures.bands((1, 2, 0)))),
    _m("scaled", "π", _picture(pictures.times(math.pi))),
    _m("scaled", "1/π", _picture(pictures.times(1 / math.pi))),
    _m("scaled", "4π", _picture(pictures.times(4 * math.pi))),
    _m("scaled", "683.002", _picture(pictures.times(683.002))),
    _m("scaled", "255/256", _picture(pictures.times(255 / 256))),
    _m("scaled", "1.37", _picture(pictures.times(1.37))),
    _m("fov-other-axis", "", Faults(field_of_view="horizontal"), suits=_wide),
)

GEOMETRY = (
    _m("mirrored-handedness", "with the camera", _case(edits.mirrored_with_camera)),
    _m("mirrored-handedness", "objects and lights only", _case(edits.mirrored_world)),
    _m("faceted-normals", "", _case(edits.meshes(edits.faceted)), ALL, "normals.smooth"),
    _m("smoothed-normals", "area and angle", _case(edits.meshes(edits.smoothed("area angle"))), ALL, "normals.flat"),
    _m("smoothed-normals", "area", _case(edits.meshes(edits.smoothed("area"))), ALL, "normals.flat"),
    _m("smoothed-normals", "angle", _case(edits.meshes(edits.smoothed("angle"))), ALL, "normals.flat"),
    _m("smoothed-normals", "plain mean", _case(edits.meshes(edits.smoothed("none"))), ALL, "normals.flat"),
    _m("reversed-normals", "", Faults(reversed_normals=True)),
    _m("normal-side", "as stored", Faults(side="as stored")),
    _m("normal-side", "by the interpolated normal", Faults(side="by N·V"), ALL, "normals.smooth"),
    _m("tessellated", "24 around z", _case(edits.in_triangles(24, smooth=True)), LOCAL, suits=_curved),
    _m(
        "tessellated",
        "spheres only, 32 around y",
        _case(edits.in_triangles(32, smooth=True, axis=1, kinds=("sphere",))),
        LOCAL,
        "shape.sphere",
    ),
    _m("tessellated", "16 around z, face normals", _case(edits.in_triangles(16, smooth=False)), LOCAL, suits=_curved),
    _m("vertex-lighting", "", Faults(at_vertices=True), LOCAL, "shape.mesh"),
)

HIGHLIGHT = (
    _m("diffuse-missing", "", _material(lambda m: {"diffuse": (0.0, 0.0, 0.0)}), ALL, "material.diffuse"),
    _m("diffuse-two-sided", "|N·L|", Faults(two_sided="diffuse")),
    _m("diffuse-two-sided", "N turned to the light", Faults(two_sided="normal")),
    _m("half-vector", "", Faults(other_lobe=True), ("phong", "raytraced"), "material.specular"),
    _m("exponent-clamped", "128", _material(lambda m: {"exponent": min(m.exponent, 128.0)}), ALL, "material.specular"),
    _m("exponent-clamped", "64", _material(lambda m: {"exponent": min(m.exponent, 64.0)}), ALL, "material.specular"),
    _m("exponent-clamped", "10", _material(lambda m: {"exponent": min(m.exponent, 10.0)}), ALL, "material.specular"),
    _m("exponent-scaled", "4", _material(lambda m: {"exponent": 4 * m.exponent}), ALL, "material.specular"),
    _m("exponent-scaled", "1/4", _material(lambda m: {"exponent": m.exponent / 4}), ALL, "material.specular"),
    _m("exponent-scaled", "1.1", _material(lambda m: {"exponent": 1.1 * m.exponent}), ALL, "material.specular"),
    _m("specular-floored", "0.5", Faults(floor=0.5), ALL, "material.specular"),
    _m("specular-floored", "0.2", Faults(floor=0.2), ALL, "material.specular"),
    _m("highlight-ungated", "", Faults(gated=False), ALL, "material.specular"),
    _m("highlight-cosine", "", Faults(lobe_cosine=True), ALL, "material.specular"),
    _m("highlight-tinted", "", _material(lambda m: {"specular": edits.product(m.specular, m.diffuse)}), ALL, "material.specular"),
    _m("highlight-missing", "", _material(lambda m: {"specular": (0.0, 0.0, 0.0)}), ALL, "material.specular"),
    _m("transmitted-highlight-missing", "", Faults(lobe_behind=False), RAYTRACED, "transparency", "material.specular"),
    _m("transparent-highlight-unweighted", "", Faults(lobe_weighted=False), RAYTRACED, "transparency", "material.specular"),
    _m("view-vector-from-eye", "", Faults(viewer="eye"), ("phong", "raytraced"), "camera.orthographic", variant="parallel"),
    _m(
        "view-vector-from-eye",
        "camera rays only",
        Faults(viewer="eye at the first hit"),
        ("phong", "raytraced"),
        "camera.orthographic",
        variant="parallel",
    ),
    _m("view-vector-fixed", "", Faults(viewer="axis"), LOCAL, "camera.perspective", "material.specular"),
    _m(
        "view-vector-fixed",
        "camera rays only",
        Faults(viewer="axis at the first hit"),
        ("phong", "raytraced"),
        "camera.perspective",
        "material.specular",
    ),
)

LIGHT = (
    _m("light-missing", "the first", _case(edits.without_light(0)), suits=_two_lights),
    _m("light-missing", "the last", _case(edits.without_light(-1)), suits=_two_lights),
    _m("light-missing", "the second", _case(edits.without_light(1)), suits=_two_lights),
    _m("attenuation-ignored", "", _case(edits.falloff(constant=1.0, linear=0.0, quadratic=0.0)), ALL, "light.point|light.spot"),
    _m(
        "attenuation-term-missing",
        "constant",
        _case(edits.falloff(constant=0.0)),
        suits=_terms_of_falloff("constant", "quadratic"),
    ),
    _m("attenuation-term-missing", "linear", _case(edits.falloff(linear=0.0)), suits=_terms_of_falloff("linear", "quadratic")),
    _m(
        "attenuation-term-missing",
        "quadratic",
        _case(edits.falloff(quadratic=0.0)),
        suits=_terms_of_falloff("constant", "quadratic"),
    ),
    _m("spot-ignored", "", _case(edits.lights(edits.as_point, ("spot",))), ALL, "light.spot"),
    _m(
        "spot-cone-doubled",
        "",
        _case(edits.spots_by(lambda s: {"cone_half_angle_deg": min(2 * s.cone_half_angle_deg, 180.0)})),
        ALL,
        "light.spot",
    ),
    _m(
        "spot-cone-halved",
        "",
        _case(edits.spots_by(lambda s: {"cone_half_angle_deg": s.cone_half_angle_deg / 2})),
        ALL,
        "light.spot",
    ),
    _m("spot-exponent-ignored", "", _case(edits.spots(exponent=0.0)), ALL, "light.spot-exponent"),
    _m(
        "spot-exponent-clamped",
        "128",
        _case(edits.spots_by(lambda s: {"exponent": min(s.exponent, 128.0)})),
        ALL,
        "light.spot-exponent",
    ),
    _m(
        "spot-exponent-clamped",
        "8",
        _case(edits.spots_by(lambda s: {"exponent": min(s.exponent, 8.0)})),
        ALL,
        "light.spot-exponent",
    ),
    _m("spot-cone-ignored", "always, exponent kept", _case(edits.spots(cone_half_angle_deg=180.0)), ALL, "light.spot-exponent"),
    _m(
        "spot-cone-ignored",
        "from 20°, exponent kept",
        _case(edits.spots_by(lambda s: {"cone_half_angle_deg": 180.0} if s.cone_half_angle_deg >= 20 else {})),
        ALL,
        "light.spot-exponent",
    ),
    _m(
        "spot-cone-ignored",
        "from 20°, exponent lost",
        _case(edits.lights(lambda s: edits.as_point(s) if s.cone_half_angle_deg >= 20 else s, ("spot",))),
        ALL,
        "light.spot",
    ),
    _m("light-colours-ignored", "ambient", Faults(ambient_of_lights=False), ("opengl",), "light.ambient-colour"),
    _m(
        "light-colours-ignored",
        "specular, as if 1",
        _case(edits.lights(lambda x: x.model_copy(update={"specular": (1.0, 1.0, 1.0)}))),
        ("opengl",),
        "light.specular-colour",
    ),
    _m(
        "light-colours-ignored",
        "specular, the diffuse one instead",
        _case(edits.lights(lambda x: x.model_copy(update={"specular": x.diffuse}))),
        ("opengl",),
        "light.specular-colour|light.diffuse-colour",
    ),
    _m(
        "light-colours-ignored",
        "diffuse, as if 1",
        _case(edits.lights(lambda x: x.model_copy(update={"diffuse": (1.0, 1.0, 1.0)}))),
        ("opengl",),
        "light.diffuse-colour",
    ),
    _m(
        "light-colours-ignored",
        "all three",
        _case(
            edits.lights(
                lambda x: x.model_copy(
                    update={"ambient": (0.0, 0.0, 0.0), "diffuse": (1.0, 1.0, 1.0), "specular": (1.0, 1.0, 1.0)}
                )
            )
        ),
        ("opengl",),
        "light.ambient-colour|light.diffuse-colour|light.specular-colour",
    ),
    _m(
        "ambient-missing",
        "the scene's",
        _case(lambda case: edits.with_scene(case, ambient=(0.0, 0.0, 0.0))),
        ALL,
        "material.ambient",
    ),
    _m("ambient-missing", "the materials'", _material(lambda m: {"ambient": (0.0, 0.0, 0.0)}), ALL, "material.ambient"),
    _m("ambient-tinted", "", _material(lambda m: {"ambient": edits.product(m.ambient, m.diffuse)}), ALL, "material.ambient"),
    _m("emission-missing", "", _material(lambda m: {"emission": (0.0, 0.0, 0.0)}), ALL, "material.emission"),
    _m("emission-tinted", "", _material(lambda m: {"emission": edits.product(m.emission, m.diffuse)}), ALL, "material.emission"),
)

TRANSPORT = (
    _m("occlusion-ignored", "", Faults(blockers=False), RAYTRACED, "occlusion"),
    _m("transparent-shadow-rule", "opaque", Faults(through="nothing"), RAYTRACED, "transparency", "occlusion"),
    _m("transparent-shadow-rule", "none", Faults(through="all"), RAYTRACED, "transparency", "occlusion"),
    _m("transparent-shadow-rule", "t", Faults(through="t"), RAYTRACED, "transparency", "occlusion"),
    _m("transparent-shadow-rule", "k_trans", Faults(through="k"), RAYTRACED, "transparency", "occlusion"),
    _m("transparent-shadow-rule", "once per object", Faults(through="once"), RAYTRACED, "transparency", "occlusion"),
    _m("reflection-missing", "", Faults(mirrors="none"), RAYTRACED, "reflection"),
    _m("reflection-missing", "nor total reflection", Faults(mirrors="not even total"), RAYTRACED, "reflection"),
    _m("refraction-missing", "left out", Faults(glass="opaque"), RAYTRACED, "transparency"),
    _m("refraction-missing", "left out, total reflection too", Faults(glass="opaque, total too"), RAYTRACED, "transparency"),
    _m("refraction-missing", "not bent", Faults(glass="straight"), RAYTRACED, "refraction"),
    *(
        _m(
            "recursion-cut",
            str(n),
            _case(lambda case, n=n: edits.with_scene(case, recursion_limit=min(n, case.scene.recursion_limit))),
            RAYTRACED,
            "reflection|transparency",
        )
        for n in (0, 1, 2)
    ),
    _m("weight-cut", "1/255", Faults(least_weight=1 / 255), RAYTRACED, "reflection|transparency"),
    _m("weight-cut", "0.05", Faults(least_weight=0.05), RAYTRACED, "reflection|transparency"),
    _m("weight-cut", "0.2", Faults(least_weight=0.2), RAYTRACED, "reflection|transparency"),
    _m("index-inverted", "view rays", Faults(inverted_index="view"), RAYTRACED, "refraction"),
    _m("index-inverted", "everywhere", Faults(inverted_index="all"), RAYTRACED, "refraction"),
    _m("tir-weight", "k_refl", Faults(total="k_refl"), RAYTRACED, "refraction"),
    _m("tir-weight", "(1 − t) k_refl", Faults(total="(1-t) k_refl"), RAYTRACED, "refraction"),
    _m("tir-weight", "t k_trans", Faults(total="t k_trans"), RAYTRACED, "refraction"),
    _m("tir-weight", "none", Faults(total="none"), RAYTRACED, "refraction"),
    _m("nested-media", "", Faults(nested=True), RAYTRACED, "refraction", variant="pool", on_corpus=False),
    _m("transmission-uncounted", "", Faults(count_transmitted=False), RAYTRACED, "transparency"),
    _m("shadow-bias", "0.01 m along the ray", Faults(bias_m=0.01), RAYTRACED, "occlusion"),
    _m("shadow-bias", "0.1 m along the ray", Faults(bias_m=0.1), RAYTRACED, "occlusion"),
    _m("shadow-bias", "0.02 m along N", Faults(bias_m=0.02, bias_along="normal"), RAYTRACED, "occlusion"),
    _m("transparency-weight-ignored", "both", Faults(front_weighted=False, behind_weighted=False), RAYTRACED, "transparency"),
    _m("transparency-weight-ignored", "1 − t", Faults(front_weighted=False), RAYTRACED, "transparency"),
    _m("transparency-weight-ignored", "t", Faults(behind_weighted=False), RAYTRACED, "transparency"),
    _m("background-missing", "black", _case(lambda case: edits.with_scene(case, background=(0.0, 0.0, 0.0))), ALL, "background"),
    _m("background-missing", "grey", _case(lambda case: edits.with_scene(case, background=(0.2, 0.2, 0.2))), ALL),
    _m("background-missing", "black for the eye only", Faults(background="black for the eye"), RAYTRACED, "background"),
    _m(
        "background-missing",
        "black in mirrors only",
        Faults(background="black in mirrors"),
        RAYTRACED,
        "background",
        "reflection",
    ),
)

SINGLE_FAULTS: tuple[Mutant, ...] = (*IMAGE, *GEOMETRY, *HIGHLIGHT, *LIGHT, *TRANSPORT)
