"""What the translator writes: what a competent user would, and only what the scene requires."""

from __future__ import annotations

import re

import numpy as np
import pytest

from equilux.adapter import Unsupported
from equilux_adapters.povray import ADAPTER
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_scenes.transforms import matrix
from support.povray import case_of_text

PLAIN = """
equilux: 1
name: plain
about: One light, one ball.
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 90}
film: {width: 40, height: 20}
lights:
  key: {kind: directional, direction: [0, 0, -2], irradiance: [1, 0.5, 0.25]}
materials:
  clay: {diffuse: [0.6, 0.3, 0.1]}
objects:
  - {kind: sphere, center: [0.25, 0, 0], radius: 0.5, material: clay}
"""

PLAIN_PROGRAM = """\
// plain
// One light, one ball.
#version 3.7;
// radiance times Exposure is what the image shows, clipped at 1; render.ini and command.txt say how it is called
#ifndef (Exposure) #declare Exposure = 1; #end

global_settings { assumed_gamma 1.0 }

camera {
  location <0, 0, 3>
  direction <0, 0, -1>
  right <1, 0, 0> * 3.999999999999999
  up <0, 1, 0> * 1.9999999999999998
}

// key
light_source { <0, 0, 1>, rgb <1, 0.5, 0.25> * Exposure parallel point_at <0, 0, 0> }

#declare Material_0_clay =
  texture { pigment { rgb <0.6, 0.3, 0.1> } finish { ambient 0 diffuse 1 } };

sphere { <0.25, 0, 0>, 0.5
  texture { Material_0_clay }
  no_shadow }
"""


def written(text: str) -> str:
    return ADAPTER.translate(case_of_text(text), ADAPTER.Knobs()).files["scene.pov"].decode()


def with_material(clay: str, more: str = "") -> str:
    return written(PLAIN.replace("{diffuse: [0.6, 0.3, 0.1]}", clay) + more)


def with_light(key: str) -> str:
    return written(re.sub("key: {.*}", "key: {" + key + "}", PLAIN))


def with_object(shape: str) -> str:
    return written(re.sub("- {kind: sphere.*}", "- {" + shape + ", material: clay}", PLAIN))


def test_a_plain_scene_is_written_as_a_user_would():
    assert written(PLAIN) == PLAIN_PROGRAM


STATEMENTS = {
    "emission": "material.emission",
    "ambient_light": "material.ambient",
    "phong": "material.specular",
    "background": "background",
    "spotlight": "light.spot",
    "tightness": "light.spot-exponent",
    "parallel": "light.directional",
    "orthographic": "camera.orthographic",
    "normal_vectors": "normals.smooth",
    "mesh2": "shape.mesh",
    "disc": "shape.disc",
    "cylinder": "shape.cylinder",
    "sphere": "shape.sphere",
    "reflection": "reflection",
    "interior": "transparency",
    "rgbf": ("transparency", "material.specular"),
    "max_trace_level": ("transparency", "reflection"),
    "roughness": "model.opengl",
    "no_shadow": ("model.phong", "model.opengl", "shadow.ignored"),
}


def test_no_corpus_scene_gets_a_statement_that_it_does_not_require():
    families = [folder for folder in sorted(corpus_folder().iterdir()) if folder.is_dir() and folder.name != "showcase"]
    for file in load_scenes(families):
        for case in file.cases:
            try:
                program = ADAPTER.translate(case, ADAPTER.Knobs()).files["scene.pov"].decode()
            except Unsupported:
                continue
            code = re.sub("//.*", "", program)
            for statement, feature in STATEMENTS.items():
                features = (feature,) if isinstance(feature, str) else feature
                if not set(features) & set(case.requires):
                    assert not re.search(rf"\b{statement}\b", code), f"{case.name}: '{statement}' without {feature}"


def test_translation_is_pure():
    case = case_of_text(PLAIN)
    assert ADAPTER.translate(case, ADAPTER.Knobs()) == ADAPTER.translate(case, ADAPTER.Knobs())


def test_every_number_reads_back_to_the_same_double():
    place = (0.1, 1 / 3, 1e-7)
    text = with_object(f"kind: sphere, center: [{place[0]!r}, {place[1]!r}, {place[2]!r}], radius: 0.7071067811865476")
    numbers = re.search(r"sphere { <(.*), (.*), (.*)>, (\S+)", text)
    assert numbers is not None
    assert tuple(float(n) for n in numbers.groups()) == (*place, 0.7071067811865476)


