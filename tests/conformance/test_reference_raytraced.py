"""Random `raytraced` scenes: the tracer against an independent evaluation of the formulas in plain NumPy, and its stated rounding
against the oracle.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import equilux_oracle
from equilux_oracle.precise import evaluate_at
from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_tracer import Tracer
from support import plain_raytraced
from support.edges import on_edge
from support.random_raytraced import moved, random_raytraced
from support.random_scenes import case_of

ALLOWED_ABS = ALLOWED_REL = 1e-8
"""The plain evaluation rounds each hit to 2^-53 of coordinates below 10; a bounce off a small ball multiplies that by
up to 20."""

GROUPS = {
    "all sorts": {},
    "five bounces": {"recursion": (5, 5), "objects": (6, 8)},
    "mirrors only": {"glass": False, "recursion": (1, 5)},
    "clear glass, lights behind play no part": {"behind": False, "recursion": (3, 5)},
    "shadows of the transparent": {"recursion": (0, 1), "shadows": ("attenuate",)},
    "transparent without shadow": {"recursion": (0, 2), "shadows": ("ignore",)},
    "cylinders": {"shapes": ("cylinder", "sphere"), "recursion": (2, 5)},
    "orthographic": {"projections": ("orthographic",)},
    "in the open": {"plane": False, "recursion": (4, 5)},
}
SEEDS_PER_GROUP = 8


@pytest.mark.parametrize("group", GROUPS)
def test_random_scenes_agree_with_an_independent_evaluation(group):
    positions = edges = 0
    worst, secondary = 0.0, 0
    for seed in range(SEEDS_PER_GROUP):
        case = case_of(random_raytraced(1000 + seed, film=(32, 24), **GROUPS[group]))
        film_xy = equilux_oracle.pixel_centers(case.scene.film)
        tracer = Tracer(case)
        got = tracer.evaluate(film_xy, ["radiance", "reflected", "transmitted"])
        expected, _ = plain_raytraced.radiance(case, film_xy)
        edge = on_edge(tracer, film_xy)  # by the path signature, wherever the two agree too
        share = np.abs(got["radiance"] - expected) / (ALLOWED_ABS + ALLOWED_REL * np.abs(expected))
        share[edge] = 0
        where = int(np.argmax(share.max(axis=1)))
        both = f"reference {got['radiance'][where]}, plain {expected[where]}"
        assert (share <= 1).all(), f"{case.name}: {both} at {film_xy[where]}"
        positions, edges = positions + len(film_xy), edges + int(edge.sum())
        worst = max(worst, float(share.max()))
        secondary += int((got["reflected"] + got["transmitted"]).any(axis=1).sum())
    print(f"\n{group}: worst {worst:.2g} of what is allowed, {edges} of {positions} on edges, {secondary} with secondary rays")
    assert edges <= 1e-2 * positions, f"{edges} of {positions} were excused as edges"
    assert secondary > 0.1 * positions, f"only {secondary} of {positions} saw anything mirrored or let through"


@pytest.mark.parametrize("seed", range(4))
def test_both_evaluations_find_the_same_discontinuities(seed):
    """Where the tracer's path signature changes within a fiftieth of a pixel, the plain evaluation's own does."""
    case = case_of(random_raytraced(2000 + seed, film=(24, 18)))
    film_xy = equilux_oracle.pixel_centers(case.scene.film)
    delta = 0.02  # wide enough to meet some
    ours = on_edge(Tracer(case), film_xy, delta)
    theirs = plain_raytraced.on_edge(case, film_xy, delta, around=8)
    assert ours.any()
    # The plain one counts gates of lights that do not count as well (behind an opaque surface): the tracer's are among its own.
    missed = ours & ~theirs
    assert missed.sum() <= 1, f"tracer {ours.sum()}, plain {theirs.sum()}, only the tracer at {film_xy[missed][:5]}"


def ball_of_triangles():
    """A closed mesh: the icosahedron's twenty faces, each divided by four; its vertices and faces, wound outward."""
    golden = (1 + 5**0.5) / 2
    corners = [np.roll([0.0, sign, other * golden], turn) for turn in range(3) for sign in (-1, 1) for other in (-1, 1)]
    vertices = [v / np.linalg.norm(v) for v in corners]
    gap = min(np.linalg.norm(vertices[0] - v) for v in vertices[1:])
    near = [[np.linalg.norm(a - b) < 1.01 * gap and a is not b for b in vertices] for a in vertices]
    triples = [t for t in itertools.combinations(range(12), 3) if all(near[a][b] for a, b in itertools.combinations(t, 2))]
    faces, halves = [], {}

    def half(a, b):
        key = (min(a, b), max(a, b))
        if key not in halves:
            middle = vertices[a] + vertices[b]
            vertices.append(middle / np.linalg.norm(middle))
            halves[key] = len(vertices) - 1
        return halves[key]

    for a, b, c in triples:
        if np.linalg.det([vertices[a], vertices[b], vertices[c]]) < 0:
            b, c = c, b
        x, y, z = half(a, b), half(b, c), half(c, a)
        faces += [(a, x, z), (b, y, x), (c, z, y), (x, y, z)]
    return np.array(vertices), np.array(faces)


