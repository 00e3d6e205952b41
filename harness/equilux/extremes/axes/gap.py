"""Axes of gaps: how near two surfaces may come before one shadows, hides or reaches through the other wrongly."""

from __future__ import annotations

from equilux.extremes.axes.pieces import MATT, floor, orthographic, perspective, point_light, rectangle, spec, sun
from equilux.extremes.axis import Axis, Spec, decades


def _card_over_floor(gap: float, model: str) -> Spec:
    """A card as large as its height over the floor, with its shadow beside it; the film shrinks with it, the world does not."""
    return spec(
        orthographic((0, 3, 0), (0, 0, 0), 6 * gap, up=(0, 0, -1)),
        {"sun": sun((1.0, -0.5, 0.3), 3.0)},
        {"clay": MATT, "card": {"diffuse": [0.05, 0.1, 0.2]}},
        [rectangle((-2 * gap, gap, gap), (1.5 * gap, 0, 0), (0, 0, -2 * gap), "card"), floor()],
    )


def _pane_over_floor(gap: float, model: str) -> Spec:
    """Tinted glass over the floor: seen through, and a shadow of half the light below it, however near."""
    return spec(
        perspective((0.3, 2.5, 1.5), (0, 0, 0), 32),
        {"lamp": point_light((-0.5, 2, 0.5), 4.0)},
        {"clay": MATT, "pane": {"transparency": 1.0, "transmission": [0.5, 0.6, 0.7]}},
        [rectangle((-0.5, gap, 0.35), (0.8, 0, 0), (0, 0, -0.8), "pane"), floor()],
        recursion_limit=2,
    )


def _card_at_lamp(gap: float, model: str) -> Spec:
    """A card below a lamp, as large as its distance from it: its shadow on the floor stays the same."""
    return spec(
        orthographic((0.05, 3, 0.02), (0.05, 0, 0.02), 2.0, up=(0, 0, -1)),
        {"lamp": point_light((0, 1, 0), 1.0)},
        {"clay": MATT},
        [rectangle((0.1 * gap, 1 - gap, 0.3 * gap), (0.5 * gap, 0, 0), (0, 0, -0.7 * gap), "clay"), floor()],
    )


def _card_before_wall(gap: float, model: str) -> Spec:
    """A card nearer than a wall by the gap, listed after it, so that the wall wins where both are taken for equal. Another, much
    nearer, tells that nothing is turned round."""
    return spec(
        perspective((0.2, 0.1, 1), (0.2, 0.1, 0), 40),
        {},
        {"wall": {"emission": [0.9, 0.4, 0.1]}, "card": {"emission": [0.1, 0.5, 0.9]}, "near": {"emission": [0.3, 0.9, 0.4]}},
        [
            rectangle((-0.5, -0.4, 0), (1, 0.05, 0), (-0.04, 0.8, 0), "wall"),
            rectangle((-0.2, -0.15, gap), (0.45, 0.0225, 0), (-0.018, 0.36, 0), "card"),
            rectangle((0.33, -0.2, 0.2), (0.1, 0, 0), (0, 0.2, 0), "near"),
        ],
        background=0.0625,
    )


AXES = (
    Axis(
        "gap-shadow", "height of a card over a floor", "m", 1e-1, decades(-2, -12), (), _card_over_floor,
        "A card as large as its height, and its shadow; the film shrinks with both, the eye stays 3 m away.",
        "blockers nearer to the point than a shadow tolerance are missed (POV-Ray, Mitsuba)",
        models=("raytraced", "reflection-equation"),
    ),
    Axis(
        "gap-pane", "height of a pane over a floor", "m", 1e-1, decades(-2, -14), (), _pane_over_floor,
        "A tinted pane over a floor: what is below it is shadowed and seen through it.",
        "acne and leaks: the pane is missed by shadow rays or by rays that go on behind it",
        models=("raytraced",),
    ),
    Axis(
        "gap-light", "distance of a card from the lamp", "m", 1e-1, decades(-2, -12), (), _card_at_lamp,
        "A card as large as its distance below a lamp: its shadow on the floor stays the same.",
        "blockers nearer to the light than a shadow tolerance are missed (POV-Ray, Mitsuba)",
        models=("raytraced", "reflection-equation"),
    ),
    Axis(
        "gap-depth", "distance of a card from a wall behind it", "m", 1e-1, decades(-2, -14), (), _card_before_wall,
        "A card in front of a wall, seen from 1 m: it must hide the wall.",
        "depth buffers (2^-24) and depths in float32 take both for equal",
    ),
)  # fmt: skip
