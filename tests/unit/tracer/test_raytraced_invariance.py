"""What must not change the picture: the scene's scale and place, the number of threads, how a body is described."""

from __future__ import annotations

import copy
import threading
import time

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Cancel, Cancelled, Tracer
from support.edges import on_edge
from support.one_ray import box, plane
from support.random_raytraced import random_raytraced
from support.random_scenes import case_of

LENGTHS = {"eye", "target", "point", "center", "min", "max", "corner", "edge_u", "edge_v", "base", "top", "position", "translate"}
SIZES = {"radius", "height_m"}


def scaled(part, factor):
    """The same scene in other metres: all lengths × factor."""
    if isinstance(part, list):
        return [scaled(item, factor) for item in part]
    if not isinstance(part, dict):
        return part
    result = {}
    for key, value in part.items():
        if key in LENGTHS:
            result[key] = [factor * v for v in value]
        elif key in SIZES:
            result[key] = factor * value
        elif key == "attenuation":
            result[key] = {**value, "linear": value["linear"] / factor, "quadratic": value["quadratic"] / factor**2}
        else:
            result[key] = scaled(value, factor)
    if part.get("kind") in ("point", "spot") and "attenuation" not in part:
        result["attenuation"] = {"quadratic": 1 / factor**2}
    return result


def picture(spec, **arguments):
    return Tracer(case_of(spec)).render(["radiance", "rounding"], **arguments)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("factor", [2.0**-20, 1e-6, 1e6])
def test_the_scale_of_the_world_changes_no_more_than_rounding(seed, factor):
    spec = random_raytraced(seed)
    here, there = picture(spec), picture(scaled(spec, factor))
    apart = np.abs(here["radiance"] - there["radiance"])
    if factor == 2.0**-20:  # a power of two changes no digit
        assert apart.max() == 0, apart.max()
        return
    wrong = (apart > 1e-10).any(axis=2)  # the spec's own numbers are rounded anew, 1e-16 of each; highlights multiply that
    rows, columns = np.nonzero(wrong)
    edge = on_edge(Tracer(case_of(spec)), np.stack([columns, rows], axis=1) + 0.5) if len(rows) else np.zeros(0, bool)
    assert edge.all(), f"{apart[wrong][~edge].max()} apart at {rows[~edge][0]}, {columns[~edge][0]}"


@pytest.mark.parametrize("seed", range(3))
def test_threads_do_not_change_a_digit(seed):
    case = case_of(random_raytraced(seed, film=(48, 36)))
    names = ["radiance", "rounding", "signature", "reflected", "transmitted", "diffuse"]
    one, three = (Tracer(case).render(names, threads=threads) for threads in (1, 3))
    for name in names:
        np.testing.assert_array_equal(one[name], three[name], err_msg=name)


def closed_box():
    """The box [-1, 1]³ as a mesh: twelve triangles, wound outward."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])
    return TriangleMesh(corners, faces, None)


@pytest.mark.parametrize("offset", [0.0, 1e5])
@pytest.mark.parametrize("ior", [1.0, 1.5, 0.7])
def test_a_mesh_of_a_box_is_glass_like_the_box(ior, offset):
    surface = {"diffuse": 0.1, "specular": 0.5, "exponent": 30, "reflection": 0.1}
    glass = {**surface, "transmission": 0.9, "transparency": 0.9, "ior": ior}
    view = {"eye": [offset + 1, 2, 5 - offset], "target": [offset, 0, -offset]}
    moved = [{"rotate": {"axis": [1, 2, 3], "degrees": 30}}, {"translate": [offset, 0, -offset]}]
    pictures = []
    for solid in (box([-1, -1, -1], [1, 1, 1], "glass"), {"kind": "mesh", "vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]]}):
        spec = {
            "equilux": 1,
            "name": "glass",
            "model": "raytraced",
            "recursion_limit": 6,
            "background": 0.3,
            "camera": {"projection": "perspective", **view, "fov_y_deg": 45},
            "film": {"width": 48, "height": 36},
            "lights": {"lamp": {"kind": "point", "position": [offset + 2, 4, 1 - offset], "intensity": 20}},
            "materials": {"glass": glass, "floor": {"diffuse": 0.3, "emission": 0.1}},
            "objects": [{**solid, "material": "glass", "transform": moved}, plane([offset, -2, -offset], [0.1, 1, 0], "floor")],
        }
        case = case_of(spec)
        meshes = {0: closed_box()} if solid["kind"] == "mesh" else {}
        pictures.append(Tracer(Case(case.name, case.scene, case.scene_name, meshes=meshes)).render(["radiance"])["radiance"])
    apart = np.abs(pictures[0] - pictures[1])
    assert np.ptp(pictures[0]) > 0.1
    assert apart.max() <= 1e-12, f"{apart.max()} apart in {(apart > 1e-12).any(axis=2).sum()} pixels"


def test_a_path_that_forks_without_end_can_be_cancelled():
    # between two panes that both reflect and transmit, a limit of 200 asks for more rays than there are atoms
    spec = random_raytraced(0, film=(8, 8))
    pane = {"reflection": 1.0, "transmission": 1.0, "transparency": 0.5}
    floors = [plane([0, -k, 0], [0.01 * k, 1, 0], "pane") for k in range(1, 6)]
    spec = {**copy.deepcopy(spec), "recursion_limit": 200, "materials": {"pane": pane}, "objects": floors}
    cancel = Cancel()
    timer = threading.Timer(0.3, cancel.cancel)
    timer.start()
    started = time.monotonic()
    with pytest.raises(Cancelled):
        Tracer(case_of(spec)).render(threads=2, cancel=cancel)
    assert time.monotonic() - started < 5
