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


# --- mirrors, transparency, media -------------------------------------------------------------------------------------

FULL = "adc_bailout 0 max_trace_level 8"
GLOW = "finish { ambient 0 diffuse 0 emission 1 }"
NEAR_ONE = "interior { ior 0.99999994 }"


def pane(z: float, filtered: str = "rgbf <1, 1, 1, 1>", more: str = "") -> str:
    return f"disc {{ <0, 0, {z}>, z, 9 pigment {{ {filtered} }} finish {{ ambient 0 diffuse 0 }} {more} }}"


def test_q30_what_passes_is_the_product_of_the_layers_for_rays_and_for_shadows(tmp_path):
    filters = "".join(layer(f"rgbf <{x}, {x}, {x}, 1>", "ambient 0 diffuse 0") for x in (0.5, 1.5, 0.25))
    window = f"disc {{ <0, 0, 1>, z, 9 {filters} }}"
    seen = shown(tmp_path / "a", window + disc(f"pigment {{ rgb 1 }} {GLOW}"), settings=FULL)[MIDDLE][0]
    assert seen == pytest.approx(0.5 * 1.5 * 0.25, abs=1e-5)
    aside = window.replace("<0, 0, 1>, z, 9", "<0, 2, 1>, z, 0.5")
    lamp = "light_source { <0, 4, 2>, rgb 1 }"
    lit = shown(tmp_path / "b", lamp + aside + disc(layer("rgb 1", "ambient 0 diffuse 1")), settings=FULL)[MIDDLE][0]
    assert lit == pytest.approx(0.5 * 1.5 * 0.25 * 2 / np.sqrt(20), abs=1e-5)


def test_q31_reflection_is_added_whatever_the_layers_do(tmp_path):
    ceiling = f"disc {{ <0, 0, 5>, z, 9 pigment {{ rgb 1 }} {GLOW} }}"
    for name, pigment in (("opaque", "rgb 0.5"), ("clear", "rgbt <0.5, 0.5, 0.5, 0.75>")):
        mirror = disc(layer(pigment, "ambient 0 diffuse 0 reflection { rgb 0.375 }"))
        got = shown(tmp_path / name, ceiling + mirror, settings=FULL)[MIDDLE][0]
        assert got == pytest.approx(0.375, abs=1e-5), name


@pytest.mark.parametrize(("passing", "expected"), [("1e-20", 0.75), ("0", 0.0)])
def test_q32_total_reflection_has_weight_1_and_needs_something_to_pass(passing, expected, tmp_path):
    # from inside a glass ball, 60° off its normal: 1.5 sin 60° > 1
    camera = CAMERA.replace("<0, 0, 3>", "<0.8660254, 0, 0>")
    glass = f"pigment {{ rgbf <{passing}, {passing}, {passing}, 1> }} finish {{ ambient 0 diffuse 0 }} interior {{ ior 1.5 }}"
    ball = f"sphere {{ 0, 1 {glass} }}"
    target = f"sphere {{ <0.2, 0, -0.66>, 0.3 pigment {{ rgb 0.75 }} {GLOW} }}"
    got = shown(tmp_path, ball + target, camera=camera.replace("right <1,", "right <1e-3,").replace("up <0, 1,", "up <0, 1e-3,"),
                settings=FULL)[MIDDLE][0]
    assert got == pytest.approx(expected, abs=1e-5)


def test_q33_the_shadow_ray_of_a_parallel_light_ends_in_the_plane_through_its_location(tmp_path):
    def lit(location: str) -> float:
        lamp = f"light_source {{ {location}, rgb 0.5 parallel point_at 0 }}"
        blocker = "disc { <0, 4, 4>, z, 2 pigment { rgb 0 } }"
        return float(shown(tmp_path / location, lamp + blocker + disc(layer("rgb 1", "ambient 0 diffuse 1")))[MIDDLE][0])

    assert lit("<0, 1, 1>") == pytest.approx(0.5 / np.sqrt(2), abs=1e-5)
    assert lit("<0, 1e7, 1e7>") == 0.0


@pytest.mark.parametrize(("inside", "expected"), [("", 0.5), ("interior { ior 1.00000001 }", 0.5), (NEAR_ONE, 0.0)])
def test_q34_and_q35_a_ray_through_index_1_does_not_count_and_the_next_float32_does(inside, expected, tmp_path):
    # at its last level POV-Ray does not go on at all, counted or not: so the second pane shows it
    panes = pane(1, more=inside) + pane(2, more=inside) + disc(f"pigment {{ rgb 0.5 }} {GLOW}")
    got = shown(tmp_path, panes, settings="adc_bailout 0 max_trace_level 2")[MIDDLE][0]
    assert got == pytest.approx(expected, abs=1e-5)


