"""What the translator writes for ray tracing, the fixed-function model and the reflection equation: only what the scene needs."""

from __future__ import annotations

import re

import numpy as np
import pytest

from equilux.adapter import Unsupported
from equilux_adapters.povray import ADAPTER
from equilux_adapters.povray.facts import _as_normal
from support.povray import case_of_text

SCENE = """
equilux: 1
name: scene
model: raytraced
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 40}
film: {width: 40, height: 30}
recursion_limit: LIMIT
lights:
  sun: {kind: directional, direction: [0, 0, -2], irradiance: 1}
materials:
  matt: {diffuse: 0.5}
  mirror: {reflection: 0.5}
  pane: {transparency: 0.5, transmission: 1}
  glass: {transparency: 1, transmission: 1, ior: 1.5}
objects:
OBJECTS
"""
FLOOR = "{kind: plane, point: [0, -1, 0], normal: [0, 1, 0], material: matt}"
BALL = "{kind: sphere, center: [0, 0, 0], radius: 0.5, material: MATERIAL}"
CUBE = "{kind: mesh, material: glass, vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces: FACES}"
OUTWARD, INWARD = "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]", "[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]"


def written(*objects: str, limit: int = 8, more: str = "") -> str:
    text = SCENE.replace("LIMIT", str(limit)).replace("OBJECTS", "\n".join(f"  - {obj}" for obj in objects)) + more
    return ADAPTER.translate(case_of_text(text), ADAPTER.Knobs()).files["scene.pov"].decode()


def ball(material: str) -> str:
    return BALL.replace("MATERIAL", material)


def test_shadows_need_no_statement_and_a_light_at_infinity_a_far_location():
    text = written(FLOOR, ball("matt"))
    assert "no_shadow" not in text
    assert "light_source { <0, 0, 10000000>" in text
    for statement in ("reflection", "interior", "max_trace_level", "adc_bailout", "rgbf"):
        assert statement not in text


def test_a_mirror_asks_for_levels_without_cuts():
    assert "adc_bailout 0 max_trace_level 9 }" in written(FLOOR, ball("mirror"))


def test_a_recursion_beyond_pov_rays_is_unsupported_by_name():
    assert "max_trace_level 256" in written(ball("mirror"), limit=255)
    with pytest.raises(Unsupported, match="recursion_limit 256") as caught:
        written(ball("mirror"), limit=256)
    assert caught.value.missing_features == ["reflection"]
    assert "max_trace_level" not in written(ball("matt"), limit=256)


def test_transparent_objects_cast_no_shadow_only_where_the_scene_says_so():
    assert "no_shadow" not in written(FLOOR, ball("pane"))
    text = written(FLOOR, ball("pane"), more="transparent_shadows: ignore\n")
    assert text.count("no_shadow") == 1
    assert re.search(r"sphere \{[^}]*\} *\n? *no_shadow \}", text)


def test_glass_has_an_interior_and_clear_panes_have_none_where_counting_cannot_matter():
    assert "interior { ior 1.5 }" in written(FLOOR, ball("glass"))
    assert "interior" not in written(FLOOR, ball("pane"))


@pytest.mark.parametrize(("limit", "mirror", "counted"), [(2, False, False), (1, False, True), (2, True, True)])
def test_crossings_of_index_1_are_made_to_count_where_a_path_could_be_cut(limit, mirror, counted):
    text = written(ball("pane"), *([FLOOR.replace("matt", "mirror")] if mirror else []), limit=limit)
    assert ("interior { ior 0.99999994 } }" in text) == counted


def test_objects_whose_crossings_count_share_their_inside_and_come_last():
    disc = "{kind: disc, center: [0, 0, 1], normal: [0, 0, 1], radius: 1, material: pane}"
    text = written(ball("pane"), ball("mirror"), disc)
    union = text[text.index("union {") :]
    assert union.count("texture") == 2
    assert union.rstrip().endswith("interior { ior 0.99999994 }\n  split_union off\n}")
    assert union.index("disc") < union.index("sphere"), "of coincident surfaces the last one of a union wins"
    assert "mirror" not in union


def test_a_mesh_wound_inwards_has_the_inverse_index():
    assert "interior { ior 1.5 }" in written(CUBE.replace("FACES", OUTWARD))
    assert f"interior {{ ior {1 / 1.5!r} }}" in written(CUBE.replace("FACES", INWARD))


def test_a_mesh_says_what_is_inside_only_where_the_eye_may_be():
    assert "inside_vector" not in written(CUBE.replace("FACES", OUTWARD))
    around = CUBE.replace("FACES", OUTWARD).replace("}", ", transform: [{translate: [-0.2, -0.2, -0.2]}, {scale: 30}]}")
    text = written(around)
    assert text.index("inside_vector") < text.index("interior"), "POV-Ray wants it in the mesh, before any modifier"


def test_lengths_are_scaled_so_that_tolerances_are_small_beside_a_pixel():
    def scale(*objects: str, more: str = "") -> float:
        return 1.0 / float((re.search(r"lengths in units of (\S+) m", written(*objects, more=more)) or [0, "1"])[1])

    assert scale(ball("matt")) == 1, "one ball casts no shadow that is seen"
    assert scale(FLOOR, ball("matt")) >= 100
    assert scale(ball("mirror"), ball("glass").replace("[0, 0, 0]", "[1.5, 0, 0]")) >= 1000, "no plane whose end could be seen"


