"""What each lighting model asks of a scene beyond the terms it has: every violation at its place, and no false alarm."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from equilux_scenes.mesh import TriangleMesh, open_edge, signed_volume

Only = Callable[..., str]
Load = Callable[..., Any]


def spec(model: str, *, lights: str = "", material: str = "diffuse: 0.1", objects: str | None = None, rest: str = "") -> str:
    """A scene with one material `m`."""
    objects = "  - {kind: sphere, center: [0, 0, 0], radius: 1, material: m}\n" if objects is None else objects
    return f"""\
equilux: 1
name: asked
model: {model}
camera: {{projection: perspective, eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 30}}
film: {{width: 4, height: 3}}
{rest}lights: {{{lights}}}
materials:
  m: {{{material}}}
  glass: {{transparency: 0.9, transmission: 1, ior: 1.5}}
objects:
{objects}"""


def traced(objects: str, rest: str = "") -> str:
    """A raytraced scene of these objects; of the glass of `spec` if they say so."""
    return spec("raytraced", objects=objects, rest=rest)


def plain_spec(model: str, **parts: str) -> str:
    """Without the glass, which only one model has."""
    return "".join(line for line in spec(model, **parts).splitlines(keepends=True) if "  glass:" not in line)


# --- reflection-equation ----------------------------------------------------------------------------------------------

SKY = "sky: {kind: environment, radiance: 1}"


def test_an_environment_beside_a_background_is_an_error_at_the_background(only_error: Only) -> None:
    text = plain_spec("reflection-equation", lights=SKY, rest="background: «0.5\n")
    expected = "background of the scene: got 0.5, allowed 0 beside an environment (light 'sky' is what rays that miss see)"
    assert only_error(text) == expected


def test_an_environment_beside_a_background_of_zero_is_accepted(load: Load) -> None:
    load(plain_spec("reflection-equation", lights=SKY, rest="background: [0, 0.0, 0]\n"))


def test_a_second_environment_is_an_error_at_its_kind(only_error: Only) -> None:
    text = plain_spec("reflection-equation", lights=f"{SKY}, more: {{kind: «environment, radiance: 1}}")
    expected = "kind of light 'more': got 'environment', allowed one environment in a scene, and light 'sky' is one"
    assert only_error(text) == expected


@pytest.mark.parametrize("term", ["ambient", "reflection", "transmission", "transparency"])
def test_terms_that_the_reflection_equation_does_not_have_are_errors(only_error: Only, term: str) -> None:
    message = only_error(plain_spec("reflection-equation", material=f"{term}: «0.5"))
    assert message.startswith(f"{term} of material 'm': got 0.5, allowed only its default, 0, in a 'reflection-equation' scene")


def test_the_scenes_ambient_radiance_is_an_error_in_the_reflection_equation(only_error: Only) -> None:
    message = only_error(plain_spec("reflection-equation", rest="ambient: «1\n"))
    assert message.startswith("ambient of the scene: got 1, allowed only its default, 0, in a 'reflection-equation' scene")


def test_a_lambert_material_with_a_highlight_is_an_error(only_error: Only) -> None:
    text = plain_spec("reflection-equation", material="diffuse: 0.1, brdf: lambert, specular: «0.2, exponent: 9")
    expected = "specular of material 'm': got 0.2, allowed 0 with brdf lambert (phong-classic and phong-cosine have a highlight)"
    assert only_error(text) == expected


def test_a_lambert_material_without_a_highlight_is_accepted(load: Load) -> None:
    load(plain_spec("reflection-equation", material="diffuse: 0.1, brdf: lambert, specular: 0, exponent: 9"))


EMITTER_ERRORS = {
    "sphere of radius 0": (
        "{kind: sphere, center: [0, 9, 0], radius: «0, radiance: 1}",
        "radius of light 'e': got 0, allowed a number > 0",
    ),
    "disc without normal": (
        "{kind: disc, center: [0, 9, 0], normal: «[0, 0, 0], radius: 1, radiance: 1}",
        "normal of light 'e': got [0, 0, 0], allowed three numbers, not all 0",
    ),
    "skew rectangle": (
        "{kind: rectangle, corner: [0, 9, 0], edge_u: [1, 0, 0], edge_v: «[1, 1, 0], radiance: 1}",
        "edge_v of light 'e': got [1, 1, 0], allowed an edge orthogonal to edge_u (it makes 45° with it)",
    ),
    "negative radiance": (
        "{kind: environment, radiance: «-1}",
        "radiance of light 'e': got -1, allowed one number ≥ 0 or three",
    ),
    "no radiance": (
        "«{kind: environment}",
        "missing key 'radiance' in light 'e', allowed one number ≥ 0 or three (or one of luminance, spectrum)",
    ),
    "an environment has no place": (
        "{kind: environment, radiance: 1, «center: [0, 0, 0]}",
        "unknown key 'center' in light 'e', allowed spectrum, radiance, luminance, kind",
    ),
    "an environment has no flux": (
        "{kind: environment, radiance: 1, «flux: 1}",
        "unknown key 'flux' in light 'e', allowed spectrum, radiance, luminance, kind",
    ),
}


@pytest.mark.parametrize("name", EMITTER_ERRORS)
def test_a_wrong_emitter_is_an_error_at_its_value(only_error: Only, name: str) -> None:
    light, message = EMITTER_ERRORS[name]
    assert only_error(plain_spec("reflection-equation", lights=f"e: {light}")) == message


def _without_objects(model: str, lights: str) -> str:
    text = plain_spec(model, lights=lights)
    return text[: text.index("objects:")]


LAMP = "k: {kind: point, position: [0, 1, 0], intensity: 1}"


@pytest.mark.parametrize("emitter", [
    "{kind: sphere, center: [0, 0, 0], radius: 1, radiance: 1}",
    "{kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 1, radiance: 1}",
    "{kind: rectangle, corner: [0, 0, 0], edge_u: [1, 0, 0], edge_v: [0, 1, 0], radiance: 1}",
    "{kind: environment, radiance: 1}",
])  # fmt: skip
def test_with_an_emitter_to_be_seen_no_object_is_needed(load: Load, emitter: str) -> None:
    (case,) = load(_without_objects("reflection-equation", f"e: {emitter}")).cases
    assert case.scene.objects == ()


def test_without_an_emitter_objects_are_missing(only_error: Only) -> None:
    expected = "missing key 'objects' in the scene, allowed a list (an emitter would do too)"
    assert only_error("«" + _without_objects("reflection-equation", LAMP)) == expected


@pytest.mark.parametrize("model", ["phong", "opengl", "raytraced"])
def test_in_other_models_objects_are_missing(only_error: Only, model: str) -> None:
    assert only_error("«" + _without_objects(model, LAMP)) == "missing key 'objects' in the scene, allowed a list"


# --- opengl -----------------------------------------------------------------------------------------------------------


def test_gl_takes_exponents_up_to_128(only_error: Only, load: Load) -> None:
    load(plain_spec("opengl", material="specular: 1, exponent: 128"))
    message = only_error(plain_spec("opengl", material="specular: 1, exponent: «128.5"))
    assert message == "exponent of material 'm': got 128.5, allowed a number in [0, 128] in an 'opengl' scene"


SPOT = "s: {{kind: spot, position: [0, 1, 0], direction: [0, -1, 0], intensity: 1, cone_half_angle_deg: {}, exponent: {}}}"


def test_gl_takes_spot_exponents_up_to_128(only_error: Only, load: Load) -> None:
    load(plain_spec("opengl", lights=SPOT.format(90, 128)))
    message = only_error(plain_spec("opengl", lights=SPOT.format(90, "«129")))
    assert message == "exponent of light 's': got 129, allowed a number in [0, 128] in an 'opengl' scene"


@pytest.mark.parametrize("model", ["phong", "raytraced", "reflection-equation"])
def test_other_models_take_any_exponent(load: Load, model: str) -> None:
    load(plain_spec(model, material="specular: 1, exponent: 1e4", lights=SPOT.format(20, 500)))


def test_gl_shares_of_a_light_may_exceed_1_and_not_be_negative(only_error: Only, load: Load) -> None:
    light = "k: {kind: point, position: [0, 1, 0], intensity: 1, ambient: 0.1, diffuse: [2, 1, 0], specular: %s}"
    load(plain_spec("opengl", lights=light % "3"))
    message = only_error(plain_spec("opengl", lights=light % "«-1"))
    assert message == "specular of light 'k': got -1, allowed one number ≥ 0 or three"


# --- raytraced: what refracts is closed -------------------------------------------------------------------------------

CUBE = """\
  - kind: mesh
    material: glass
    vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    faces: [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6],
            [3, 0, 4], [3, 4, 7]]