def test_q34_objects_of_one_inside_count_and_those_of_equal_insides_do_not(tmp_path):
    def seen(panes: str, level: int) -> float:
        scene = panes + disc(f"pigment {{ rgb 0.5 }} {GLOW}")
        folder = tmp_path / f"{len(panes)}-{level}"
        return float(shown(folder, scene, settings=f"adc_bailout 0 max_trace_level {level}")[MIDDLE][0])

    apart = "".join(pane(z, more=NEAR_ONE) for z in (1, 2, 2.5))
    shared = f"union {{ {pane(1)} {pane(2)} {pane(2.5)} {NEAR_ONE} split_union off }}"
    assert seen(apart, 3) == pytest.approx(0.5, abs=1e-5)
    assert seen(shared, 3) == 0.0
    assert seen(shared, 4) == pytest.approx(0.5, abs=1e-5)


def test_q36_the_eye_is_inside_a_mesh_only_with_an_inside_vector(tmp_path):
    corners = "<-1, -1, -1>, <1, -1, -1>, <1, 1, -1>, <-1, 1, -1>, <-1, -1, 1>, <1, -1, 1>, <1, 1, 1>, <-1, 1, 1>"
    faces = ("<0, 2, 1>, <0, 3, 2>, <4, 5, 6>, <4, 6, 7>, <0, 1, 5>, <0, 5, 4>, <2, 3, 7>, <2, 7, 6>, <1, 2, 6>, <1, 6, 5>,"
             " <3, 0, 4>, <3, 4, 7>")
    # looking out 43.5° off the normal: always totally reflected if the eye is known to be inside
    camera = "camera { location 0 direction <1, 0.02, -0.95> right <1e-3, 0, 0> up <0, 1e-3, 0> }"
    sky = "background { rgb 0.25 }"
    seen = {}
    for name, vector in (("without", ""), ("with", "inside_vector <0.36, 0.48, 0.8>")):
        mesh = f"mesh2 {{ vertex_vectors {{ 8, {corners} }} face_indices {{ 12, {faces} }} {vector}"
        glass = mesh + " pigment { rgbf <0.5, 0.5, 0.5, 1> } finish { ambient 0 diffuse 0 } interior { ior 1.5 } }"
        seen[name] = shown(tmp_path / name, sky + glass, camera=camera, settings=FULL)[MIDDLE][0]
    assert seen["with"] == 0.0
    assert seen["without"] == pytest.approx(0.5 * 0.25, abs=1e-5), "out through the first face"


@pytest.mark.parametrize(("counted", "expected"), [(True, 0.5), (False, 0.0)], ids=["where counting says", "where the face says"])
def test_q36_a_ray_mirrored_into_glass_by_an_interpolated_normal_enters_where_it_leaves(counted, expected, tmp_path):
    """Seen 20° off the face, N 50° off it: the mirrored ray is inside, 60° off the face, and goes out by sin θ / ior."""
    ior, tilt, view = 1.1, np.radians(50), np.radians(20)
    n, d = np.array([np.sin(tilt), 0, np.cos(tilt)]), np.array([np.sin(view), 0, -np.cos(view)])
    inside = d - 2 * (d @ n) * n
    sine = inside[0] / ior if counted else inside[0] * ior
    x = inside[0] / -inside[2] + sine / np.sqrt(1 - sine**2)
    corners = [f"<{x}, {y}, {z}>" for z in (0, -1) for x, y in ((-50, -50), (50, -50), (50, 50), (-50, 50))]
    faces = "<0,1,2> <0,2,3> <4,6,5> <4,7,6> <0,5,1> <0,4,5> <1,6,2> <1,5,6> <2,7,3> <2,6,7> <3,4,0> <3,7,4>".replace(" ", ", ")
    # three equal normals would be shaded flat (Q21)
    normals = [f"<{n[0]}, 2e-5, {n[2]}>", *[f"<{n[0]}, 0, {n[2]}>"] * 3, *["<0, 0, -1>"] * 4]
    glass = (
        f"mesh2 {{ vertex_vectors {{ 8, {', '.join(corners)} }} normal_vectors {{ 8, {', '.join(normals)} }} face_indices {{ 12, "
        f"{faces} }} {layer('rgbf <1, 1, 1, 0.5>', 'ambient 0 diffuse 0 reflection 1')} interior {{ ior {ior} }} }}"
    )
    glow = f"disc {{ <{x}, 0, -2>, z, 0.01 {layer('rgb 1', 'ambient 0 diffuse 0 emission 1')} }}"
    camera = CAMERA.replace("<0, 0, 3>", f"<{-3 * d[0]}, 0, {-3 * d[2]}>").replace("<0, 0, -1>", f"<{d[0]}, 0, {d[2]}>")
    assert shown(tmp_path, glass + glow, camera=camera)[MIDDLE][0] == pytest.approx(expected, abs=1e-4)


