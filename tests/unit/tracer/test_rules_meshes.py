"""Changed rules of meshes: which way an interpolated normal points, and light that is worked out at vertices only."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from equilux_tracer.shading_rules import ShadingRules
from support import plain_rules
from support.random_scenes import case_of

CORNERS = np.array([[-2, -1.5, 0.3], [2.2, -1, -0.4], [0.2, 1.8, 0.1]])
NORMALS = np.array([[-0.3, -0.2, 0.93], [0.4, -0.1, 0.9], [0.1, 0.5, 0.86]])
NORMALS /= np.linalg.norm(NORMALS, axis=1, keepdims=True)
EYE = np.array([0.3, -1.0, 6.0])
MATERIAL = {"diffuse": [0.5, 0.4, 0.3], "specular": 0.6, "exponent": 9, "emission": 0.01}
LIGHTS = {
    "lamp": {"kind": "point", "position": [1, 2, 3], "intensity": [8, 9, 10]},
    "sun": {"kind": "directional", "direction": [0.5, 0.1, -1], "irradiance": 0.7},
}
SPEC = {"kind": "mesh", "vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]], "normals": "smooth", "material": "m"}


def triangle_case(model, normals, *others, corners=CORNERS, eye=EYE, lights=LIGHTS, material=MATERIAL):
    spec = {
        "equilux": 1,
        "name": "triangle",
        "model": model,
        "camera": {"projection": "perspective", "eye": eye.tolist(), "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 30},
        "film": {"width": 30, "height": 30},
        "lights": lights,
        "materials": {"m": material, "black": {}},
        "objects": [SPEC, *others],
    }
    case = case_of(spec)
    return Case(case.name, case.scene, case.scene_name, meshes={0: TriangleMesh(corners, np.array([[0, 1, 2]]), normals)})


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def barycentric(points):
    """Weights of the corners, by linear equations."""
    return np.linalg.lstsq(np.vstack([CORNERS.T, np.ones(3)]), np.vstack([points.T, np.ones(len(points))]), rcond=None)[0].T


def at_corners(case, model, normals, sign=1):
    formula = plain_rules.blinn if model == "opengl" else plain_rules.phong
    return plain_rules.terms(case, formula, [0, 0, 0], CORNERS, sign * normals, unit(EYE - CORNERS))


@pytest.mark.parametrize("model", ["phong", "opengl", "raytraced", "reflection-equation"])
@pytest.mark.parametrize("smooth", [True, False], ids=["smooth", "flat"])
def test_vertex_lighting_interpolates_what_leaves_the_vertices(model, smooth):
    face = unit(np.cross(CORNERS[1] - CORNERS[0], CORNERS[2] - CORNERS[0]))
    normals = NORMALS if smooth else np.tile(face, (3, 1))
    case = triangle_case(model, NORMALS if smooth else None)
    tracer = Tracer(case, rules=ShadingRules(vertex_lighting=True))
    got = tracer.render(["radiance", "diffuse", "specular", "object_id", "position"])
    seen = got["object_id"] == 0
    assert seen.sum() > 100
    weights = barycentric(got["position"][seen])
    corners = at_corners(case, model, normals)
    for name, value in corners.items():
        expected = np.tensordot(weights, value, axes=1)
        np.testing.assert_allclose(got[name][seen], expected, rtol=1e-11, atol=1e-13, err_msg=name)  # NumPy's linear equations
    unchanged = Tracer(case).render()["radiance"]
    assert np.abs(unchanged - got["radiance"])[seen].max() > 0.01


def test_shadows_are_those_of_the_vertices():
    # a lid over the first corner only, seen by no ray of the camera's
    towards_lamp = unit(np.array([1, 2, 3]) - CORNERS[0])
    lid = {"kind": "sphere", "center": (CORNERS[0] + 0.1 * towards_lamp).tolist(), "radius": 0.01, "material": "black"}
    lights = {"lamp": LIGHTS["lamp"]}
    case = triangle_case("raytraced", NORMALS, lid, lights=lights)
    got = Tracer(case, rules=ShadingRules(vertex_lighting=True)).render(["radiance", "object_id", "position"])
    seen = got["object_id"] == 0
    corners = at_corners(case, "raytraced", NORMALS)["radiance"]
    corners[0] = MATERIAL["emission"]
    expected = barycentric(got["position"][seen]) @ corners
    np.testing.assert_allclose(got["radiance"][seen], expected, rtol=1e-11)


def test_other_shapes_are_shaded_as_always():
    ball = {"kind": "sphere", "center": [0, 0, 1], "radius": 0.8, "material": "m"}
    case = triangle_case("phong", NORMALS, ball)
    got = Tracer(case, rules=ShadingRules(vertex_lighting=True)).render(["radiance", "object_id"])
    on_ball = got["object_id"] == 1
    np.testing.assert_allclose(got["radiance"][on_ball], Tracer(case).render()["radiance"][on_ball], rtol=1e-13)


def test_vertex_lighting_of_what_a_mirror_shows():
    # V of each vertex goes to where the mirrored ray came from
    mirror = {"kind": "plane", "point": [0, 0, -3], "normal": [0, 0, 1], "material": "mirror"}
    spec = triangle_case("raytraced", NORMALS).scene.model_dump(mode="json", exclude_none=True)
    lights = {"lamp": {"kind": "point", "position": [0.5, 0, -2.5], "intensity": 9}}
    below = {"equilux": 1, "name": "mirrored", "model": "raytraced", "camera": spec["camera"], "film": {"width": 1, "height": 1},
             "lights": lights, "materials": {"m": MATERIAL, "mirror": {"reflection": 1}}, "objects": [SPEC, mirror]}  # fmt: skip
    eye, aim = np.array([0, -2.5, -1.5]), np.array([0.1, -1.3, -3.0])  # by way of the mirror up to the triangle
    below["camera"] = {"projection": "perspective", "eye": eye.tolist(), "target": aim.tolist(), "up": [0, 0, 1], "fov_y_deg": 5}
    case = case_of(below)
    case = Case(case.name, case.scene, case.scene_name, meshes={0: TriangleMesh(CORNERS, np.array([[0, 1, 2]]), NORMALS)})
    got = Tracer(case, rules=ShadingRules(vertex_lighting=True)).render()["radiance"][0, 0]

    direction = unit((aim - eye) * [1, 1, -1])
    plane_normal = np.cross(CORNERS[1] - CORNERS[0], CORNERS[2] - CORNERS[0])
    hit = aim + direction * (plane_normal @ (CORNERS[0] - aim)) / (plane_normal @ direction)
    weights = barycentric(hit[None])
    assert weights.min() > 0, f"the ray misses the triangle: {weights}"
    corners = plain_rules.terms(case, plain_rules.phong, [0, 0, 0], CORNERS, -NORMALS, unit(aim - CORNERS))["radiance"]
    np.testing.assert_allclose(got, (weights @ corners)[0], rtol=1e-11)


# --- which side N is on -------------------------------------------------------------------------------------------------

TILTED = unit(np.array([[0.0, 0.9, 0.44]] * 3))


def matt(normals, eye, **rules):
    """Under a sun along −z: N·L is the third component of N."""
    lights = {"sun": {"kind": "directional", "direction": [0, 0, -1], "irradiance": 1.0}}
    case = triangle_case("phong", normals, eye=np.array(eye), lights=lights, material={"diffuse": 1.0})
    return Tracer(case, rules=ShadingRules(**rules)).render()["radiance"][15, 15, 0]


def test_stored_normals_as_they_are():
    assert matt(-NORMALS, EYE) > 0.5
    assert matt(-NORMALS, EYE, normal_side="as-given") == 0
    assert matt(NORMALS, EYE * [1, 1, -1]) == 0
    assert matt(NORMALS, EYE * [1, 1, -1], normal_side="as-given") > 0.5


def test_normals_that_face_the_viewer_though_the_triangle_does_not():
    # N·Ng > 0 but N·V < 0: seen from −y, just above the triangle's plane
    eye = [0, -6, 2.0]
    z = TILTED[0, 2]
    np.testing.assert_allclose(matt(TILTED, eye), z, rtol=1e-13)
    assert matt(TILTED, eye, normal_side="facing-viewer") == 0
    np.testing.assert_allclose(matt(TILTED, EYE, normal_side="facing-viewer"), z, rtol=1e-13)
    np.testing.assert_allclose(matt(TILTED, eye, normal_side="facing-viewer", normals_reversed=True), z, rtol=1e-13)


def test_the_signature_tells_where_n_turns():
    # N·V passes 0 inside the triangle, which the model's N does not notice
    lights = {"sun": {"kind": "directional", "direction": [0, 0, -1], "irradiance": 1.0}}
    normals = unit(np.array([[0.0, 0.9, 0.1], [0.0, 0.9, 0.1], [0.0, -0.2, 0.9]]))
    case = triangle_case("phong", normals, eye=np.array([0, -3.0, 2.0]), lights=lights, material={"diffuse": 1.0})

    def signatures(**rules):
        out = Tracer(case, rules=ShadingRules(**rules)).render(["signature", "object_id"])
        return len(np.unique(out["signature"][out["object_id"] == 0]))

    assert signatures(normal_side="facing-viewer", highlight_ungated=True) == signatures(highlight_ungated=True) + 1
