"""What the script says: the scene in Mitsuba's words, only what it requires, nothing that a spec's author could slip in."""

from __future__ import annotations

import ast
import json
import math

import numpy as np
import pytest

from equilux.adapter import Unsupported
from equilux_adapters.mitsuba import ADAPTER, capabilities, translate, unit
from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_adapters.mitsuba.shapes import similarity
from equilux_scenes import model
from equilux_scenes.case import Case
from support.mitsuba import case_of_text
from support.random_scenes import case_of

SPEC = {
    "equilux": 1,
    "name": "small",
    "about": "One panel, one ball.",
    "model": "reflection-equation",
    "camera": {"projection": "perspective", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 90},
    "film": {"width": 40, "height": 20},
    "lights": {
        "panel": {"kind": "rectangle", "corner": [1, 2, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2], "radiance": [3, 2, 1]}
    },
    "materials": {"clay": {"diffuse": [0.6, 0.3, 0.1]}},
    "objects": [{"kind": "sphere", "center": [0.25, 0, 0], "radius": 0.5, "material": "clay"}],
}

SPOT = {"kind": "spot", "position": [0, 2, 0], "direction": [0, -2, 0], "intensity": 6, "cone_half_angle_deg": 20}

SCENE = """\
def scene() -> dict[str, Any]:
    surface_clay = lambert((0.6, 0.3, 0.1))
    return {
        "type": "scene",
        "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 1},
        "light_0": {"type": "rectangle", "to_world": placed((1, 0, 0), (0, 0, 1), (0, -1, 0), (2, 2, 1)), \
"emitter": {"type": "area", "radiance": bands(3, 2, 1)}, "bsdf": black()},  # panel
        "object_0": {"type": "sphere", "center": [0.25, 0, 0], "radius": 0.5, "bsdf": surface_clay},
    }


def picture() -> dict[str, Any]:
    view = View(
        eye=(0, 0, 3), target=(0, 0, 0), up=(0, 1, 0),
        half_height=np.tan(np.radians(90) / 2), width=40, height=20, near=1.9073486328125e-06,
    )
    settings = {"samples": 64, "repeats": 32, "emission": {}, "soft_shadows": True}
    return render(mi.load_dict(scene(), optimize=False), view, **settings)
"""


def script(**changes: object) -> str:
    program = ADAPTER.translate(case_of(SPEC | changes), MitsubaKnobs())
    text = program.files[program.entry].decode()
    ast.parse(text)
    return text


def lines_with(text: str, word: str) -> list[str]:
    """Of the scene, not of the functions below it."""
    return [line.strip() for line in text[: text.index("def picture")].splitlines() if word in line]


def light(**light: object) -> dict[str, object]:
    return {"lights": {"key": light}}


def shape(**shape: object) -> dict[str, object]:
    return {"objects": [{"material": "clay", **shape}]}


def test_the_scene_comes_first_and_reads_like_one():
    text = script()
    start = text.index("def scene()")
    assert text[start : start + len(SCENE)] == SCENE
    assert text.startswith("# small\n# One panel, one ball.\n")


