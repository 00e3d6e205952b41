"""The facts about POV-Ray that the adapter is built on (its QUIRKS.md), asked of POV-Ray directly."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from equilux_adapters.povray.png import read_codes

SIZE = 9
CAMERA = "camera { location <0, 0, 3> direction <0, 0, -1> right <1, 0, 0> up <0, 1, 0> }"
LAMP = "light_source { <0, 0, 3>, rgb 1 parallel point_at 0 }"
MIDDLE = (SIZE // 2, SIZE // 2)


def shown(folder: Path, scene: str, *arguments: str, camera: str = CAMERA, settings: str = "") -> np.ndarray:
    """What POV-Ray makes of a few statements: (SIZE, SIZE, 3), radiances up to 1."""
    folder.mkdir(exist_ok=True)
    header = f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 {settings} }}"
    (folder / "scene.pov").write_text(f"{header}\n{camera}\n{scene}\n")
    (folder / "render.ini").write_text(
        f"Width={SIZE}\nHeight={SIZE}\nDisplay=Off\nOutput_File_Type=N\nBits_Per_Color=16\nFile_Gamma=1.0\nAntialias=Off\n"
        "Input_File_Name=scene.pov\nOutput_File_Name=image.png\nOutput_Alpha=Off\n"
    )
    environment = {**os.environ, "POVINI": "render.ini"}
    done = subprocess.run(["povray", *arguments], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return read_codes(folder / "image.png", SIZE, SIZE) / 65535.0


def disc(texture: str, more: str = "") -> str:
    return f"disc {{ 0, z, 5 {texture} {more} }}"


def layer(pigment: str, finish: str) -> str:
    return f"texture {{ pigment {{ {pigment} }} finish {{ {finish} }} }}"


def test_q1_right_must_be_written_as_forward_cross_up(tmp_path):
    ball = "sphere { <0.9, 0, 0>, 0.3 pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }"
    columns = shown(tmp_path, ball)[..., 0].sum(axis=0)
    assert np.argmax(columns) > SIZE // 2
    mirrored = shown(tmp_path, ball, camera=CAMERA.replace("right <1,", "right <-1,"))[..., 0].sum(axis=0)
    assert np.argmax(mirrored) < SIZE // 2


def test_q3_a_shadowless_light_makes_no_highlight_and_a_shadowless_object_does(tmp_path):
    mirror = layer("rgb 0", "ambient 0 diffuse 0 phong 0.5 phong_size 1")
    assert shown(tmp_path / "a", LAMP + disc(mirror, "no_shadow"))[MIDDLE][0] == pytest.approx(0.5, abs=1e-5)
    assert shown(tmp_path / "b", LAMP.replace("parallel", "shadowless parallel") + disc(mirror))[MIDDLE][0] == 0.0


def test_q4_the_pigment_multiplies_diffuse_ambient_and_emission_but_not_the_highlight(tmp_path):
    one = LAMP + disc(layer("rgb <0.5, 0.25, 0>", "ambient 0 diffuse 0.5 emission rgb <0.2, 0.4, 1> phong 0.125 phong_size 1"))
    expected = np.array([0.5, 0.25, 0]) * (0.5 + np.array([0.2, 0.4, 1])) + 0.125
    np.testing.assert_allclose(shown(tmp_path, one)[MIDDLE], expected, atol=1e-5)


def test_q6_a_half_transparent_layer_weighs_itself_and_what_is_below_by_half_but_not_its_own_highlight(tmp_path):
    below = layer("rgb 0.5", "ambient 0 diffuse 0 emission 1")
    above = layer("rgbt <1, 1, 1, 0.5>", "ambient 0 diffuse 0.25 phong 0.125 phong_size 1")
    got = shown(tmp_path, LAMP + disc(below + above), settings="adc_bailout 0")[MIDDLE][0]
    assert got == pytest.approx(0.5 * 0.5 + 0.5 * 0.25 + 0.125, abs=1e-5)


def test_q7_layers_below_one_255th_are_cut_unless_adc_bailout_is_zero(tmp_path):
    stack = layer("rgb 1", "ambient 0 diffuse 0 emission 100") + layer("rgbf <0.003, 0.003, 0.003, 1>", "ambient 0 diffuse 0")
    assert shown(tmp_path / "a", disc(stack))[MIDDLE][0] == 0.0
    assert shown(tmp_path / "b", disc(stack), settings="adc_bailout 0")[MIDDLE][0] == pytest.approx(0.3, abs=1e-5)


def test_q8_a_fade_distance_below_1e_10_is_no_fading_at_all(tmp_path):
    def lit(distance: str) -> float:
        lamp = f"light_source {{ <0, 0, 2>, rgb 0.5 fade_power 2 fade_distance {distance} }}"
        return float(shown(tmp_path / distance, lamp + disc(layer("rgb 1", "ambient 0 diffuse 1")))[MIDDLE][0])

    assert lit("0.9e-10") == pytest.approx(0.5, abs=1e-5)
    assert lit("1.1e-10") == 0.0


def test_q17_of_coincident_surfaces_the_first_wins_below_the_bounding_threshold(tmp_path):
    cards = "".join(disc(layer(f"rgb {0.1 * (k + 1):.1f}", "ambient 0 diffuse 0 emission 1")) for k in range(6))
    assert shown(tmp_path, cards, "Bounding_Threshold=200")[MIDDLE][0] == pytest.approx(0.1, abs=1e-5)


def test_q18_a_polygon_that_leaves_its_plane_by_rounding_vanishes(tmp_path):
    def card(off: float) -> str:
        corners = f"<-1, -1, 0>, <1, -1, 0>, <1, 1, {off}>, <-1, 1, 0>, <-1, -1, 0>"
        return f"polygon {{ 5, {corners} pigment {{ rgb 1 }} finish {{ ambient 0 diffuse 0 emission 0.5 }} }}"

    assert shown(tmp_path / "a", card(1e-11))[MIDDLE][0] == pytest.approx(0.5, abs=1e-5)
    assert shown(tmp_path / "b", card(1e-9))[MIDDLE][0] == 0.0


def test_q21_normals_nearer_than_1e_5_are_shaded_flat(tmp_path):
    def lit(turn: float) -> float:
        normals = f"<1, 0, 1>, <1, 0, 1>, <{1 + turn}, 0, 1>"
        mesh = f"mesh2 {{ vertex_vectors {{ 3, <-3, -3, 0>, <3, -3, 0>, <0, 5, 0> }} normal_vectors {{ 3, {normals} }}"
        mesh += " face_indices { 1, <0, 1, 2> } pigment { rgb 1 } finish { ambient 0 diffuse 1 } }"
        return float(shown(tmp_path / str(turn), LAMP + mesh)[MIDDLE][0])

    assert lit(0.0) == pytest.approx(1.0, abs=1e-5), "the face's own normal"
    assert lit(5e-5) == pytest.approx(np.sqrt(0.5), abs=5e-5), "the interpolated normal"


def test_q22_codes_are_rounded_to_the_nearest_and_clipped(tmp_path):
    assert shown(tmp_path / "a", "background { rgb <0.49, 0.51, 1.49> / 65535 }")[MIDDLE] * 65535 == pytest.approx([0, 1, 1])
    bright = shown(tmp_path / "b", "background { rgb <1.5, 1, 65534.4 / 65535> }")[MIDDLE]
    assert bright * 65535 == pytest.approx([65535, 65535, 65534])


def test_q24_a_number_declared_on_the_command_line_keeps_six_digits(tmp_path):
    got = shown(tmp_path, "background { rgb (Exposure - 77.852) * 1000 }", "Declare=Exposure=77.85215482")[MIDDLE][0]
    assert got == pytest.approx(0.2, abs=1e-5), f"Exposure is 77.852 + {got / 1000}"


def test_q27_the_highlight_is_the_cosine_of_the_mirror_direction_and_zero_behind_it(tmp_path):
    # a light 60° off the normal of a surface seen head on: R·V = cos 60°; at 100° it is behind the surface
    def lit(degrees: float, size: float) -> float:
        lamp = f"light_source {{ vrotate(z, y * {degrees}), rgb 1 parallel point_at 0 }}"
        mirror = layer("rgb 0", f"ambient 0 diffuse 0 phong 0.5 phong_size {size}")
        return float(shown(tmp_path / f"{degrees}-{size}", lamp + disc(mirror))[MIDDLE][0])

    assert lit(60, 0.1) == pytest.approx(0.5 * 0.5**0.1, abs=1e-5)
    assert lit(60, 0) == pytest.approx(0.5, abs=1e-5)
    assert lit(100, 0) == 0.0
