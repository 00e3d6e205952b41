"""Model `reflection-equation` on random scenes against plain NumPy: all shapes, all emitters, all BRDFs, all kinds of shadow."""

from __future__ import annotations

import random

import numpy as np
import pytest

from equilux_tracer import Tracer
from support import plain_emitters
from support.random_emitter_scenes import random_emitter_spec
from support.random_scenes import case_of


@pytest.mark.parametrize("seed", range(20))
def test_random_scenes_agree_with_plain_lattices_of_light_rays(seed):
    """Within seven standard errors (of twelve repeats: one in 100 000), and 2e-4 of the pixel, for what a lattice misses alike in
    all its repeats."""
    case = case_of(random_emitter_spec(seed))
    film, rng = case.scene.film, random.Random(seed)
    film_xy = np.array([[rng.uniform(0, film.width), rng.uniform(0, film.height)] for _ in range(10)])
    got = Tracer(case).evaluate(film_xy, ["radiance", "quadrature", "object_id"])
    for k, (x, y) in enumerate(film_xy):
        plain = plain_emitters.radiance(case, (x, y), points=509, shifts=12)
        assert got["object_id"][k] == plain.object_id
        allowed = 7 * plain.sigma + 2e-4 * plain.radiance.max() + got["quadrature"][k] + 1e-14
        difference = np.abs(got["radiance"][k] - plain.radiance)
        assert (difference <= allowed).all(), f"at ({x}, {y}): {got['radiance'][k]}, plainly {plain.radiance} ± {plain.sigma}"
