"""Sensitivity to geometry: against steps made by hand, with everything but the step recomputed independently."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_tracer import Tracer, TracerError
from support import plain_phong
from support.random_scenes import case_of, changed, random_spec

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}


def changes_by_hand(case, normal_step, position_step):
    """The rule, applied to the plain evaluation: |ΔL| of every step, summed and maximised; and where no gate or cone flips."""
    tracer = Tracer(case)
    film = case.scene.film
    x, y = np.meshgrid(np.arange(film.width) + 0.5, np.arange(film.height) + 0.5)
    seen = tracer.evaluate(np.stack([x.ravel(), y.ravel()], axis=1), ["object_id", "position", "normal"])
    total = np.zeros((x.size, 3))
    smooth = np.ones(x.size, bool)
    eye = np.array(case.scene.camera.eye)
    perspective = case.scene.camera.projection == "perspective"
    _, direction = plain_phong.rays(case, np.stack([x.ravel(), y.ravel()], axis=1))
    for index in range(len(case.scene.objects)):
        here = seen["object_id"] == index
        if not here.any():
            continue
        p, n = seen["position"][here], seen["normal"][here]
        v = -direction[here] / np.linalg.norm(direction[here], axis=1, keepdims=True)
        material = case.scene.materials[case.scene.objects[index].material]

        def at(point, normal, material=material, v=v):
            to_viewer = (eye - point) / np.linalg.norm(eye - point, axis=1, keepdims=True) if perspective else v
            normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
            return plain_phong.shade(case, material, point, normal, to_viewer), gates_and_cones(case, point, normal)

        base, flags = at(p, n)
        u, w = frame(n)
        for steps, size, moves_normal in (((u, w), normal_step, True), ((u, w, n), position_step, False)):
            for t in steps:
                change = np.zeros_like(base)
                for sign in (1, -1):
                    step = sign * size * t
                    value, stepped = at(p, n + step) if moves_normal else at(p + step, n)
                    change = np.maximum(change, np.abs(value - base))
                    smooth[here] &= (stepped == flags).all(axis=1)
                total[here] += change
    return total.reshape(*x.shape, 3), smooth.reshape(x.shape)


def gates_and_cones(case, point, normal):
    """Per point: is each light in front, and does it shine here."""
    flags = []
    for light in case.scene.lights.values():
        irradiance, to_light = plain_phong.arriving(light, point)
        flags += [np.sum(normal * to_light, axis=1) > 0, irradiance.max(axis=1) > 0]
    return np.stack(flags, axis=1)


def frame(n):
    """The tracer's choice of tangents: from the axis that n is least along."""
    size = np.abs(n)
    x = (size[:, 0] <= size[:, 1]) & (size[:, 0] <= size[:, 2])
    y = ~x & (size[:, 1] <= size[:, 2])
    axis = np.stack([x, y, ~x & ~y], axis=1).astype(float)
    u = np.cross(axis, n)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    return u, np.cross(n, u)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("normal", "position"), [(1e-2, 0.0), (0.0, 1e-2), (1e-3, 1e-4)])
def test_sensitivity_is_the_sum_of_the_changes_of_full_steps(seed, normal, position):
    case = case_of(random_spec(seed, exponents=(1.0, 100.0), fov_deg=None if seed % 3 == 0 else (20.0, 90.0)))
    expected, smooth = changes_by_hand(case, normal, position)
    got = Tracer(case).sensitivity(normal, position)
    assert smooth.mean() > 0.5
    # both sides are differences of radiances below 1e2 computed in double
    np.testing.assert_allclose(got[smooth], expected[smooth], rtol=1e-9, atol=1e-11)


def test_sensitivity_at_film_positions_is_that_of_the_pixels():
    case = case_of(random_spec(4))
    tracer = Tracer(case)
    image = tracer.sensitivity(1e-3, 1e-3)
    np.testing.assert_array_equal(tracer.sensitivity(1e-3, 1e-3, film_xy=[[7.5, 3.5], [0.5, 0.5]]), image[[3, 0], [7, 0]])


