"""Rules of the diffuse term and of the highlight, against the scene written by hand and against the formula in plain NumPy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_scenes.loader import corpus_folder, load_scene_file
from equilux_tracer import Tracer
from support.faulty import assert_same, estimated, picture, tried, with_cause
from support.random_scenes import case_of, changed

SPEC = {
    "equilux": 1,
    "name": "two-balls",
    "model": "phong",
    "camera": {"projection": "perspective", "eye": [0.4, 0.3, 3], "target": [0, 0, 0], "fov_y_deg": 38},
    "film": {"width": 24, "height": 18},
    "ambient": [0.1, 0.2, 0.3],
    "lights": {
        "key": {"kind": "point", "position": [1.5, 2, 3], "intensity": [7, 8, 9]},
        "sun": {"kind": "directional", "direction": [1, -0.4, -0.3], "irradiance": [0.3, 0.5, 0.4]},
    },
    "materials": {
        "clay": {"diffuse": [0.6, 0.4, 0.2], "specular": [0.5, 0.4, 0.3], "exponent": 40, "ambient": 1},
        "wax": {"diffuse": [0.1, 0.3, 0.5], "specular": [0.2, 0.4, 0.3], "exponent": 300, "emission": 0.05},
    },
    "objects": [
        {"kind": "sphere", "center": [-0.5, 0, 0], "radius": 0.6, "material": "clay"},
        {"kind": "sphere", "center": [0.6, 0.2, 0.3], "radius": 0.4, "material": "wax"},
        {"kind": "plane", "point": [0, -0.7, 0], "normal": [0, 1, 0], "material": "clay"},
    ],
}
CASE = case_of(SPEC)
OPENGL = case_of(changed(SPEC, model="opengl", name="two-balls-opengl"))
DULL = {name: {**material, "exponent": 1.5} for name, material in SPEC["materials"].items()}
BACKLIT = {**SPEC["lights"], "sun": {"kind": "directional", "direction": [1, -0.4, 0.8], "irradiance": [0.9, 0.5, 0.4]}}
DULL_PHONG, DULL_OPENGL = (case_of(changed(SPEC, model=model, materials=DULL, lights=BACKLIT)) for model in ("phong", "opengl"))
ORTHOGRAPHIC = case_of(
    changed(SPEC, camera={"projection": "orthographic", "eye": [0.4, 0.3, 3], "target": [0, 0, 0], "height_m": 2.2})
)


def by_hand(**keys):
    """The case with these keys of both materials; a function is given the material's spec."""
    spec = changed(SPEC)
    for material in spec["materials"].values():
        material.update({key: value(material) if callable(value) else value for key, value in keys.items()})
    return case_of(spec)


def product(factor=1.0):
    return lambda m: [factor * s * d for s, d in zip(m["specular"], m["diffuse"], strict=True)]


@pytest.mark.parametrize(
    ("cause", "parameter", "reading", "keys"),
    [
        ("diffuse-missing", None, "", {"diffuse": 0}),
        ("highlight-missing", None, "", {"specular": 0}),
        ("exponent-clamped", 128.0, "", {"exponent": lambda m: min(m["exponent"], 128)}),
        ("exponent-scaled", 0.25, "", {"exponent": lambda m: m["exponent"] / 4}),
        ("highlight-tinted", None, "", {"specular": product()}),
        ("highlight-tinted", None, "albedo", {"specular": product(math.pi)}),
        ("highlight-tinted", None, "hue", {"specular": lambda m: product(1 / max(m["diffuse"]))(m)}),
        ("highlight-tinted", None, "diffuse instead", {"specular": lambda m: m["diffuse"]}),
    ],
)
def test_a_changed_material_is_the_material_written_by_hand(cause, parameter, reading, keys):
    got = with_cause(CASE, cause, parameter, reading)
    assert_same(got, picture(by_hand(**keys)))
    assert np.abs(got - picture(CASE)).max() > 1e-3


