"""Model `opengl`: the tracer against the fixed-function formulas in plain NumPy, on random scenes."""

from __future__ import annotations

import random

import numpy as np
import pytest

import equilux_oracle
from equilux_tracer import Tracer
from support import plain_raytraced
from support.edges import on_edge
from support.random_scenes import case_of, random_spec

ALLOWED_ABS = ALLOWED_REL = 1e-9
"""The plain evaluation rounds hit points to 2^-53 of coordinates below 10; normals amplify that by 1/N·V, highlights by √s."""


def random_opengl(seed, **arguments):
    """A random scene with light colours and a viewer. Exponents stay in the API's range, [0, 128]."""
    rng = random.Random(f"opengl {seed}")
    spec = random_spec(seed, **{"exponents": (1.0, 128.0), **arguments})
    spec |= {"model": "opengl", "viewer": rng.choice(["local", "infinite"])}
    for light in spec["lights"].values():
        light |= {share: [rng.uniform(0, 1) for _ in range(3)] for share in ("ambient", "diffuse", "specular")}
    return spec


@pytest.mark.parametrize("seed", range(16))
def test_random_scenes_agree_with_the_formulas(seed):
    case = case_of(random_opengl(seed, fov_deg=None if seed % 3 == 0 else (20.0, 120.0)))
    film_xy = equilux_oracle.pixel_centers(case.scene.film)
    tracer = Tracer(case)
    got, (expected, _) = tracer.evaluate(film_xy, ["radiance"])["radiance"], plain_raytraced.radiance(case, film_xy)
    keep = ~on_edge(tracer, film_xy)
    assert keep.mean() > 0.98, keep.mean()
    apart = np.abs(got - expected) / (ALLOWED_ABS + ALLOWED_REL * np.abs(expected))
    apart[~keep] = 0
    worst = int(np.argmax(apart.max(axis=1)))
    assert apart.max() <= 1, f"tracer {got[worst]}, plain {expected[worst]} at {film_xy[worst]}, viewer {case.scene.viewer}"


@pytest.mark.parametrize("exponents", [(1.0, 128.0), (0.1, 0.9), (0.0, 0.0)], ids=["above 1", "below 1", "zero"])
def test_stated_rounding_holds_against_the_oracle_and_is_not_idle(exponents):
    """Edges apart, every pixel is within both bounds, and some within a factor of ten of the tracer's."""
    reached = 0.0
    for seed in range(100, 110):
        spec = random_opengl(seed, fov_deg=[None, (20.0, 60.0), (100.0, 150.0)][seed % 3])
        for material in spec["materials"].values():
            material["exponent"] = random.Random(seed).uniform(*exponents)
        case = case_of(spec)
        true, bound = equilux_oracle.radiance_with_bound(case)
        got = Tracer(case).render(["radiance", "rounding"])
        apart, allowed = np.abs(got["radiance"] - true), got["rounding"] + bound
        wrong = (apart > allowed).any(axis=2)
        rows, columns = np.nonzero(wrong)
        edge = on_edge(Tracer(case), np.stack([columns, rows], axis=1) + 0.5) if len(rows) else np.zeros(0, bool)
        assert edge.all(), f"{case.name}: {apart[wrong][~edge][0]} apart, allowed {allowed[wrong][~edge][0]}"
        reached = max(reached, float((apart[~wrong] / np.maximum(got["rounding"][~wrong], 1e-300)).max()))
    print(f"\n{exponents}: {reached:.2g} of the stated rounding")
    assert reached > 0.1, f"only {reached} of the stated rounding was ever reached"
