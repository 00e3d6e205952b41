"""Random scenes against the formulas once more, in plain NumPy: no pixel off edges differs by more than 1e-9 + 1e-9 L."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from support import plain_phong
from support.random_scenes import case_of, changed, random_spec

# The plain evaluation rounds hit points to 2^-53 of coordinates below 10; normals amplify that by 1/N·V, highlights by √exponent.
ALLOWED_ABS = ALLOWED_REL = 1e-9
RING = np.array([[np.cos(a), np.sin(a)] for a in np.arange(16) * np.pi / 8])


def edges(tracer, film_xy):
    """Positions with another path signature within 1e-6 pixel: discontinuities, which double precision may put on either side."""
    centre = tracer.evaluate(film_xy, ["signature"])["signature"]
    result = np.zeros(len(film_xy), bool)
    for offset in RING * 1e-6:
        result |= tracer.evaluate(film_xy + offset, ["signature"])["signature"] != centre
    return result


def compare(case):
    film = case.scene.film
    film_xy = np.stack(np.meshgrid(np.arange(film.width) + 0.5, np.arange(film.height) + 0.5), axis=-1).reshape(-1, 2)
    tracer = Tracer(case)
    got = tracer.evaluate(film_xy, ["radiance", "object_id", "normal", "position"])
    expected, ids = plain_phong.radiance(case, film_xy)
    keep = ~edges(tracer, film_xy)
    assert keep.mean() > 0.9
    np.testing.assert_array_equal(got["object_id"][keep], ids[keep])
    error = np.abs(got["radiance"] - expected)
    beyond = (error > ALLOWED_ABS + ALLOWED_REL * np.abs(expected)).any(axis=1) & keep
    worst = int(np.argmax(np.where(beyond, error.max(axis=1), 0)))
    both = f"tracer {got['radiance'][worst]}, plain {expected[worst]} at {film_xy[worst]}"
    assert not beyond.any(), f"{both}; {beyond.sum()} pixels"


@pytest.mark.parametrize("seed", range(24))
def test_random_scenes_agree_with_the_formulas(seed):
    compare(case_of(random_spec(seed, exponents=(1.0, 1000.0), fov_deg=None if seed % 4 == 0 else (20.0, 150.0))))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("smooth", [False, True])
def test_random_meshes_agree_with_the_formulas(seed, smooth):
    rng = np.random.default_rng(seed)
    spec = random_spec(seed, objects=(1, 2), exponents=(1.0, 50.0))
    mesh = {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]], "material": "m1"}
    mesh["normals"] = "smooth" if smooth else "flat"
    turn = {"rotate": {"axis": [1, 2, 3], "degrees": 77}}
    mesh["transform"] = [{"scale": [1.2, 0.7, 1.5]}, turn, {"translate": [0.1, 0, -0.2]}]
    case = case_of(changed(spec, objects=[*spec["objects"], mesh]))
    points = rng.uniform(-0.8, 0.8, (12, 3))
    faces = np.array([rng.choice(12, 3, replace=False) for _ in range(14)])
    # normals within a hemisphere, so that no interpolated one vanishes
    normals = rng.normal(size=(12, 3))
    normals[:, 2] += 4
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    arrays = {len(case.scene.objects) - 1: TriangleMesh(points, faces, normals if smooth else None)}
    compare(Case(case.name, case.scene, case.scene_name, meshes=arrays))
