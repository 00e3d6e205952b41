"""Sensitivity under changed rules: against pictures, by the same rules, of scenes whose geometry really has moved."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from equilux_tracer.shading_rules import MODEL_RULES, ShadingRules
from support.random_scenes import case_of

EYE, TARGET = np.array([0.3, -2.0, 1.5]), np.array([0.1, 0.2, 0.0])
QUAD = np.array([[-4, -4, 0], [4, -4, 0], [4, 4, 0], [-4, 4, 0]], dtype=float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
MESH = {"kind": "mesh", "vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]], "normals": "smooth", "material": "floor"}
WALL = {"kind": "plane", "point": [0, 5, 0], "normal": [0, -1, 0.2], "material": "wall"}
ABOVE = {"kind": "point", "position": [1.0, 1.0, 4.0], "intensity": 20.0}
BELOW = {"kind": "point", "position": [0.5, 0.4, -1.0], "intensity": 10.0}
GLOSSY = {"diffuse": [0.2, 0.1, 0.05], "specular": 0.4, "exponent": 7}
CLEAR = {**GLOSSY, "reflection": [0.9, 0.5, 0.1], "transparency": 0.4, "transmission": 0.7, "ior": 1.0}
STEP = 1e-3


def floor_case(model, material, normal=(0, 0, 1), height=0.0, target=TARGET, lights=(ABOVE, BELOW), orthographic=False):
    """A floor that is a mesh, z = height, all of whose vertex normals are `normal`; it is object 0. In the raytraced model it
    mirrors a wall."""
    normal = np.asarray(normal, dtype=float)
    raytraced = model == "raytraced"
    camera = {"eye": EYE.tolist(), "target": target.tolist(), "up": [0, 0, 1]}
    camera |= {"projection": "orthographic", "height_m": 0.5} if orthographic else {"projection": "perspective", "fov_y_deg": 20}
    spec = {
        "equilux": 1,
        "name": "floor",
        "model": model,
        "camera": camera,
        "film": {"width": 1, "height": 1},
        "lights": {f"l{k}": light for k, light in enumerate(lights)},
        "materials": {"floor": material, "wall": {"diffuse": 0.5, "specular": 1.0, "exponent": 8} if raytraced else {}},
        "objects": [MESH, WALL] if raytraced else [MESH],
    }
    case = case_of(spec)
    quad = TriangleMesh(QUAD + np.array([0, 0, height]), TRIANGLES, np.tile(normal / np.linalg.norm(normal), (4, 1)))
    return Case(case.name, case.scene, case.scene_name, meshes={0: quad})


LOCAL = [
    {"half_vector": True},
    {"diffuse_two_sided": True},
    {"highlight_two_sided": True},
    {"highlight_ungated": True},
    {"highlight_cosine": True},
    {"specular_floor": 0.9},
    {"normals_reversed": True},
    {"viewer": "fixed"},
    {"viewer": "from-eye"},
    {"viewer": "from-eye", "half_vector": True},
]
RAYTRACED = [
    {"occlusion": False},
    {"transmitted_highlight": False},
    {"highlight_weighted": False},
    {"front_weighted": False},
    {"behind_weighted": False},
    {"weight_cut": 0.3},
    {"transmission_counted": False},
    {"nested_media": True},
    {"transparent_shadow": "opaque"},
    {"transmitted_ray": "none"},
    {"viewer": "fixed-first"},
    {"viewer": "from-eye-first"},
]
CASES = [(model, fields) for model in ("phong", "opengl", "raytraced") for fields in LOCAL]
CASES += [("raytraced", fields) for fields in RAYTRACED]
CASES += [("reflection-equation", fields) for fields in LOCAL if "from-eye" not in fields.values()]


def arranged(model, fields):
    """The floor's case as a function of what is moved, and the rules."""
    material = (
        CLEAR if model == "raytraced" else {**GLOSSY, "brdf": "phong-classic"} if model == "reflection-equation" else GLOSSY
    )
    orthographic = fields.get("viewer") == "from-eye"

    def case(**moved):
        return floor_case(model, material, orthographic=orthographic, **moved)

    return case, ShadingRules(**fields)


def largest_of_two(base, plus, minus):
    return np.maximum(np.abs(plus - base), np.abs(minus - base))


