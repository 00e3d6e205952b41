"""What the script says: the scene in VTK's words, only what the scene requires, nothing that a spec's author could slip in."""

from __future__ import annotations

import ast

import pytest

from equilux.adapter import Unsupported
from equilux_adapters.vtk import ADAPTER, capabilities, translate
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_scenes.causes import is_known
from support.random_scenes import case_of

SPEC = {
    "equilux": 1,
    "name": "small",
    "about": "One light, one ball.",
    "model": "phong",
    "camera": {"projection": "perspective", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 90},
    "film": {"width": 40, "height": 20},
    "lights": {"key": {"kind": "point", "position": [1, 2, 3], "intensity": [7.5, 5, 2.5]}},
    "materials": {"clay": {"diffuse": [0.6, 0.3, 0.1]}},
    "objects": [{"kind": "sphere", "center": [0.25, 0, 0], "radius": 0.5, "material": "clay"}],
}

PICTURE = """\
def picture() -> tuple[Array, str]:
    view = View(
        **look_at(eye=(0, 0, 3), target=(0, 0, 0), up=(0, 1, 0)),
        half_height=np.tan(np.radians(90) / 2),
        width=40, height=20,
    )

    surface_clay = vtkProperty()
    surface_clay.SetInterpolationToPhong()
    surface_clay.SetDiffuseColor(0.6, 0.3, 0.1)

    lights = [
        point_light(view, position=(1, 2, 3), intensity=(7.5, 5, 2.5), attenuation=(0, 0, 1)),  # key
    ]
    objects = [
        (sphere(view, center=(0.25, 0, 0), radius=0.5, segments=64), surface_clay),  # objects[0]
    ]
    return render(view, (0, 0, 0), lights, objects)
"""


def script(**changes: object) -> str:
    program = ADAPTER.translate(case_of(SPEC | changes), VtkKnobs(tessellation=64))
    text = program.files[program.entry].decode()
    ast.parse(text)
    return text


def picture(text: str) -> str:
    return text[text.index("def picture()") : text.index("\n\n\n", text.index("def picture()")) + 1]


def test_the_picture_of_a_small_scene_reads_like_this():
    assert picture(script()) == PICTURE


def test_every_quantity_of_the_scene_is_in_the_script():
    text = picture(
        script(
            ambient=[0.1, 0.2, 0.3],
            background=[1.5, 0, 0],
            lights={
                "sun": {"kind": "directional", "direction": [0, -1, 0], "irradiance": [1, 2, 3]},
                "lamp": {
                    "kind": "spot", "position": [0, 2, 0], "direction": [0, -1, 0], "intensity": [5, 5, 5],
                    "cone_half_angle_deg": 20, "exponent": 4, "attenuation": {"constant": 1, "linear": 0.5},
                },
            },
            materials={"clay": {"specular": [0.5, 0.25, 0.125], "exponent": 20, "ambient": [1, 1, 1], "emission": [1, 0, 0]}},
        )
    )
    for statement in (
        "directional_light(direction=(0, -1, 0), irradiance=(1, 2, 3)),  # sun",
        "position=(0, 2, 0), intensity=(5, 5, 5), attenuation=(1, 0.5, 0), direction=(0, -1, 0)",
        "cone_half_angle_deg=20, exponent=4),  # lamp",
        "surface_clay.SetAmbientColor(1.1, 0.2, 0.3)",
        "surface_clay.SetDiffuse(0)",
        "surface_clay.SetSpecularColor(0.5, 0.25, 0.125)",
        "surface_clay.SetSpecularPower(20)",
        "return render(view, (1.5, 0, 0), lights, objects)",
    ):
        assert statement in text, f"missing: {statement}\n{text}"


def test_a_scene_without_lights_has_no_word_of_light_or_highlight():
    text = script(lights={}, materials={"clay": {"emission": [1, 1, 1], "specular": [1, 1, 1], "diffuse": [1, 1, 1]}})
    for word in ("point_light", "directional_light", "spot_light", "SetSpecular", "SetDiffuseColor", "vtkLight("):
        assert word not in text, f"{word} in a scene without lights"