def test_each_object_has_its_own_bounds():
    case = case_of(random_spec(9, objects=(4, 4)))
    tracer = Tracer(case)
    ids = tracer.render(["object_id"])["object_id"]
    everywhere = tracer.sensitivity(1e-3, 1e-4)
    for index in range(4):
        only = np.eye(4)[index]
        result = tracer.sensitivity(1e-3 * only, 1e-4 * only)
        np.testing.assert_array_equal(result[ids == index], everywhere[ids == index])
        assert (result[ids != index] == 0).all()


def test_zero_bounds_and_misses_have_no_sensitivity():
    tracer = Tracer(case_of(random_spec(9)))
    assert (tracer.sensitivity(0, 0) == 0).all()
    missed = tracer.render(["object_id"])["object_id"] < 0
    assert (tracer.sensitivity(0.1, 0.1)[missed] == 0).all()


def test_a_peak_is_seen_although_its_derivative_vanishes(make_case):
    # the eye looks straight down at a mirror-like floor, the light is above: R·V = 1, the gradient is 0, a step of 0.05 is not
    camera = {"projection": "perspective", "eye": [0, 0, 5], "target": [0, 0, 0], "fov_y_deg": 1}
    light = {"kind": "directional", "direction": [0, 0, -1], "irradiance": 1.0}
    material, film = {"specular": 1.0, "exponent": 100}, {"width": 1, "height": 1}
    case = make_case(FLOOR, lights=[light], material=material, camera=camera, film=film)
    got = Tracer(case).sensitivity(0.05, 0)[0, 0, 0]
    turned = np.cos(2 * np.arctan(0.05)) ** 100
    expected = 2 * (1 - turned)  # two tangent directions
    assert abs(got - expected) < 1e-12, f"expected {expected}, got {got}"


def test_gates_of_highlights_and_cones_are_held(make_case):
    # the sun grazes the floor from just below: no step may light the highlight
    camera = {"projection": "perspective", "eye": [0, 5, 0.05], "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 1}
    film = {"width": 1, "height": 1}
    below = {"kind": "directional", "direction": [0, 1, 0.001], "irradiance": 1.0}
    case = make_case(FLOOR, lights=[below], material={"specular": 1.0, "exponent": 1}, camera=camera, film=film)
    assert (Tracer(case).sensitivity(0.01, 0) == 0).all()
    # the diffuse term has no jump there and is let go: N·L rises from below 0 to 0.009
    case = make_case(FLOOR, lights=[below], material={"diffuse": 1.0}, camera=camera, film=film)
    got = Tracer(case).sensitivity(0.01, 0)[0, 0, 0]
    assert abs(got - 0.009) < 1e-5, f"expected about 0.009, got {got}"


@pytest.mark.parametrize("bound", [-1e-3, np.nan, np.inf])
def test_a_bound_that_is_no_bound_is_refused(bound):
    tracer = Tracer(case_of(random_spec(1)))
    with pytest.raises(TracerError, match="normal: negative or not finite"):
        tracer.sensitivity(bound, 0)
    with pytest.raises(TracerError, match=r"bounds: got shape \(77,\)"):
        tracer.sensitivity(0, np.zeros(77))


def test_doubling_the_lights_doubles_the_sensitivity():
    spec = random_spec(2)
    bright = {
        name: {k: [2 * b for b in v] if k in ("intensity", "irradiance") else v for k, v in light.items()}
        for name, light in spec["lights"].items()
    }
    once, twice = (Tracer(case_of(s)).sensitivity(1e-3, 1e-3) for s in (spec, changed(spec, lights=bright)))
    np.testing.assert_allclose(twice, 2 * once, rtol=0, atol=1e-300)  # equal, but for numbers too small to be halved