def test_a_script_holds_the_functions_it_uses_and_no_others():
    plain, glossy = script(), script(materials={"clay": {"diffuse": 0.1, "specular": 0.2, "exponent": 9}})
    assert "class PhongClassic" not in plain
    assert "class Lamp" not in plain
    assert "class PhongClassic" in glossy
    defined = {node.name for node in ast.parse(plain).body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    used = {node.id for node in ast.walk(ast.parse(plain)) if isinstance(node, ast.Name)}
    assert {"scene", "picture", "View", "render", "lambert"} <= defined
    assert not {name for name in ("phong", "lamp") if name in used & defined}


def test_a_spec_author_cannot_slip_in_code():
    names = {"lights": {"a\nimport os": SPEC["lights"]["panel"]}, "about": "x\nimport os\r\u2028import sys"}
    text = script(**names)
    assert not [line for line in text.splitlines() if line.strip().startswith("import os")]
    materials = {"x = 1; y": {"diffuse": 0.1}, "x___1__y": {"diffuse": 0.2}}
    objects = [{**SPEC["objects"][0], "material": name} for name in materials]
    named = lines_with(script(materials=materials, objects=objects), "= lambert(")
    assert [line.split(" = ")[0] for line in named] == ["surface_x___1__y", "surface_x___1__y_"]


@pytest.mark.parametrize(
    ("material", "written"),
    [
        ({"diffuse": [3, 0, 0.5]}, "lambert((3, 0, 0.5))"),
        ({"diffuse": 0.1, "specular": 0.5, "exponent": 4, "brdf": "lambert"}, "lambert((0.1, 0.1, 0.1))"),
        ({"specular": 0.5, "exponent": 4}, 'phong("phong-classic", (0, 0, 0), (0.5, 0.5, 0.5), 4)'),
        ({"specular": 0.5, "exponent": 4, "brdf": "phong-cosine"}, 'phong("phong-cosine", (0, 0, 0), (0.5, 0.5, 0.5), 4)'),
    ],
)
def test_a_lobe_is_registered_only_where_there_is_one(material, written):
    assert lines_with(script(materials={"clay": material}), "surface_clay = ") == [f"surface_clay = {written}"]


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (
            {"kind": "point", "position": [1, 2, 3], "intensity": 6},
            '{"type": "point", "position": [1, 2, 3], "intensity": bands(6, 6, 6)}',
        ),
        (
            {"kind": "point", "position": [1, 2, 3], "intensity": 6, "attenuation": {"quadratic": 2}},
            '{"type": "point", "position": [1, 2, 3], "intensity": bands(3, 3, 3)}',
        ),
        (
            {"kind": "point", "position": [1, 2, 3], "intensity": 6, "attenuation": {"linear": 2}},
            "lamp(position=(1, 2, 3), intensity=(6, 6, 6), attenuation=(0, 2, 0))",
        ),
        (
            SPOT | {"exponent": 3},
            "lamp(position=(0, 2, 0), intensity=(6, 6, 6), attenuation=(0, 0, 1), "
            "direction=(0, -2, 0), half_angle_deg=20, exponent=3)",
        ),
        (
            {"kind": "directional", "direction": [0, -2, 0], "irradiance": [1, 2, 3]},
            '{"type": "directional", "direction": [0, -1, 0], "irradiance": bands(1, 2, 3)}',
        ),
        ({"kind": "environment", "radiance": 2}, '{"type": "constant", "radiance": bands(2, 2, 2)}'),
        (
            {"kind": "sphere", "center": [0, 2, 0], "radius": 0.3, "radiance": 2},
            '{"type": "sphere", "center": [0, 2, 0], "radius": 0.3, '
            '"emitter": {"type": "area", "radiance": bands(2, 2, 2)}, "bsdf": black()}',
        ),
    ],
)
def test_lights_are_mitsubas_own_where_it_has_them(given, expected):
    assert lines_with(script(**light(**given)), '"light_0"') == [f'"light_0": {expected},  # key']


def test_a_spot_without_an_exponent_is_mitsubas_with_no_falloff():
    (line,) = lines_with(script(**light(**SPOT)), '"light_0"')
    assert '"type": "spot"' in line
    assert '"cutoff_angle": 20, "beam_width": 20' in line


def test_delta_lights_alone_are_not_sampled_and_not_repeated():
    text = script(**light(kind="point", position=[1, 2, 3], intensity=6))
    assert '"bsdf_samples": 0' in text
    assert '"samples": 1, "repeats": 1' in text
    assert '"samples": 64, "repeats": 32' in script()


def test_background_and_emission_light_nothing_and_are_added_where_seen():
    text = script(background=[1, 2, 3], materials={"clay": {"diffuse": 0.1, "emission": [4, 5, 6]}})
    assert '"emission": {0: (4, 5, 6)}' in text
    assert '"background": (1, 2, 3)' in text
    assert not lines_with(text, "constant")