def by_formula(case, term):
    """L = K_emit + K_amb L_amb + Σ E term(N·L, L, V, N, material), N and P taken from the tracer."""
    seen = Tracer(case).render(["normal", "position", "object_id", "emission", "ambient", "radiance"])
    normal, position = seen["normal"], np.nan_to_num(seen["position"])
    total = seen["emission"] + seen["ambient"]
    materials = [case.scene.materials[obj.material] for obj in case.scene.objects]
    eye, target = np.array(case.scene.camera.eye), np.array(case.scene.camera.target)
    viewer = {"to eye": unit(eye - position), "fixed": np.broadcast_to(unit(eye - target), position.shape)}
    for light in case.scene.lights.values():
        if light.kind == "directional":
            to_light, arriving = np.broadcast_to(-unit(np.array(light.direction)), position.shape), np.array(light.irradiance)
        else:
            toward = np.array(light.position) - position
            to_light, arriving = unit(toward), np.array(light.intensity) / (toward**2).sum(axis=-1)[..., None]
        for index, material in enumerate(materials):
            added = term((normal * to_light).sum(axis=-1), to_light, viewer, normal, material)
            total = total + np.where((seen["object_id"] == index)[..., None], arriving * added, 0)
    return np.where((seen["object_id"] < 0)[..., None], seen["radiance"], total)


def unit(vector):
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def lobe(cosine, exponent, floor=0.0):
    return (np.maximum(floor, cosine) ** exponent)[..., None]


def mirrored(facing, to_light, viewer, normal):
    return ((2 * facing[..., None] * normal - to_light) * viewer).sum(axis=-1)


def halfway(to_light, viewer, normal):
    return (normal * unit(to_light + viewer)).sum(axis=-1)


def term(*, diffuse="front", gate=True, cosine=False, half=False, floor=0.0, viewer="to eye"):
    """The two terms of one light, each rule an option."""

    def evaluate(facing, to_light, viewers, normal, material):
        toward = np.abs(facing) if diffuse == "both" else np.maximum(0, facing)
        v = viewers[viewer]
        c = halfway(to_light, v, normal) if half else mirrored(facing, to_light, v, normal)
        shine = lobe(c, material.exponent, floor) * (np.maximum(0, facing)[..., None] if cosine else 1)
        shine = shine * ((facing > 0)[..., None] if gate else 1)
        return np.array(material.diffuse) * toward[..., None] + np.array(material.specular) * shine

    return evaluate


@pytest.mark.parametrize(
    ("case", "cause", "parameter", "reading", "rule"),
    [
        (CASE, "diffuse-two-sided", None, "", term(diffuse="both")),
        (DULL_PHONG, "diffuse-two-sided", None, "highlight too", term(diffuse="both", gate=False)),
        (CASE, "half-vector", None, "", term(half=True)),
        (OPENGL, "half-vector", None, "", term()),
        (CASE, "specular-floored", 0.97, "", term(floor=0.97)),
        (DULL_PHONG, "highlight-ungated", None, "", term(gate=False)),
        (DULL_OPENGL, "highlight-ungated", None, "", term(gate=False, half=True)),
        (CASE, "highlight-cosine", None, "", term(cosine=True)),
        (ORTHOGRAPHIC, "view-vector-from-eye", None, "", term()),
        (CASE, "view-vector-fixed", None, "", term(viewer="fixed")),
        (OPENGL, "view-vector-fixed", None, "", term(half=True, viewer="fixed")),
    ],
)
def test_a_changed_formula_is_the_formula_by_numpy(case, cause, parameter, reading, rule):
    got = with_cause(case, cause, parameter, reading)
    # p = 300 amplifies the rounding of NumPy's cosines by as much.
    assert_same(got, by_formula(case, rule), 1e-11)
    assert np.abs(got - picture(case)).max() > 1e-3


@pytest.mark.parametrize("parameter", [128.0, 200.0, 61.7, 17.0])
def test_the_clamp_of_an_exponent_is_found(parameter):
    assert estimated(CASE, "exponent-clamped", parameter)[0] == pytest.approx(parameter, rel=1e-6)


@pytest.mark.parametrize("parameter", [4.0, 0.25, 1.37, 0.1, 3.3])
def test_the_scale_of_exponents_is_found(parameter):
    assert estimated(CASE, "exponent-scaled", parameter)[0] == pytest.approx(parameter, rel=1e-6)


@pytest.mark.parametrize("parameter", [0.9, 0.3])
@pytest.mark.parametrize("exponent", [0.4, 3.0])
def test_the_floor_of_the_cosine_is_found(parameter, exponent):
    assert estimated(by_hand(exponent=exponent), "specular-floored", parameter)[0] == pytest.approx(parameter, rel=1e-6)


def test_the_floor_of_vtk_is_found():
    assert estimated(by_hand(exponent=0.1), "specular-floored", 1e-5)[0] == pytest.approx(1e-5, rel=1e-6)