"""
NEEDS = "another needs a sphere, box, capped cylinder, watertight mesh or plane"
OPEN = {
    "disc": (
        "  - «{kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 1, material: glass}\n",
        f"object 0 (disc): got ior 1.5 of material 'glass', allowed ior 1 (a disc encloses nothing; {NEEDS})",
    ),
    "rectangle": (
        "  - «{kind: rectangle, corner: [0, 0, 0], edge_u: [1, 0, 0], edge_v: [0, 1, 0], material: glass}\n",
        f"object 0 (rectangle): got ior 1.5 of material 'glass', allowed ior 1 (a rectangle encloses nothing; {NEEDS})",
    ),
    "tube": (
        "  - «{kind: cylinder, base: [0, 0, 0], top: [0, 1, 0], radius: 1, capped: false, material: glass}\n",
        "object 0 (cylinder): got ior 1.5 of material 'glass', "
        f"allowed ior 1 (without its caps the cylinder encloses nothing; {NEEDS})",
    ),
    "cube without a triangle": (
        CUBE.replace("- kind", "- «kind").replace("[0, 2, 1], ", ""),
        "object 0 (mesh): got ior 1.5 of material 'glass', allowed ior 1 "
        f"(this mesh is not watertight: 1 triangles have the edge of vertices 0 and 1, not 2; {NEEDS})",
    ),
    "cube with a triangle turned over": (
        CUBE.replace("- kind", "- «kind").replace("[0, 2, 1]", "[0, 1, 2]"),
        "object 0 (mesh): got ior 1.5 of material 'glass', allowed ior 1 "
        f"(this mesh is not watertight: 2 triangles have the edge of vertices 0 and 1, wound the same way; {NEEDS})",
    ),
    "cube with a fin": (
        CUBE.replace("- kind", "- «kind")
        .replace("[0, 1, 1]]", "[0, 1, 1], [2, 2, 2]]")
        .replace("[3, 4, 7]]", "[3, 4, 7], [0, 1, 8]]"),
        "object 0 (mesh): got ior 1.5 of material 'glass', allowed ior 1 "
        f"(this mesh is not watertight: 3 triangles have the edge of vertices 0 and 1, not 2; {NEEDS})",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", OPEN)
def test_an_open_shape_that_refracts_is_an_error_at_the_object(only_error: Only, name: str) -> None:
    objects, message = OPEN[name]
    assert only_error(traced(objects)) == message


def test_all_open_shapes_are_reported_at_once(errors_of: Callable[..., list[Any]]) -> None:
    objects = "".join(text.replace("«", "") for text, _ in OPEN.values())
    assert len(errors_of(traced(objects))) == len(OPEN)


CLOSED = {
    "sphere": "  - {kind: sphere, center: [0, 0, 0], radius: 1, material: glass}\n",
    "box": "  - {kind: box, min: [0, 0, 0], max: [1, 1, 1], material: glass}\n",
    "capped cylinder": "  - {kind: cylinder, base: [0, 0, 0], top: [0, 1, 0], radius: 1, material: glass}\n",
    "half-space": "  - {kind: plane, point: [0, 0, 0], normal: [0, 1, 0], material: glass}\n",
    "cube": CUBE,
    "cube, its corners not shared": CUBE.replace("[0, 1, 1]]\n", "[0, 1, 1], [0, 0, 0], [1, 1, 0], [1, 0, 0]]\n").replace(
        "[0, 2, 1]", "[8, 9, 10]"
    ),
    "cube with a collapsed triangle": CUBE.replace("[0, 2, 1]", "[0, 2, 1], [0, 0, 1]"),
}


@pytest.mark.parametrize("name", CLOSED)
def test_a_closed_shape_may_refract(load: Load, name: str) -> None:
    assert load(traced(CLOSED[name])).warnings == ()


DISC = "  - {kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 1, material: m}\n"


def test_an_open_shape_may_be_transparent_with_index_1(load: Load) -> None:
    assert load(spec("raytraced", material="ior: 1, transparency: 0.5, transmission: 1", objects=DISC)).warnings == ()


@pytest.mark.parametrize("material", ["ior: 1.5", "ior: 1.5, transmission: 1"])
def test_an_open_shape_has_no_other_index_even_where_it_is_opaque(only_error: Only, material: str) -> None:
    message = only_error(spec("raytraced", material=material, objects=DISC.replace("{kind", "«{kind")))
    assert "got ior 1.5 of material 'm', allowed ior 1 (a disc encloses nothing" in message, message


def test_a_mesh_that_refracts_and_faces_inwards_is_warned_of(load: Load) -> None:
    turned = CUBE
    for face in ("[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6]",
                 "[3, 0, 4], [3, 4, 7]"):  # fmt: skip
        for triangle in face.strip("[]").split("], ["):
            a, b, c = triangle.split(", ")
            turned = turned.replace(f"[{triangle}]", f"<{a}, {c}, {b}>")
    turned = turned.replace("<", "[").replace(">", "]")
    expected = "object 0 (mesh): its triangles face inwards, so its index 1.5 is that of what is around it"
    assert warnings_of(load, traced(turned)) == [f"spec.yaml:11:5: {expected}"]
    assert warnings_of(load, traced(turned.replace("material: glass", "material: m"))) == []


def test_the_signed_volume_of_a_mesh_does_not_depend_on_where_it_is() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    for offset, unit in ((0.0, 1.0), (5.0, 4.0), (1e6, 2.0**19)):  # the unit: the largest coordinate's power of two
        got = signed_volume(TriangleMesh(vertices + offset, faces))
        assert got == pytest.approx(1 / 6 / unit**3, rel=1e-12)
        assert signed_volume(TriangleMesh(vertices + offset, faces[:, ::-1])) == pytest.approx(-got, rel=1e-12)


def test_a_swept_index_is_checked_for_every_case(only_error: Only) -> None:
    disc = "  - {kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 1, material: m}\n"
    text = spec("raytraced", material="ior: 1, transparency: 0.5, transmission: 1", objects=disc)
    message = only_error(text + "sweep: {n: {path: materials.m.ior, values: [1, «1.25]}}\n")
    assert message.startswith("object 0 (disc): got ior 1.25 of material 'm', allowed ior 1 (a disc encloses nothing;")


def test_an_edge_that_four_triangles_share_is_not_watertight() -> None:
    # two tetrahedra with one edge in common
    vertices = [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]]
    one = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]]
    other = [[0, 1, 4], [0, 5, 1], [1, 5, 4], [0, 4, 5]]
    for faces in (one, other):
        assert open_edge(TriangleMesh(np.array(vertices, float), np.array(faces))) is None
    assert open_edge(TriangleMesh(np.array(vertices, float), np.array(one + other))) == (0, 1, 2, 2)


# --- raytraced: warnings ----------------------------------------------------------------------------------------------


def warnings_of(load: Load, text: str) -> list[str]:
    return [str(warning) for warning in load(text).warnings]


def test_transparency_without_transmission_is_warned_of_at_its_value(load: Load) -> None:
    text = spec("raytraced", material="transparency: 0.25")
    expected = "transparency 0.25 with transmission 0: it lets no light through, so it casts a full shadow"
    assert warnings_of(load, text) == [f"spec.yaml:8:21: {expected}"]
    for material in ("transparency: 0.25, transmission: [0, 0, 1]", "transmission: 1", "transparency: 0"):
        assert warnings_of(load, spec("raytraced", material=material)) == []


def _pair(a: str, b: str) -> str:
    return traced(f"  - {{{a}, material: glass}}\n  - {{{b}, material: glass}}\n")


BALL = "kind: sphere, center: [0, 0, 0], radius: 1"
BLOCK = "kind: box, min: [-1, -1, -1], max: [1, 1, 1]"
POOL = "kind: plane, point: [0, 0, 0], normal: [0, 1, 0]"
OVERLAPPING = {
    "spheres": (BALL, "kind: sphere, center: [1.9, 0, 0], radius: 1"),
    "one sphere in the other": (BALL, "kind: sphere, center: [0.1, 0, 0], radius: 0.5"),
    "boxes": (BLOCK, "kind: box, min: [0.9, 0.9, 0.9], max: [2, 2, 2]"),
    "a box in the other": (BLOCK, "kind: box, min: [-0.5, -0.5, -0.5], max: [0.5, 0.5, 0.5]"),
    "sphere through a face": (BLOCK, "kind: sphere, center: [1.9, 0, 0], radius: 1"),
    "sphere over a corner": (BLOCK, "kind: sphere, center: [1.5, 1.5, 1.5], radius: 0.9"),
    "moved sphere": (BALL, "kind: sphere, center: [0, 0, 0], radius: 1, transform: [{scale: 2}, {translate: [2.9, 0, 0]}]"),
    "turned sphere": (BALL, "kind: sphere, center: [9, 0, 0], radius: 1, transform: [{rotate: {axis: [0, 1, 1], degrees: 31}},"
                            " {translate: [-7.5, -2, 2]}, {scale: 0.3}]"),
    "box turned by a quarter": (BLOCK, "kind: box, min: [0, 0, 0], max: [9, 1, 1], transform: "
                                       "[{rotate: {axis: [0, 0, 1], degrees: 90}}, {translate: [1.5, -5, 0]}]"),
    "sphere in the water": (POOL, "kind: sphere, center: [0, 0.9, 0], radius: 1"),
    "box in the water": (POOL, "kind: box, min: [0, -0.1, 0], max: [1, 1, 1]"),
}  # fmt: skip


@pytest.mark.parametrize("name", OVERLAPPING)
def test_transparent_objects_that_overlap_are_warned_of(load: Load, name: str) -> None:
    for pair in (OVERLAPPING[name], OVERLAPPING[name][::-1]):
        (warning,) = warnings_of(load, _pair(*pair))
        assert "objects 0 (" in warning, warning
        assert "overlap and let light through" in warning, warning
        assert warning.startswith("spec.yaml:12:5: "), warning


APART = {
    "touching spheres": (BALL, "kind: sphere, center: [2, 0, 0], radius: 1"),
    "spheres whose bounds overlap": (BALL, "kind: sphere, center: [1.5, 1.5, 0], radius: 1"),
    "touching boxes": (BLOCK, "kind: box, min: [1, -1, -1], max: [2, 1, 1]"),
    "sphere beside a corner": (BLOCK, "kind: sphere, center: [1.6, 1.6, 1.6], radius: 1"),
    "sphere on a box": (BLOCK, "kind: sphere, center: [0, 2, 0], radius: 1"),
    "sphere on the water": (POOL, "kind: sphere, center: [0, 1, 0], radius: 1"),
    "a slab of two planes": (POOL, "kind: plane, point: [0, -1, 0], normal: [0, -1, 0]"),
    "a disc through a sphere": (BALL, "kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 5"),
}


@pytest.mark.parametrize("name", APART)
def test_objects_that_do_not_overlap_are_not_warned_of(load: Load, name: str) -> None:
    text = _pair(*APART[name])
    if "disc" in name:
        text = text.replace("ior: 1.5", "ior: 1")
    assert warnings_of(load, text) == []


def test_an_opaque_object_in_glass_is_not_warned_of(load: Load) -> None:
    inner = "kind: sphere, center: [0, 0, 0], radius: 0.5"
    assert warnings_of(load, traced(f"  - {{{BALL}, material: glass}}\n  - {{{inner}, material: m}}\n")) == []


def test_many_transparent_spheres_are_compared_quickly(load: Load) -> None:
    rows = "".join(
        f"  - {{kind: sphere, center: [{3 * x}, {3 * y}, 0], radius: 1, material: glass}}\n" for x in range(40) for y in range(20)
    )
    assert warnings_of(load, traced(rows)) == []