def test_a_stretched_sphere_is_an_instance_and_one_scaled_alike_is_not():
    (object_line,) = lines_with(script(**shape(kind="sphere", center=[0, 0, 1], radius=1, transform=[{"scale": 2}])), "object_0")
    assert '"center": [0, 0, 2], "radius": 2' in object_line
    stretched = shape(kind="sphere", center=[0, 0, 0], radius=1, transform=[{"scale": [1, 2, 3]}])
    assert lines_with(script(**stretched), "shapegroup")
    assert similarity(np.diag([1.0, 2.0, 3.0, 1.0])) is None
    assert similarity(np.diag([2.0, -2.0, 2.0, 1.0])) == pytest.approx(2.0, abs=1e-15)


def test_a_capped_cylinder_is_three_shapes_and_an_open_one_is_one():
    cylinder = {"kind": "cylinder", "base": [0, 0, 0], "top": [0, 1, 0], "radius": 0.2}
    assert len(lines_with(script(**shape(**cylinder)), '"object_0')) == 3
    assert len(lines_with(script(**shape(**cylinder, capped=False)), '"object_0')) == 1


def test_a_plane_is_a_disc_around_the_foot_of_the_eye_as_large_as_the_plane_is_wanted():
    (line,) = lines_with(script(**shape(kind="plane", point=[7, -1, 9], normal=[0, 2, 0])), "object_0")
    assert '"type": "disk"' in line
    assert "(0, -1, 3), 3000000)" in line


MESH = """
equilux: 1
name: mesh
model: reflection-equation
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}
film: {width: 2, height: 1}
lights: {sky: {kind: environment, radiance: 1}}
materials: {clay: {diffuse: 0.3}}
objects:
  - {kind: mesh, material: clay, vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces: [[0, 1, 2]],
     transform: [{translate: [0, 0, 5]}]}
"""


def test_a_mesh_is_a_file_beside_the_script():
    program = ADAPTER.translate(case_of_text(MESH), MitsubaKnobs())
    content = program.files["mesh_0.ply"]
    vertices = np.frombuffer(content[content.index(b"end_header\n") + 11 :][:36], dtype="<f4").reshape(3, 3)
    assert vertices.tolist() == [[0, 0, 5], [1, 0, 5], [0, 1, 5]]
    assert 'beside("mesh_0.ply"), "face_normals": True' in program.files["scene.py"].decode()


@pytest.mark.parametrize("lights", range(1, 12))
def test_samples_share_out_evenly_among_the_lights_and_need_no_rounding(lights):
    scene = case_of(SPEC | {"lights": {f"l{k}": SPEC["lights"]["panel"] for k in range(lights)}}).scene
    for wanted in (1, 2, 10, 64, 1000):
        count = translate.sample_count(scene, wanted)
        rows = math.isqrt(count)  # as multijitter.cpp has it
        assert count >= wanted
        assert count % lights == 0
        assert rows * math.ceil(count / rows) == count
        assert count <= 2 * wanted + lights * (lights + 2), f"{count} for {wanted}"


def test_what_mitsuba_lacks_is_named(monkeypatch):
    without = {name: value for name, value in capabilities.CAPABILITIES.items() if name != "shape.sphere"}
    monkeypatch.setattr(translate, "CAPABILITIES", without)
    with pytest.raises(Unsupported) as caught:
        script()
    assert caught.value.missing_features == ["shape.sphere"]


def test_other_models_are_named_as_missing():
    phong = {**SPEC, "model": "phong", "lights": {"key": {"kind": "point", "position": [1, 2, 3], "intensity": 1}}}
    with pytest.raises(Unsupported) as caught:
        ADAPTER.translate(case_of(phong), MitsubaKnobs())
    assert caught.value.missing_features == ["model.phong"]


# --- the unit of length -----------------------------------------------------------------------------------------------