@pytest.mark.parametrize("normals", ["flat", "smooth"])
@pytest.mark.parametrize("material", ["glass", "bubble", "gauze", "mirror"])
def test_meshes_mirror_and_refract_like_the_formulas(material, normals):
    vertices, faces = ball_of_triangles()
    turn = {"rotate": {"axis": [1, 2, 3], "degrees": 40}}
    for seed in (4000, 4001):
        spec = random_raytraced(seed, film=(24, 18), objects=(2, 3), recursion=(3, 5))
        mesh = {"kind": "mesh", "vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]], "normals": normals, "material": material}
        spec["objects"].append({**mesh, "transform": [{"scale": [0.5, 0.4, 0.45]}, turn]})
        case = case_of(spec)
        arrays = {len(spec["objects"]) - 1: TriangleMesh(vertices, faces, vertices if normals == "smooth" else None)}
        case = Case(case.name, case.scene, case.scene_name, meshes=arrays)
        film_xy = equilux_oracle.pixel_centers(case.scene.film)
        tracer = Tracer(case)
        got, (expected, _) = tracer.evaluate(film_xy)["radiance"], plain_raytraced.radiance(case, film_xy)
        share = np.abs(got - expected) / (ALLOWED_ABS + ALLOWED_REL * np.abs(expected))
        edge = on_edge(tracer, film_xy)
        assert edge.mean() < 1e-2, edge.sum()
        share[edge] = 0
        where = int(np.argmax(share.max(axis=1)))
        assert (share <= 1).all(), f"{case.name}: reference {got[where]}, plain {expected[where]} at {film_xy[where]}"


ROUNDING_GROUPS = {
    "near the origin": {},
    "six bounces": {"recursion": (6, 6), "objects": (6, 8)},
    "sharp highlights": {"exponents": (300.0, 1000.0)},
    "a million metres from the origin": {"offset": (1e6, -1e6, 1e6)},
}


@pytest.mark.parametrize("group", ROUNDING_GROUPS)
def test_stated_rounding_holds_against_the_oracle_and_is_not_idle(group):
    """|tracer − oracle| stays below both bounds on every pixel, edges too, and gets within a factor of ten of the tracer's."""
    reached = 0.0
    for seed in range(3000, 3006):
        arguments = dict(ROUNDING_GROUPS[group])
        offset = arguments.pop("offset", (0, 0, 0))
        case = case_of(moved(random_raytraced(seed, film=(24, 18), **arguments), offset))
        assert not equilux_oracle.supports(case)
        true, bound = equilux_oracle.radiance_with_bound(case)
        got = Tracer(case).render(["radiance", "rounding"])
        apart, allowed = np.abs(got["radiance"] - true), got["rounding"] + bound
        wrong = (apart > allowed).any(axis=2)
        rows, columns = np.nonzero(wrong)
        edge = on_edge(Tracer(case), np.stack([columns, rows], axis=1) + 0.5) if len(rows) else np.zeros(0, bool)
        assert edge.all(), f"{case.name}: {apart[wrong][~edge][0]} apart, allowed {allowed[wrong][~edge][0]}"
        reached = max(reached, float((apart[~wrong] / np.maximum(got["rounding"][~wrong], 1e-300)).max()))
    print(f"\n{group}: {reached:.2g} of the stated rounding")
    assert reached > 0.1, f"only {reached} of the stated rounding was ever reached"


def billiard(limit):
    """A mirror ball in a box of mirrors, seen from inside: every bounce off the ball multiplies an error by five or so."""
    mirror = {"diffuse": 0.1, "specular": 0.1, "exponent": 20, "reflection": 1.0}
    return case_of(
        {
            "equilux": 1,
            "name": "billiard",
            "model": "raytraced",
            "recursion_limit": limit,
            "camera": {"projection": "perspective", "eye": [-0.8, 0.3, 0.6], "target": [1, 0.2, 0.1], "fov_y_deg": 60},
            "film": {"width": 12, "height": 9},
            "lights": {"lamp": {"kind": "point", "position": [-0.8, 0.6, 0.5], "intensity": 0.3}},
            "materials": {"mirror": mirror},
            "objects": [
                {"kind": "box", "min": [-1, -1, -1], "max": [1, 1, 1.1], "material": "mirror"},
                {"kind": "sphere", "center": [0, 0, 0], "radius": 0.7, "material": "mirror"},
            ],
        }
    )


def test_where_no_precision_is_enough_the_stated_rounding_says_so():
    got = Tracer(billiard(80)).render(["radiance", "rounding"])
    relative = (got["rounding"] / got["radiance"])[..., 0]
    assert relative.max() > 1e-6, f"{relative.max()} after eighty bounces"
    for row, column in ((2, 10), (2, 0), (1, 7)):
        true = float(evaluate_at(billiard(80), column + 0.5, row + 0.5).radiance[0])
        apart, stated = abs(got["radiance"][row, column, 0] - true), got["rounding"][row, column, 0]
        assert apart <= stated, f"{apart} off the value to fifty digits, stated {stated}"
    few = Tracer(billiard(20)).render(["radiance", "rounding"])
    assert (few["rounding"] < 1e-13 * few["radiance"]).all(), "after twenty it is still a double's own"
