"""Tracers of one geometry share what the search is built of: no picture may tell."""

from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from equilux_tracer.shading_rules import ShadingRules
from support.random_scenes import case_of

RULES = ShadingRules(half_vector=True)


def mesh_case(model="phong", lift=0.0, eye=(0.5, -3, 2), flat=False, ball=0.4):
    rng = np.random.default_rng(7)
    spec = {
        "equilux": 1,
        "name": "mesh",
        "model": model,
        "camera": {"projection": "perspective", "eye": list(eye), "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 40},
        "film": {"width": 24, "height": 18},
        "lights": {"lamp": {"kind": "point", "position": [1, -1, 3], "intensity": 10}},
        "materials": {"m": {"diffuse": 0.5, "specular": 0.3, "exponent": 9}},
        "objects": [
            {"kind": "mesh", "vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]], "normals": "smooth", "material": "m"},
            {"kind": "sphere", "center": [0.7, 0, 0.3], "radius": ball, "material": "m"},
        ],
    }
    vertices = rng.uniform(-1, 1, (60, 3)) + np.array([0, 0, lift])
    normals = rng.normal(size=(60, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    mesh = TriangleMesh(vertices, np.arange(60).reshape(20, 3), None if flat else normals)
    case = case_of(spec)
    return Case(case.name, case.scene, case.scene_name, meshes={0: mesh})


def alone(case):
    gc.collect()  # whatever could be shared is gone
    return Tracer(case, rules=RULES).render()["radiance"]


@pytest.mark.parametrize("model", ["phong", "raytraced"])
def test_a_tracer_outlives_the_one_whose_boxes_it_took(model):
    case = mesh_case(model)
    expected = alone(case)
    first = Tracer(case)
    second = Tracer(case, rules=RULES)
    del first
    gc.collect()
    np.testing.assert_array_equal(second.render()["radiance"], expected)
    assert expected.max() > 0


@pytest.mark.parametrize(
    "other",
    [{"lift": 0.3}, {"eye": (0.4, -3, 2)}, {"flat": True}, {"ball": 0.8}, {"model": "raytraced"}],
    ids=lambda fields: next(iter(fields)),
)
def test_another_geometry_camera_or_model_gets_its_own(other):
    expected = alone(mesh_case(**other))
    first = Tracer(mesh_case())
    np.testing.assert_array_equal(Tracer(mesh_case(**other), rules=RULES).render()["radiance"], expected)
    assert not np.array_equal(first.render()["radiance"], expected)


def test_lights_and_materials_are_each_tracer_s_own():
    case = mesh_case()
    dark = replace(case, scene=case.scene.model_copy(update={"lights": {}}))
    first = Tracer(case)
    assert Tracer(dark).render()["radiance"].max() == 0
    assert first.render()["radiance"].max() > 0
