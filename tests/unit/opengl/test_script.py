"""What the script says: the scene in OpenGL's words, only what the scene requires, nothing that a spec's author could slip in."""

from __future__ import annotations

import ast
import subprocess
import sys

import numpy as np
import pytest

from equilux.adapter import Unsupported
from equilux_adapters.opengl import ADAPTER
from equilux_adapters.opengl.knobs import OpenGLKnobs
from support.opengl import run
from support.random_scenes import case_of
from support.vtk import corpus_case

SPEC = {
    "equilux": 1,
    "name": "small",
    "about": "One light, one ball.",
    "model": "opengl",
    "camera": {"projection": "perspective", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 90},
    "film": {"width": 40, "height": 20},
    "lights": {"key": {"kind": "point", "position": [1, 2, 3], "intensity": [8, 5, 2]}},
    "materials": {"clay": {"diffuse": [0.6, 0.3, 0.1]}},
    "objects": [{"kind": "sphere", "center": [0.25, 0, 0], "radius": 0.5, "material": "clay"}],
}

SCENE = """\
def scene() -> Scene:
    view = View(
        **look_at(eye=(0, 0, 3), target=(0, 0, 0), up=(0, 1, 0)),
        half_height=np.tan(np.radians(90) / 2),
        width=40, height=20,
    )

    surface_clay = Surface(diffuse=(0.6, 0.3, 0.1))

    lights = [
        Light(diffuse=(8, 5, 2), position=(1, 2, 3), attenuation=(0, 0, 1)),  # key
    ]
    objects = [
        (drawn(view, BALL, triangle_px=1), surface_clay),  # objects[0]
    ]
    return Scene(view, lights, objects)
""".replace("BALL", "sphere(view, center=(0.25, 0, 0), radius=0.5, segments=64, grazing=False)")


def script(**changes: object) -> str:
    program = ADAPTER.translate(case_of(SPEC | changes), OpenGLKnobs(tessellation=64))
    text = program.files[program.entry].decode()
    ast.parse(text)
    return text


def scene(text: str) -> str:
    return text[text.index("def scene()") : text.index("\n\n\n", text.index("def scene()")) + 1]


def test_the_scene_of_a_small_script_reads_like_this():
    assert scene(script()) == SCENE


def test_every_quantity_of_the_scene_is_in_the_script():
    text = scene(
        script(
            ambient=[0.1, 0.2, 0.3],
            background=[1.5, 0, 0],
            viewer="infinite",
            lights={
                "sun": {"kind": "directional", "direction": [0, -1, 0], "irradiance": [1, 2, 3], "diffuse": [2, 1, 0.5]},
                "lamp": {
                    "kind": "spot", "position": [0, 2, 0], "direction": [0, -1, 0], "intensity": [4, 4, 4],
                    "ambient": [0.5, 0, 0], "specular": [0, 1, 0], "cone_half_angle_deg": 20, "exponent": 4,
                    "attenuation": {"constant": 1, "linear": 0.5},
                },
            },
            materials={"clay": {"specular": [0.5, 0.25, 0.125], "exponent": 20, "ambient": [1, 1, 1], "emission": [1, 0, 0]}},
        )
    )
    for statement in (
        "Light(diffuse=(2, 2, 1.5), specular=(1, 2, 3), direction=(0, -1, 0)),  # sun",
        "Light(ambient=(2, 0, 0), diffuse=(4, 4, 4), specular=(0, 4, 0), position=(0, 2, 0), direction=(0, -1, 0), "
        "attenuation=(1, 0.5, 0), cutoff_deg=20, exponent=4),  # lamp",
        "Surface(ambient=(1, 1, 1), specular=(0.5, 0.25, 0.125), emission=(1, 0, 0), shininess=20)",
        "return Scene(view, lights, objects, ambient=(0.1, 0.2, 0.3), background=(1.5, 0, 0), local_viewer=False)",
    ):
        assert statement in text, f"missing: {statement}\n{text}"


def test_a_scene_without_a_highlight_has_no_word_of_one():
    assert "specular" not in scene(script())
    assert "shininess" not in scene(script(materials={"clay": {"diffuse": [1, 1, 1], "exponent": 30}}))


@pytest.mark.parametrize("kind", ["sphere", "rectangle"])
def test_a_script_holds_the_functions_of_its_own_shapes_only(kind):
    shapes = {
        "sphere": {"center": [0, 0, 0], "radius": 1},
        "rectangle": {"corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]},
    }
    text = script(objects=[{"kind": kind, "material": "clay", **shapes[kind]}])
    defined = {node.name for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}
    assert defined & set(shapes) == {kind}
    assert not defined & {"read_mesh", "set_back"}


def test_translation_is_the_same_every_time_and_imports_no_opengl():
    assert script() == script()
    code = (
        "import sys; from equilux_adapters.opengl import ADAPTER; from equilux_adapters.opengl.knobs import OpenGLKnobs\n"
        "from equilux_scenes.loader import corpus_folder, load_scenes\n"
        "(file,) = load_scenes([next(corpus_folder().rglob('opengl-all-terms.scene.yaml'))])\n"
        "ADAPTER.translate(file.cases[0], OpenGLKnobs()); print([name for name in sys.modules if name.startswith('OpenGL')])"
    )
    ran = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60)
    assert ran.stdout.strip() == "[]"


def test_names_and_texts_of_the_author_stay_comments():
    evil = 'x\n"""\nraise SystemExit(1)\u2028\x00#'
    text = script(
        about=evil,
        lights={evil: SPEC["lights"]["key"]},
        materials={evil: {"diffuse": [1, 1, 1]}},
        objects=[SPEC["objects"][0] | {"material": evil}],
    )
    assert not [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Raise) and "SystemExit" in ast.dump(node)]


@pytest.mark.parametrize(
    ("changes", "feature"),
    [
        ({"materials": {"clay": {"specular": [1, 1, 1], "exponent": 129}}}, "material.specular"),
        (
            {"lights": {"lamp": {
                "kind": "spot", "position": [0, 2, 0], "direction": [0, -1, 0], "intensity": [5, 5, 5], "cone_half_angle_deg": 20,
                "exponent": 200,
            }}},
            "light.spot-exponent",
        ),
    ],
)  # fmt: skip
def test_an_exponent_beyond_the_api_is_unsupported_and_named(changes, feature):
    spec = SPEC | changes | {"model": "phong"}
    with pytest.raises(Unsupported, match="OpenGL has 0 to 128") as caught:
        ADAPTER.translate(case_of(spec), OpenGLKnobs())
    assert caught.value.missing_features == [feature]


def test_a_model_without_a_cause_for_its_lack_is_unsupported():
    spec = SPEC | {"model": "reflection-equation"}
    with pytest.raises(Unsupported) as caught:
        ADAPTER.translate(case_of(spec), OpenGLKnobs())
    assert caught.value.missing_features == ["model.reflection-equation"]


def test_run_by_itself_a_script_leaves_the_same_picture(tmp_path):
    result = run(corpus_case("opengl-light-shares"), tmp_path)
    ran = subprocess.run(
        [sys.executable, "scene.py"], cwd=result.folder, check=False, capture_output=True, text=True, timeout=120
    )
    assert ran.returncode == 0, ran.stderr
    assert np.array_equal(np.load(result.folder / "image.npy"), result.image)