def ball_at(metre: float, **changes: object) -> Case:
    """A ball seen from 3 of its own metres, under a light whose attenuation has every term, and a mesh."""
    lamp = {"constant": 1, "linear": 1 / metre, "quadratic": 1 / metre**2}
    mesh = {"vertices": [[0, 0, 0], [metre, 0, 0], [0, metre, 0]], "faces": [[0, 1, 2]]}
    camera = {"projection": "perspective", "eye": [0, 0, 3 * metre], "target": [0, 0, 0], "fov_y_deg": 30}
    lights = {"key": {"kind": "point", "position": [0, 2 * metre, 0], "intensity": 6, "attenuation": lamp}}
    ball = {"kind": "sphere", "center": [metre / 4, 0, 0], "radius": metre / 2, "material": "clay"}
    moved = [{"translate": [0, metre, 0]}, {"rotate": {"axis": [0, 2, 0], "degrees": 30}}]
    objects = [ball, {"kind": "mesh", "material": "clay", "transform": moved} | mesh]
    return case_of_text(json.dumps(SPEC | {"camera": camera, "lights": lights, "objects": objects} | changes))


def scripts(case: Case) -> tuple[str, bytes, dict[str, object]]:
    """The script without its head, the mesh, and what the budget is made from."""
    program = ADAPTER.translate(case, MitsubaKnobs())
    text = program.files[program.entry].decode()
    return text[text.index("def scene") :], program.files["mesh_1.ply"], dict(program.data)


@pytest.mark.parametrize("exponent", [-30, -20, -1, 5, 20, 30])
def test_a_world_a_power_of_two_as_large_is_the_same_in_the_scripts_unit(exponent):
    like = 1.0 if exponent < 0 else 16.0  # what is too small is made 2 to 4 units large, what is too large 32 to 64
    expected, found = scripts(ball_at(like / 2 if exponent < 0 else like)), scripts(ball_at(2.0**exponent))
    assert found == expected


def test_the_script_says_what_its_unit_is_where_it_is_not_the_metre():
    assert "Lengths are metres." in script()
    program = ADAPTER.translate(ball_at(2.0**-20), MitsubaKnobs())
    assert "Lengths are in units of 2^-19 m (Q9)." in program.files[program.entry].decode()


def test_a_far_light_does_not_make_the_scene_small():
    far = {"key": {"kind": "sphere", "center": [0, 1.5e11, 0], "radius": 7e8, "radiance": 2e7}}
    assert '"radius": 0.5' in scripts(ball_at(1.0, lights=far))[0]


def test_lengths_that_single_precision_cannot_hold_together_are_refused():
    far = {"key": {"kind": "sphere", "center": [0, 1e4, 0], "radius": 1, "radiance": 1}}
    with pytest.raises(Unsupported, match=r"3e-09 m and of 1e\+04 m"):
        scripts(ball_at(1e-9, lights=far))


@pytest.mark.parametrize(
    ("emitter", "least"),
    [
        ({"kind": "sphere", "center": [0, 2, 0]}, 3 * 2.0**-11),
        ({"kind": "disc", "center": [0, 2, 0], "normal": [0, -1, 0]}, 3 * 2.0**-30 / math.sqrt(math.pi)),
    ],
)
def test_an_emitter_whose_light_single_precision_would_lose_is_refused_and_named(emitter, least):
    def lights(radius: float) -> dict[str, object]:
        return {"lights": {"speck": emitter | {"radius": radius, "radiance": 1}}}

    script(**lights(1.01 * least))
    with pytest.raises(Unsupported, match="speck") as caught:
        script(**lights(0.99 * least))
    assert caught.value.missing_features == [f"light.{emitter['kind']}"]


def test_a_rectangle_counts_by_its_area():
    thin = {"kind": "rectangle", "corner": [0, 2, 0], "edge_u": [1, 0, 0], "radiance": 1}
    script(lights={"thread": thin | {"edge_v": [0, 0, 1e-9]}})
    with pytest.raises(Unsupported, match="thread"):
        script(lights={"thread": thin | {"edge_v": [0, 0, 1e-18]}})


def test_every_length_of_the_model_is_put_into_the_scripts_unit():
    """The model says of each of its numbers what it is measured in."""
    parts = [member for member in vars(model).values() if isinstance(member, type) and issubclass(member, model.Part)]
    fields = [(part, name, field.description or "") for part in parts for name, field in part.model_fields.items()]
    found = {name for _, name, text in fields if text.endswith(("etres.", "metres; the middle of the film."))}
    assert found - {"vertices"} == unit.LENGTHS