@pytest.mark.parametrize(("model", "fields"), CASES, ids=str)
def test_normals_that_really_turn(model, fields):
    case, rules = arranged(model, fields)

    def seen(normal=(0, 0, 1)):
        return Tracer(case(normal=normal), rules=rules).render()["radiance"][0, 0]

    expected = np.zeros(3)
    for tangent in np.eye(3)[:2]:
        expected += largest_of_two(seen(), *(seen(np.array([0, 0, 1]) + s * STEP * tangent) for s in (1, -1)))
    got = Tracer(case(), rules=rules).sensitivity([STEP] + [0] * (model == "raytraced"), 0)[0, 0]
    # the reference evaluates in double: differences of 1e-16 of radiances near 1
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(("model", "fields"), [(model, fields) for model, fields in CASES if "viewer" not in fields], ids=str)
def test_positions_that_really_move(model, fields):
    # P + δu is what a camera at the same eye sees that looks there, with the floor lifted so that it is there (a V that is not
    # P's own would turn with that camera)
    case, rules = arranged(model, fields)

    def seen(**moved):
        return Tracer(case(**moved), rules=rules).render()["radiance"][0, 0]

    expected = np.zeros(3)
    for u in np.eye(3):
        moved = [seen(target=TARGET + s * STEP * u, height=(s * STEP * u)[2]) for s in (1, -1)]
        expected += largest_of_two(seen(), *moved)
    got = Tracer(case(), rules=rules).sensitivity(0, [STEP] + [0] * (model == "raytraced"))[0, 0]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("model", ["phong", "opengl", "raytraced", "reflection-equation"])
def test_rules_that_change_nothing_change_no_sensitivity(model):
    inert = ShadingRules(opaque_behind=True)
    case, _ = arranged(model, {})
    expected, got = (Tracer(case(), rules=rules).sensitivity(STEP, STEP) for rules in (MODEL_RULES, inert))
    np.testing.assert_allclose(got, expected, rtol=1e-12)  # sums in another order


@pytest.mark.parametrize("model", ["phong", "opengl", "raytraced", "reflection-equation"])
def test_vertex_lighting_adds_up_the_changes_of_the_vertices(model):
    # under a sun, and without highlights, every vertex shows the same, and so does what lies between
    sun = {"kind": "directional", "direction": [0.1, 0.4, -1.0], "irradiance": 2.0}
    material = {"diffuse": [0.2, 0.1, 0.05]} | ({"brdf": "lambert"} if model == "reflection-equation" else {})
    case = floor_case(model, material, lights=[sun])
    bounds = [STEP] + [0] * (model == "raytraced")
    rules = ShadingRules(vertex_lighting=True)
    expected = Tracer(case).sensitivity(bounds, bounds)[0, 0]
    np.testing.assert_allclose(Tracer(case, rules=rules).sensitivity(bounds, bounds)[0, 0], expected, rtol=1e-12)
    assert expected.min() > 0


@pytest.mark.parametrize("model", ["phong", "raytraced"])
def test_vertex_lighting_counts_where_between_the_vertices_the_point_lies(model):
    # only the first vertex is lit: the picture is a ramp, whose slope times δP in two directions is the change
    lit_corner = {"kind": "spot", "position": [-4, -4, 2], "direction": [0, 0, -1], "intensity": 8, "cone_half_angle_deg": 5}
    case = floor_case(model, {"diffuse": 1.0}, lights=[lit_corner], target=np.array([0.5, -1.0, 0]))
    got = Tracer(case, rules=ShadingRules(vertex_lighting=True)).sensitivity(0, [STEP] + [0] * (model == "raytraced"))[0, 0, 0]
    # weight of (−4, −4) in the triangle (−4, −4), (4, −4), (4, 4) is (4 − x)/8; there E = 8/2² = 2
    weight = (4 - 0.5) / 8
    ramp = STEP / 8 * 2
    at_vertex = 2 * (4 / (2 - STEP) ** 2 - 1)  # of steps along N; those across are of second order
    across = 2 * 2 * (1 - (1 + STEP**2 / 4) ** -1.5)
    np.testing.assert_allclose(got, ramp + weight * (at_vertex + across), rtol=1e-8)