def vector_after(keyword: str, text: str) -> np.ndarray:
    return np.array([float(n) for n in re.search(rf"{keyword} <(.*?)>", text).group(1).split(",")])


def test_right_is_forward_cross_up():
    text = written(PLAIN.replace("eye: [0, 0, 3]", "eye: [1, 2, 3]").replace("up: [0, 1, 0]", "up: [0.3, 1, 0.1]"))
    direction, right, up = (vector_after(name, text) for name in ("direction", "right", "up"))
    np.testing.assert_allclose(np.cross(direction, up), right, atol=1e-15)


def test_matrices_are_written_for_row_vectors():
    turn = "{rotate: {axis: [0, 0, 1], degrees: 90}}"
    shape = f"kind: sphere, center: [0, 0, 0], radius: 1, transform: [{turn}, {{translate: [1, 2, 3]}}]"
    assert "matrix <0, 1, 0, -1, 0, 0, 0, 0, 1, 1, 2, 3>" in with_object(shape)


# --- materials --------------------------------------------------------------------------------------------------------


def layers(text: str) -> list[str]:
    """The texture's layers, bottom first."""
    return re.search(r"#declare Material_0_clay =\n((?:  texture .*\n?)+)", text).group(1).replace(";", "").splitlines()


def test_a_grey_highlight_needs_one_layer():
    (layer,) = layers(with_material("{diffuse: [0.6, 0.3, 0.1], specular: 0.5, exponent: 20}"))
    assert layer.strip() == "texture { pigment { rgb <0.6, 0.3, 0.1> } finish { ambient 0 diffuse 1 phong 0.5 phong_size 20 } }"


def test_emission_rides_on_the_pigment_where_the_pigment_is_not_black():
    (layer,) = layers(with_material("{diffuse: [0.5, 0.25, 0.125], emission: [0.5, 0, 0.5]}"))
    assert "emission rgb <1, 0, 4> * Exposure" in layer


def test_emission_alone_has_a_white_pigment():
    (layer,) = layers(with_material("{emission: [0.5, 0, 0.25]}"))
    assert layer.strip() == "texture { pigment { rgb 1 } finish { ambient 0 diffuse 0 emission rgb <0.5, 0, 0.25> * Exposure } }"


def test_emission_that_the_pigment_cannot_carry_gets_a_layer_above_and_the_rest_twice_the_weight():
    bottom, top = layers(with_material("{diffuse: [0.5, 0, 0.5], specular: 0.25, exponent: 3, emission: [0, 1, 0]}"))
    assert bottom.strip() == "texture { pigment { rgb <0.5, 0, 0.5> } finish { ambient 0 diffuse 2 phong 0.5 phong_size 3 } }"
    assert "pigment { rgbt <1, 1, 1, 0.5> }" in top
    assert "finish { ambient 0 diffuse 0 emission rgb <0, 2, 0> * Exposure }" in top


def test_a_coloured_highlight_is_a_grey_one_behind_a_filter():
    text = with_material("{diffuse: 0.5, specular: [0.5, 0, 0.25], exponent: 3}")
    highlight, tint, surface = layers(text)
    assert "phong 1 phong_size 3" in highlight
    assert "rgbf <1, 0, 0.5, 1>" in tint
    assert "rgbt <0.5, 0.5, 0.5, 0.5>" in surface
    assert "diffuse 2" in surface
    assert "adc_bailout 0" in text


def test_ambient_counts_only_where_there_is_ambient_light():
    assert "ambient_light" not in with_material("{diffuse: 0.5, ambient: 0.3}")
    text = with_material("{diffuse: 0.5, ambient: 0.25}", "ambient: [0.1, 0, 0]\n")
    assert "ambient_light rgb <0.1, 0, 0> * Exposure" in text
    assert "ambient rgb <0.5, 0, 0>" in text


# --- lights -----------------------------------------------------------------------------------------------------------

LAMP = "kind: point, position: [0, 2, 0], intensity: 2, attenuation: "


def test_a_constant_law_does_not_fade():
    assert "light_source { <0, 2, 0>, rgb 2 * 0.25 * Exposure }" in with_light(LAMP + "{constant: 4}")


def test_constant_and_quadratic_are_one_light():
    # 1/(4 + r²) = (1/4) / (1 + (r/2)²) and POV-Ray's is 2 / (1 + (r/d)²)
    text = with_light(LAMP + "{constant: 4, quadratic: 1}")
    assert "rgb 2 * 0.125 * Exposure\n  fade_power 2 fade_distance 2 }" in text