@pytest.mark.parametrize("kind", ["sphere", "plane", "box", "disc", "rectangle", "cylinder"])
def test_a_script_holds_the_functions_of_its_own_shapes_only(kind):
    shapes = {
        "sphere": {"center": [0, 0, 0], "radius": 1},
        "plane": {"point": [0, -1, 0], "normal": [0, 1, 0]},
        "box": {"min": [-1, -1, -1], "max": [1, 1, 1]},
        "disc": {"center": [0, 0, 0], "normal": [0, 1, 1], "radius": 1},
        "rectangle": {"corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]},
        "cylinder": {"base": [0, 0, 0], "top": [0, 1, 0], "radius": 0.3},
    }
    text = script(objects=[{"kind": kind, "material": "clay", **shapes[kind]}])
    defined = {node.name for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}
    assert defined & set(shapes) == {kind}
    assert "read_mesh" not in defined
    assert "set_back" not in defined


def test_objects_in_one_surface_are_set_back_and_others_are_not():
    card = {"kind": "rectangle", "edge_u": [1, 0, 0], "edge_v": [0, 1, 0], "material": "clay"}
    apart = script(objects=[card | {"corner": [0, 0, 0]}, card | {"corner": [0, 0, 1]}])
    together = script(objects=[card | {"corner": [0, 0, 0]}, card | {"corner": [0.5, 0.5, 0]}])
    assert "set_back" not in apart
    assert "steps=(0, 1)" in together


def test_the_script_imports_numpy_vtk_and_the_standard_library_only():
    modules = set()
    for node in ast.walk(ast.parse(script())):
        if isinstance(node, ast.ImportFrom):
            modules.add(str(node.module).partition(".")[0])
        elif isinstance(node, ast.Import):
            modules |= {alias.name.partition(".")[0] for alias in node.names}
    assert modules <= {"__future__", "collections", "ctypes", "dataclasses", "pathlib", "typing", "numpy", "vtkmodules"}


def test_names_and_texts_of_the_author_stay_comments():
    evil = 'x\n"""\nraise SystemExit(1)\u2028\x00#'
    text = script(
        about=evil,
        lights={evil: SPEC["lights"]["key"]},
        materials={evil: {"diffuse": [1, 1, 1]}, "x y": {"diffuse": [0, 1, 0]}, "x_y": {"diffuse": [0, 0, 1]}},
        objects=[SPEC["objects"][0] | {"material": material} for material in (evil, "x y", "x_y")],
    )
    code = ast.parse(text)
    assert not [node for node in ast.walk(code) if isinstance(node, ast.Raise) and "SystemExit" in ast.dump(node)]
    body = picture(text)
    for number in ("(1, 1, 1)", "(0, 1, 0)", "(0, 0, 1)"):
        assert body.count(f"SetDiffuseColor{number}") == 1, body
    assert body.count("= vtkProperty()") == 3


def test_numbers_read_back_as_the_same_numbers():
    eye = [0.1 + 0.2, 1e-17, 123456789.12345678]
    text = script(camera=SPEC["camera"] | {"eye": eye})
    call = next(
        node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "look_at"
    )
    assert list(ast.literal_eval(call.keywords[0].value)) == eye


def test_translation_is_the_same_every_time():
    assert script() == script()


def test_a_feature_that_vtk_lacks_is_named(monkeypatch):
    lacking = {key: value for key, value in capabilities.CAPABILITIES.items() if key not in ("shape.sphere", "light.point")}
    monkeypatch.setattr(translate, "CAPABILITIES", lacking)
    with pytest.raises(Unsupported) as caught:
        ADAPTER.translate(case_of(SPEC), VtkKnobs())
    assert caught.value.missing_features == ["light.point", "shape.sphere"]


@pytest.mark.parametrize(
    ("changes", "missing"),
    [
        ({"model": "reflection-equation"}, ["model.reflection-equation"]),
        ({"model": "raytraced", "materials": {"clay": {"diffuse": 0.5, "reflection": 0.5, "transparency": 0.5, "ior": 1.5}}}, []),
        ({"model": "opengl", "viewer": "infinite"}, []),
    ],
)
def test_what_has_a_cause_for_its_lack_is_drawn_as_it_is_and_the_rest_is_unsupported(changes, missing):
    case = case_of(SPEC | changes)
    if not missing:
        assert ADAPTER.translate(case, VtkKnobs()).files
        return
    with pytest.raises(Unsupported) as caught:
        ADAPTER.translate(case, VtkKnobs())
    assert caught.value.missing_features == missing


def test_a_transparent_surface_keeps_the_share_that_is_its_own():
    text = script(
        model="raytraced", materials={"clay": {"diffuse": 0.5, "specular": 0.25, "transparency": 0.75, "emission": [1, 1, 1]}}
    )
    for statement in ("DiffuseColor(0.125, 0.125, 0.125)", "SpecularColor(0.0625, 0.0625, 0.0625)", "AmbientColor(1, 1, 1)"):
        assert statement in text, f"missing: {statement}\n{picture(text)}"


def test_a_light_s_own_colours_are_written_and_only_where_it_has_some():
    text = script(model="opengl", lights={"key": SPEC["lights"]["key"] | {"ambient": [0.5, 0, 0]}})
    assert "ambient=(0.5, 0, 0), diffuse=(1, 1, 1), specular=(1, 1, 1)" in text
    assert "ambient=" not in picture(script(model="opengl"))


def test_every_cause_that_stands_for_a_lack_is_known_and_stands_for_a_feature_that_is_lacking():
    for feature, cause in ADAPTER.lack_causes.items():
        assert is_known(cause), cause
        assert ADAPTER.capabilities()[feature].level == "none", feature