def test_parameters_of_lobes_are_found_in_model_opengl():
    case = case_of(changed(SPEC, model="opengl"))
    assert estimated(case, "exponent-clamped", 128.0)[0] == pytest.approx(128, rel=1e-6)
    assert estimated(case, "exponent-scaled", 2.2)[0] == pytest.approx(2.2, rel=1e-6)


def test_where_no_highlight_of_light_in_front_tells_the_exponent_known_values_are_tried():
    """What shines through a pane from behind is no lobe about R: its estimate must not be the grid's first value."""
    (case,) = load_scene_file(corpus_folder() / "raytraced" / "transmitted-highlight.scene.yaml").cases
    assert 16.0 in estimated(case, "exponent-clamped", 16.0)
    assert 4.0 in estimated(case, "exponent-scaled", 4.0)


def test_an_exponent_of_a_million_leaves_a_clamp_to_be_found():
    assert estimated(by_hand(exponent=1e6), "exponent-clamped", 128.0)[0] == pytest.approx(128, rel=1e-3)


@pytest.mark.parametrize(
    ("case", "causes"),
    [
        (by_hand(specular=0), ["half-vector", "exponent-clamped", "exponent-scaled", "specular-floored", "highlight-ungated",
                               "highlight-cosine", "highlight-tinted", "highlight-missing", "view-vector-fixed"]),
        (case_of(changed(SPEC, lights={})), ["diffuse-missing", "diffuse-two-sided", "half-vector", "highlight-missing"]),
        (CASE, ["transmitted-highlight-missing", "transparent-highlight-unweighted", "view-vector-from-eye"]),
        (ORTHOGRAPHIC, ["view-vector-fixed"]),
        (OPENGL, ["view-vector-from-eye"]),
        (by_hand(diffuse=0), ["diffuse-missing", "diffuse-two-sided"]),
    ],
)  # fmt: skip
def test_what_cannot_change_the_picture_is_not_tried(case, causes):
    assert {cause: tried(case, cause) for cause in causes} == {cause: [] for cause in causes}


def test_a_highlight_of_white_surfaces_is_not_tinted():
    assert [reading for _, reading in tried(by_hand(diffuse=1), "highlight-tinted")] == ["albedo", "diffuse instead"]


def transparent(**what):
    glass = {"diffuse": 0.3, "specular": 0.6, "exponent": 9, "transmission": 0.8, "transparency": 0.6, "ior": 1.4}
    materials = {"clay": SPEC["materials"]["clay"], "wax": {**glass, **what}}
    lights = {**SPEC["lights"], "behind": {"kind": "point", "position": [1.2, 0.6, -3], "intensity": 9}}
    return case_of(changed(SPEC, model="raytraced", materials=materials, lights=lights))


def test_light_from_behind_makes_no_highlight_if_told_so():
    case = transparent()
    got, full = with_cause(case, "transmitted-highlight-missing"), picture(case)
    assert (got <= full + 1e-12).all()
    assert np.abs(got - full).max() > 1e-4
    # Without a highlight from in front nothing is left of it but what is diffuse.
    bare = with_cause(transparent(specular=0), "transmitted-highlight-missing")
    assert_same(bare, picture(transparent(specular=0)))


def test_an_unweighted_highlight_is_one_over_one_minus_t_as_strong():
    case = transparent()
    extra = with_cause(case, "transparent-highlight-unweighted") - picture(case)
    seen = Tracer(case).render(["specular", "normal", "position", "object_id"])
    position = np.nan_to_num(seen["position"])
    lights = [
        np.array([1.5, 2, 3]) - position,
        np.broadcast_to([-1, 0.4, 0.3], position.shape),
        np.array([1.2, 0.6, -3]) - position,
    ]
    first_hit = sum(
        np.where(((seen["normal"] * toward).sum(axis=-1) > 0)[..., None], seen["specular"][:, :, k], 0) * 0.6 / 0.4
        for k, toward in enumerate(lights)
    )
    on_glass = seen["object_id"] == 1
    assert on_glass.any()
    # What lies behind is seen through glass too: its highlights on the glass's inner side may add to that, never take away.
    assert (extra[on_glass] >= first_hit[on_glass] - 1e-12).all()
    assert np.abs(extra[on_glass] - first_hit[on_glass]).min() < 1e-12