def test_all_three_terms_are_two_lights_of_opposite_sign():
    # (r + 1)(r + 2) = 2 + 3 r + r²
    text = with_light(LAMP + "{constant: 2, linear: 3, quadratic: 1}")
    assert "rgb 2 * 0.5 * Exposure\n  fade_power 1 fade_distance 1 }" in text
    assert "rgb 2 * -0.25 * Exposure\n  fade_power 1 fade_distance 2 }" in text


def test_three_terms_without_real_roots_are_unsupported_by_name():
    with pytest.raises(Unsupported) as caught:
        with_light(LAMP + "{constant: 1, linear: 1, quadratic: 1}")
    assert caught.value.missing_features == ["attenuation.constant", "attenuation.linear", "attenuation.quadratic"]
    assert "light 'key'" in caught.value.reason


def test_every_inexpressible_light_is_named():
    bad = "{kind: point, position: [0, 2, 0], intensity: 2, attenuation: {constant: 1, linear: 1, quadratic: 1}}"
    with pytest.raises(Unsupported) as caught:
        written(re.sub("key: {.*}", f"one: {bad}\n  two: {bad}", PLAIN))
    assert "light 'one'" in caught.value.reason
    assert "light 'two'" in caught.value.reason


def test_a_spot_light_is_a_hard_cone_and_has_a_tightness_only_with_an_exponent():
    spot = "kind: spot, position: [0, 2, 0], direction: [0, -3, 0], intensity: 1, cone_half_angle_deg: 20"
    assert "spotlight point_at <0, 0, 0> radius 20 falloff 20" in with_light(spot)
    assert "tightness" not in with_light(spot)
    assert "tightness 4.5" in with_light(spot + ", exponent: 4.5")


# --- where it is written ----------------------------------------------------------------------------------------------


def test_a_scene_far_from_the_origin_is_written_around_the_eye():
    text = written(PLAIN.replace("[0, 0, 3]", "[1000000, 0, 3]").replace("target: [0, 0, 0]", "target: [1000000, 0, 0]")
                   .replace("[0.25, 0, 0]", "[1000000.25, 0, 0]"))
    assert "measured from <1000000, 0, 3>" in text
    assert "sphere { <0.25, 0, -3>, 0.5" in text


def test_a_tiny_scene_is_written_in_larger_units():
    text = written(PLAIN.replace("[0, 0, 3]", "[0, 0, 3e-6]").replace("[0.25, 0, 0], radius: 0.5", "[0, 0, 0], radius: 5e-7"))
    unit = float(re.search(r"lengths in units of (\S+) m", text).group(1))
    radius = float(re.search(r"sphere {.*>, (\S+)", text).group(1))
    assert radius * unit == pytest.approx(5e-7)
    assert radius > 1, f"radius {radius} is near POV-Ray's tolerances"


def test_a_scene_of_too_many_scales_is_unsupported():
    far = "  - {kind: sphere, center: [0, 0, -1.0e+12], radius: 1.0e+11, material: clay}\n"
    near = "  - {kind: sphere, center: [0, 0, 2.9999], radius: 1e-5, material: clay}\n"
    with pytest.raises(Unsupported, match="POV-Ray sees"):
        written(PLAIN + far + near)


def test_the_mesh_is_written_around_its_centre_in_float32_digits():
    text = with_object("kind: mesh, vertices: [[10, 0, 0], [12, 0, 0], [10, 1, 0]], faces: [[0, 1, 2]]")
    assert "vertex_vectors { 3,\n    <-1, -0.5, 0>,\n    <1, -0.5, 0>,\n    <-1, 0.5, 0> }" in text
    assert "face_indices { 1,\n    <0, 1, 2> }" in text
    assert "matrix <1, 0, 0, 0, 1, 0, 0, 0, 1, 11, 0.5, 0>" in text


def test_the_written_matrix_is_the_shared_definition():
    shape = "kind: box, min: [0, 0, 0], max: [1, 1, 1], transform: [{scale: [1, 2, 3]}, {rotate: {axis: [1, 1, 0], degrees: 40}}]"
    text = with_object(shape)
    numbers = vector_after("matrix", text)
    case = case_of_text(re.sub("- {kind: sphere.*}", "- {" + shape + ", material: clay}", PLAIN))
    assert np.array_equal(numbers.reshape(4, 3).T, matrix(case.scene.objects[0])[:3])