def test_q37_a_blocker_nearer_than_1e_3_casts_no_shadow(tmp_path):
    def lit(distance: float) -> float:
        blocker = f"disc {{ <0, 0, {distance}>, z, 9 pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 }} no_image }}"
        floor = disc(layer("rgb 1", "ambient 0 diffuse 1"))
        return float(shown(tmp_path / str(distance), LAMP.replace("rgb 1", "rgb 0.5") + blocker + floor)[MIDDLE][0])

    assert lit(0.9e-3) == pytest.approx(0.5, abs=1e-5)
    assert lit(1.1e-3) == 0.0


def test_q38_level_1_is_the_cameras_ray(tmp_path):
    # two mirrors face to face, each glowing with 2⁻³: level m shows exactly m terms
    mirror = "pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 0.125 reflection { rgb 0.5 } }"
    scene = disc(mirror) + f"disc {{ <0, 0, 5>, z, 9 {mirror} }}"
    for level in (1, 2, 5):
        got = shown(tmp_path / str(level), scene, settings=f"adc_bailout 0 max_trace_level {level}")[MIDDLE][0]
        assert got == pytest.approx(0.125 * sum(0.5**k for k in range(level)), abs=1e-5)


def test_q39_light_from_behind_makes_no_highlight(tmp_path):
    lamp = LAMP.replace("<0, 0, 3>", "<0, 0, -3>")
    sheet = disc(layer("rgbt <1, 1, 1, 0.5>", "ambient 0 diffuse 0.5, 0.25 phong 1 phong_size 1 specular 1 roughness 1"))
    assert shown(tmp_path, lamp + sheet, settings=FULL)[MIDDLE][0] == pytest.approx(0.5 * 0.25, abs=1e-5)


def test_q40_specular_is_the_half_vector_with_the_inverse_of_roughness(tmp_path):
    lamp = "light_source { vrotate(z, y * 60), rgb 1 parallel point_at 0 }"
    for exponent in (0.0, 4.0, 128.0):
        mirror = layer("rgb 0", f"ambient 0 diffuse 0 specular 0.5 roughness {1 / max(exponent, 1e-30)!r}")
        got = shown(tmp_path / str(exponent), lamp + disc(mirror))[MIDDLE][0]
        assert got == pytest.approx(0.5 * np.cos(np.radians(30)) ** exponent, abs=1e-5)


def test_q42_an_area_light_has_no_cosine_at_the_emitter(tmp_path):
    # a square metre one metre above the floor, as bright as point lights of 1/4 W/sr in all
    camera = "camera { orthographic location <0, 0.5, 0> direction <0, -1, 0> right <9, 0, 0> up <0, 0, 9> }"
    lamp = "light_source { <0, 1, 0>, rgb 0.125e6 area_light x, z, 33, 33 area_illumination on fade_power 2 fade_distance 1e-3 }"
    row = shown(tmp_path, lamp + "plane { y, 0 " + layer("rgb 1", "ambient 0 diffuse 1") + " }", camera=camera)[SIZE // 2, :, 0]
    grid = (np.arange(400) + 0.5) / 400 - 0.5
    for aside, excess in ((0, 0.06), (1, 0.36), (2, 1.15)):
        squares = (grid[:, None] - aside) ** 2 + grid[None] ** 2 + 1
        emitted = 0.25 * np.mean(squares**-2.0)
        assert row[SIZE // 2 + aside] / emitted - 1 == pytest.approx(excess, abs=0.01), f"{aside} m aside"


def test_q43_media_are_nested_by_a_stack(tmp_path):
    # a ball of the same glass inside a ball of glass is not there, where the model would see it as glass in air
    def seen(inner: str) -> np.ndarray:
        glass = "pigment { rgbf <1, 1, 1, 1> } finish { ambient 0 diffuse 0 } interior { ior 1.5 }"
        wall = f"disc {{ <0, 0, -3>, z, 9 pigment {{ gradient x color_map {{ [0 rgb 0] [1 rgb 1] }} scale 20 }} {GLOW} }}"
        balls = f"sphere {{ 0, 1 {glass} }}" + inner.replace("GLASS", glass)
        return shown(tmp_path / str(len(inner)), wall + balls, settings=FULL)

    alone, nested = seen(""), seen("sphere { <0.1, 0, 0>, 0.5 GLASS }")
    np.testing.assert_allclose(nested, alone, atol=2e-5)
