"""The rule that tells inside from outside by counting: against the model where it cannot differ, by Snell's law where it does."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from equilux_tracer.shading_rules import ShadingRules
from support.one_ray import close, plane, scene, sphere
from support.random_scenes import case_of

IOR = 1.1
GLASS = {"transparency": 0.5, "transmission": 1.0, "reflection": 1.0, "ior": IOR}
TILT, ANGLE = math.radians(50), math.radians(20)
TILTED = [math.sin(TILT), 0, math.cos(TILT)]
CORNERS = [[x, y, z] for z in (0, -1) for x, y in ((-50, -50), (50, -50), (50, 50), (-50, 50))]
OUTWARDS = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6], [0, 5, 1], [0, 4, 5], [1, 6, 2], [1, 5, 6], [2, 7, 3], [2, 6, 7],
            [3, 4, 0], [3, 7, 4]]  # fmt: skip


def slab(faces=OUTWARDS, normals=None):
    """A spec of a mesh, and the mesh."""
    spec = {"kind": "mesh", "file": "slab", "normals": "flat" if normals is None else "smooth", "material": "glass"}
    normals = None if normals is None else np.array(normals, np.float64)
    return spec, TriangleMesh(np.array(CORNERS, np.float64), np.array(faces), normals)


def value(*objects, eye, target, rules, **materials):
    """An object that is a pair is a mesh."""
    specs = [each[0] if isinstance(each, tuple) else each for each in objects]
    case = case_of(scene(*specs, materials={"glass": GLASS, "glow": {"emission": 1.0}, **materials}, eye=eye, target=target))
    meshes = {index: each[1] for index, each in enumerate(objects) if isinstance(each, tuple)}
    case = Case(case.name, case.scene, case.scene_name, meshes=meshes)
    return Tracer(case, rules=ShadingRules(**rules)).render()["radiance"][0, 0, 0]


def beyond_the_slab(ratio):
    """x at z = −2 of the ray that the tilted normal mirrors into the slab, and that leaves it with sin θ_out = ratio sin θ_in."""
    d, n = np.array([math.sin(ANGLE), 0, -math.cos(ANGLE)]), np.array(TILTED)
    mirrored = d - 2 * (d @ n) * n
    assert mirrored[2] < 0, "it does not enter"
    sine = ratio * mirrored[0]
    return mirrored[0] / -mirrored[2] + sine / math.sqrt(1 - sine * sine)


@pytest.mark.parametrize(("counted", "ratio"), [(False, IOR), (True, 1 / IOR)], ids=["the side", "counted"])
def test_a_ray_mirrored_to_the_wrong_side_of_its_face_enters_where_it_leaves(counted, ratio):
    dot = {"kind": "disc", "center": [beyond_the_slab(ratio), 0, -2], "normal": [0, 0, 1], "radius": 1e-6, "material": "glow"}
    normals = [TILTED] * 4 + [[0, 0, -1]] * 4
    eye, target = [-math.sin(ANGLE), 0, math.cos(ANGLE)], [0, 0, 0]
    what = {"eye": eye, "target": target, "rules": {"media_counted": counted}}
    close(value(slab(normals=normals), dot, **what), 0.25)


@pytest.mark.parametrize("wound", ["outwards", "inwards"])
@pytest.mark.parametrize("eye", [[0.3, 0.2, 1], [0.3, 0.2, -0.4]], ids=["outside", "inside"])
def test_of_one_closed_mesh_with_flat_faces_nothing_changes(wound, eye):
    faces = OUTWARDS if wound == "outwards" else [face[::-1] for face in OUTWARDS]
    floor = plane([0, 0, -2], [0, 0, 1], "floor")
    target = [1.1, 0.7, -2]
    what = {"eye": eye, "target": target, "floor": {"emission": 0.3, "reflection": 0.5}}
    counted = value(slab(faces), floor, rules={"media_counted": True}, **what)
    close(counted, value(slab(faces), floor, rules={}, **what))
    assert counted > 0


def test_of_shapes_without_interpolated_normals_media_nest_the_same_way():
    balls = [sphere([0, 0, 0], 1, "glass"), sphere([0.1, 0, 0.1], 0.5, "water"), plane([0, 0, -3], [0, 0, 1], "glow")]
    water = {"transparency": 0.8, "transmission": 0.9, "ior": 1.33}
    what = {"eye": [0.2, 0.1, 4], "target": [0.25, 0.1, 0], "water": water}
    nested = value(*balls, rules={"nested_media": True}, **what)
    close(value(*balls, rules={"media_counted": True}, **what), nested)
    assert nested > 0
