"""Pictures of renderers with causes, and the evidence that a diagnosis has of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from equilux_scenes.case import Case
from equilux_tracer import Tracer
from equilux_tracer.causes import RULES, Applied, ChangedTracer, Evidence, Parameter

CHANNELS = (
    "radiance", "emission", "ambient", "light_ambient", "diffuse", "specular", "reflected", "transmitted", "object_id", "normal",
    "position",
)  # fmt: skip
BOUND = 1e-9
"""What the pictures are taken to be good for, relative to their largest value: far above rounding, far below every fault."""


def picture(case: Case) -> np.ndarray:
    """The model's own picture, (h, w, 3)."""
    return Tracer(case).render()["radiance"]


def with_cause(case: Case, cause: str, parameter: Parameter = None, reading: str = "") -> np.ndarray:
    """The picture of a renderer that has the cause, (h, w, 3)."""
    return ChangedTracer(case, [Applied(cause, parameter, reading)], RULES).render()["radiance"]


def evidence_of(case: Case, measured: np.ndarray) -> Evidence:
    """All pixels of the picture as evidence against the model."""
    model = Tracer(case).render(CHANNELS)
    film = case.scene.film
    rows, columns = np.mgrid[0 : film.height, 0 : film.width]
    film_xy = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=-1)
    flat = {name: value.reshape(len(film_xy), *value.shape[2:]) for name, value in model.items()}
    bound = np.full((len(film_xy), 3), BOUND * float(np.abs(model["radiance"]).max()))
    values = measured.reshape(-1, 3)
    diverging = (np.abs(values - flat["radiance"]) > bound).any(axis=-1)
    return Evidence(case, film_xy, values, bound, flat, diverging, measured, model["radiance"])


def estimated(case: Case, cause: str, parameter: Parameter, reading: str = "") -> Sequence[Parameter]:
    """What the rule makes of a picture with that parameter, best first."""
    evidence = evidence_of(case, with_cause(case, cause, parameter, reading))
    assert evidence.diverging.any(), f"{cause} [{parameter}] does not show on {case.name}"
    return [applied.parameter for applied in RULES[cause].estimates(Applied(cause, None, reading), evidence)]


def tried(case: Case, cause: str) -> Sequence[tuple[Parameter, str]]:
    """Parameter and reading of every hypothesis of the cause on the case."""
    return [(applied.parameter, applied.reading) for applied in RULES[cause].hypotheses(case)]


def assert_same(got: np.ndarray, expected: np.ndarray, relative: float = 1e-12) -> None:
    """Equal to rounding: the two were computed by the same formula from numbers that agree to the last digit."""
    scale = float(np.abs(expected).max())
    worst = float(np.abs(got - expected).max())
    assert worst <= relative * scale, f"differs by {worst:.3e} of values up to {scale:.3e}"
