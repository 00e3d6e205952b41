"""Random `raytraced` scenes: the tracer against an independent evaluation of the formulas in plain NumPy."""

from __future__ import annotations

import numpy as np
import pytest

import equilux_oracle
from equilux_tracer import Tracer
from support import plain_raytraced
from support.edges import on_edge
from support.random_raytraced import random_raytraced
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
