"""What the error target buys, and whether the error that is stated covers the one that was made."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from equilux_tracer import Tracer, TracerError
from support.random_emitter_scenes import random_emitter_spec
from support.random_scenes import case_of

FINE = 1e-10
STUDIO = {
    "equilux": 1, "name": "studio", "model": "reflection-equation", "film": {"width": 32, "height": 24},
    "camera": {"projection": "perspective", "eye": [0, -4, 2.5], "target": [0, 0, 0.5], "up": [0, 0, 1], "fov_y_deg": 50},
    "materials": {"m": {"diffuse": 0.3, "specular": 0.3, "exponent": 50.0}},
    "objects": [
        {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"},
        {"kind": "sphere", "center": [0.3, 0.2, 0.6], "radius": 0.4, "material": "m"},
        {"kind": "box", "min": [-1.2, -0.3, 0], "max": [-0.6, 0.3, 0.9], "material": "m"},
    ],
}  # fmt: skip
LAMPS: dict[str, dict[str, Any]] = {
    "rectangle": {"corner": [-0.5, -0.5, 2], "edge_u": [0, 1, 0], "edge_v": [1, 0, 0]},
    "sphere": {"center": [0.2, 0.1, 2], "radius": 0.4},
    "disc": {"center": [0.1, 0.2, 2], "normal": [0.1, 0, -1], "radius": 0.5},
    "environment": {},
}


def studio(kind: str) -> Any:
    return case_of({**STUDIO, "lights": {"lamp": {"kind": kind, "radiance": [1.0, 2.0, 3.0], **LAMPS[kind]}}})


def render(case: Any, error_target: float) -> dict[str, np.ndarray]:
    return Tracer(case, error_target=error_target).render(["radiance", "quadrature", "object_id"])


@pytest.mark.parametrize("kind", LAMPS)
def test_the_stated_error_covers_the_error_that_was_made_at_every_target(kind):
    """On 768 pixels each, most of a picture with two shadows, at targets from a hundredth to 1e-6."""
    case = studio(kind)
    true = render(case, FINE)
    for target in (1e-2, 1e-3, 1e-4, 1e-6):
        got = render(case, target)
        error, stated = np.abs(got["radiance"] - true["radiance"]), got["quadrature"] + true["quadrature"]
        uncovered = np.argwhere((error > stated + 1e-15).any(axis=-1))
        assert not len(uncovered), f"target {target}: at {uncovered[0]} {error.max()} is more than the stated error"


@pytest.mark.parametrize("seed", range(24))
def test_the_stated_error_covers_on_random_scenes(seed):
    case = case_of(random_emitter_spec(seed))
    true = render(case, 1e-8)
    for target in (1e-2, 1e-4, 1e-6):
        got = render(case, target)
        error, stated = np.abs(got["radiance"] - true["radiance"]), got["quadrature"] + true["quadrature"]
        uncovered = np.argwhere((error > stated + 1e-15).any(axis=-1))
        assert not len(uncovered), f"target {target}: at {uncovered.tolist()} {error.max()} is more than the stated error"


@pytest.mark.parametrize("kind", LAMPS)
@pytest.mark.parametrize("target", [1e-2, 1e-4, 1e-6])
def test_the_target_is_met_relative_to_the_light_that_nothing_hides(kind, target):
    """Where there is light at all: below 1e-6 the rounding of angles, some 1e-14, is what is left."""
    lone = {**STUDIO, "lights": {"lamp": {"kind": kind, "radiance": [1.0, 2.0, 3.0], **LAMPS[kind]}}}
    got = render(studio(kind), target)
    for number, obj in enumerate(STUDIO["objects"]):
        unblocked = render(case_of({**lone, "objects": [obj]}), 1e-8)
        on_it = (got["object_id"] == number) & (unblocked["object_id"] == 0) & (unblocked["radiance"].min(axis=-1) > 1e-6)
        share = got["quadrature"][on_it].max(axis=-1) / unblocked["radiance"][on_it].max(axis=-1)
        assert share.max() <= target + 1e-7, f"object {number}: {share.max()}"


def test_a_finer_target_states_less_and_errs_less():
    case = studio("rectangle")
    true, coarse, fine = (render(case, target) for target in (FINE, 1e-2, 1e-6))
    assert fine["quadrature"].max() < coarse["quadrature"].max() / 100
    assert np.abs(fine["radiance"] - true["radiance"]).max() < np.abs(coarse["radiance"] - true["radiance"]).max() / 100


def test_the_stated_error_is_not_absurdly_far_from_the_error_where_there_is_one():
    """In penumbrae, at a target of 1e-3: the largest stated error is within a hundred of the largest made."""
    for kind in LAMPS:
        case = studio(kind)
        true, got = render(case, FINE), render(case, 1e-3)
        made, stated = np.abs(got["radiance"] - true["radiance"]).max(), got["quadrature"].max()
        assert stated < 100 * made, f"{kind}: {stated} stated, {made} made"


def test_models_without_integrals_state_none():
    case = case_of(
        {**STUDIO, "model": "phong", "lights": {"sun": {"kind": "directional", "direction": [0, 0, -1], "irradiance": 1.0}}}
    )
    assert not render(case, 1e-3)["quadrature"].any()


@pytest.mark.parametrize("target", [0.0, -1e-3, 1.0, float("nan")])
def test_an_impossible_target_is_refused(target):
    with pytest.raises(TracerError, match="error_target: allowed a number in the open interval"):
        Tracer(studio("disc"), error_target=target)