def test_the_tilt_that_stands_for_an_error_of_the_index_turns_a_ray_at_least_as_far():
    for ior in (0.7, 1.1, 1.5, 2.4):
        tilt = _as_normal(1e-6, ior)
        for eta in (ior, 1 / ior):
            for degrees in (5.0, 30.0, 60.0, 85.0):
                sine = np.sin(np.radians(degrees))
                if eta * sine * (1 + 1e-5) >= 1:
                    continue
                turned = abs(np.arcsin(eta * sine * (1 + 1e-6)) - np.arcsin(eta * sine))
                # the ray's angle to a fixed direction when the normal tilts by τ: τ + asin(η sin(θ − τ))
                by_tilt = abs(tilt + np.arcsin(eta * np.sin(np.radians(degrees) - tilt)) - np.arcsin(eta * sine))
                assert turned <= 1.001 * by_tilt, f"ior {ior}, η {eta}, {degrees}°: index {turned}, tilt {by_tilt}"


# --- the fixed-function model -----------------------------------------------------------------------------------------

GL = """
equilux: 1
name: gl
model: opengl
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 40}
film: {width: 40, height: 30}
ambient: AMBIENT
viewer: local
lights:
  sun: {kind: directional, direction: [0, 0, -2], irradiance: 2, SHARES}
materials:
  clay: {MATERIAL}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}
"""
ORTHOGRAPHIC = "projection: orthographic, eye: [0, 0, 3], target: [0, 0, 0], height_m: 2"


def gl(material: str, shares: str = "specular: 1", ambient: str = "0", **replaced: str) -> str:
    text = GL.replace("MATERIAL", material).replace("SHARES", shares).replace("AMBIENT", ambient)
    for old, new in replaced.items():
        text = re.sub(rf"{old}: .*", f"{old}: {new}", text, count=1)
    return ADAPTER.translate(case_of_text(text), ADAPTER.Knobs()).files["scene.pov"].decode()


def test_the_half_vector_is_written_as_specular_and_roughness():
    text = gl("diffuse: 0.5, specular: 0.25, exponent: 20")
    assert "diffuse 1 specular 0.25 roughness 0.05" in text
    assert "no_shadow" in text
    assert "phong" not in text


def test_a_lights_share_scales_it_where_only_one_term_shows_it():
    assert "rgb <1, 2, 2> * Exposure" in gl("diffuse: 0.5", "diffuse: [0.5, 1, 1], specular: 0")
    assert "rgb 0.5 * Exposure" in gl("specular: 0.5", "diffuse: 1, specular: 0.25")
    assert "rgb 0.5 * Exposure" in gl("specular: 0.5, diffuse: 0.5", "diffuse: 0.25, specular: 0.25")


UNSUPPORTED = {
    "two colours of one light": (
        {"material": "specular: 0.5, diffuse: 0.5", "shares": "specular: 0.5"}, "light.specular-colour"),
    "a light with an ambient share": ({"material": "ambient: 0.5", "shares": "ambient: 0.5"}, "light.ambient-colour"),
    "the half vector to a viewer at infinity": (
        {"material": "specular: 0.5", "viewer": "infinite"}, "viewer.infinite"),
    "the half vector to a local viewer of parallel rays": (
        {"material": "specular: 0.5", "camera": "{" + ORTHOGRAPHIC + "}"}, "camera.orthographic"),
}


@pytest.mark.parametrize("what", UNSUPPORTED)
def test_what_pov_ray_has_no_statement_for_is_unsupported_by_name(what):
    arguments, feature = UNSUPPORTED[what]
    with pytest.raises(Unsupported) as caught:
        gl(**arguments)
    assert caught.value.missing_features == [feature]


def test_the_viewer_matters_only_to_highlights():
    assert "roughness" not in gl("diffuse: 0.5", viewer="infinite")
    assert "roughness" in gl("specular: 0.5", viewer="infinite", camera="{" + ORTHOGRAPHIC + "}")
    assert "ambient_light" in gl("ambient: 0.5, diffuse: 0.5", "ambient: 0", ambient="0.5")


# --- the reflection equation ------------------------------------------------------------------------------------------


def test_lights_without_extent_are_traced_with_shadows():
    text = """
equilux: 1
name: delta
model: reflection-equation
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 40}
film: {width: 4, height: 3}
lights: {sun: {kind: directional, direction: [0, -1, -1], irradiance: 1}}
materials:
  clay: {diffuse: 0.5, brdf: lambert}
  gloss: {diffuse: 0.5, specular: 0.25, exponent: 3}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}
  - {kind: plane, point: [0, -1, 0], normal: [0, 1, 0], material: gloss}
"""
    program = ADAPTER.translate(case_of_text(text), ADAPTER.Knobs()).files["scene.pov"].decode()
    assert program.count("phong 0.25 phong_size 3") == 1
    assert "no_shadow" not in program


@pytest.mark.parametrize("feature", ["light.sphere", "light.disc", "light.rectangle", "light.environment", "brdf.phong-cosine"])
def test_emitters_with_extent_are_not_claimed(feature):
    assert feature not in ADAPTER.capabilities()
