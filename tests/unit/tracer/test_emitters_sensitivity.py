"""What an error of normal or position does under an extended emitter: against the closed form of a sphere above a floor."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from equilux_scenes.case import Case
from equilux_tracer import Tracer, TracerError
from support.random_scenes import case_of

HEIGHT, RADIUS, DIFFUSE = 2.0, 0.5, 0.3
FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"}
LAMP = {"kind": "sphere", "center": [0.0, 0.0, HEIGHT], "radius": RADIUS, "radiance": 1.0}


def case(*objects: dict[str, Any], at: tuple[float, float] = (0.4, -0.3)) -> Case:
    """One pixel that looks straight at a point of the floor, from the side."""
    camera = {
        "projection": "perspective", "eye": [at[0] + 5, at[1] + 1, 1.5], "target": [*at, 0], "up": [0, 0, 1], "fov_y_deg": 0.01,
    }  # fmt: skip
    return case_of(
        {
            "equilux": 1,
            "name": "floor",
            "model": "reflection-equation",
            "camera": camera,
            "film": {"width": 1, "height": 1},
            "lights": {"lamp": LAMP},
            "materials": {"m": {"diffuse": DIFFUSE, "brdf": "lambert"}},
            "objects": [FLOOR, *objects],
        }
    )


def reflected(position: np.ndarray, normal: np.ndarray) -> float:
    """K_diff π (r/d)² cosθ."""
    toward = np.array([0, 0, HEIGHT]) - position
    d = np.linalg.norm(toward)
    return DIFFUSE * math.pi * (RADIUS / d) ** 2 * float(toward @ normal) / d / float(np.linalg.norm(normal))


def expected(at: tuple[float, float], normal: float, position: float) -> float:
    """The rule, evaluated on the closed form. Any two tangent directions: these are the x and the y axis, as the tracer's."""
    p, n = np.array([*at, 0.0]), np.array([0.0, 0.0, 1.0])
    axes = np.eye(3)
    base, total = reflected(p, n), 0.0
    for t in axes[:2]:
        total += max(abs(reflected(p, n + sign * normal * t) - base) for sign in (1, -1))
    for u in axes:
        total += max(abs(reflected(p + sign * position * u, n) - base) for sign in (1, -1))
    return total


@pytest.mark.parametrize(("normal", "position"), [(0.1, 0.0), (0.0, 0.2), (0.02, 0.03)])
def test_steps_of_full_size_do_what_the_closed_form_does(normal, position):
    at = (0.4, -0.3)
    got = Tracer(case(at=at)).sensitivity(normal, position)[0, 0]
    assert got == pytest.approx(expected(at, normal, position), rel=1e-4)


@pytest.mark.parametrize("size", [1e-9, 1e-6])
def test_small_steps_scale(size):
    """They are taken at 1e-4 and scaled down: right to the integrals' 1e-6 over it."""
    at = (0.4, -0.3)
    got = Tracer(case(at=at)).sensitivity(size, size)[0, 0, 0]
    assert got == pytest.approx(expected(at, size, size), rel=2e-2)


def test_where_a_shadow_softens_a_small_shift_counts_for_more():
    ball = {"kind": "sphere", "center": [0.32, -0.09, 0.4], "radius": 0.15, "material": "m"}
    shaded, open_ = (Tracer(case(*objects)).sensitivity(0.0, 1e-4)[0, 0, 0] for objects in ((ball,), ()))
    radiance = [Tracer(case(*objects)).render()["radiance"][0, 0, 0] for objects in ((ball,), ())]
    assert 0.1 * radiance[1] < radiance[0] < 0.99 * radiance[1], "the ball should hide a part of the lamp"
    assert shaded > 1.5 * open_


def test_an_emitter_that_is_seen_is_sensitive_to_nothing_and_has_no_bounds_of_its_own():
    ball = {"kind": "sphere", "center": [0, 0, -9], "radius": 0.1, "material": "m"}
    at_the_lamp = case_of({**case(ball).scene.model_dump(exclude_defaults=True), "camera": {
        "projection": "perspective", "eye": [5, 1, 1.5], "target": [0, 0, HEIGHT], "up": [0, 0, 1], "fov_y_deg": 0.01,
    }})  # fmt: skip
    assert not Tracer(at_the_lamp).sensitivity([0.1, 0.2], [0.1, 0.2]).any()
    with pytest.raises(TracerError, match=r"allowed one number or \(2,\)"):
        Tracer(at_the_lamp).sensitivity([0.1, 0.2, 0.3], 0.0)
