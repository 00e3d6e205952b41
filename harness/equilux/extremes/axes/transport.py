"""Axes of rays that go on: how often, how weakened, how little or how much bent."""

from __future__ import annotations

import math

from equilux.extremes.axes.pieces import MATT, perspective, point_light, rectangle, spec
from equilux.extremes.axis import Axis, Spec, decades

RAYTRACED = ("raytraced",)


def _mirrors(count: float, model: str) -> Spec:
    """Two mirrors that face each other and shine a little; each reflection adds the same n-th part."""
    limit = int(count)
    return spec(
        perspective((0.1, 0.2, 0), (0.3, 0.1, -1), 20),
        {},
        {
            "one": {"reflection": 1.0, "emission": 0.2 / limit},
            "other": {"reflection": 1.0, "emission": [0.6 / limit, 0.2 / limit, 0]},
        },
        [
            {"kind": "plane", "point": [0, 0, -1], "normal": [0, 0, 1], "material": "one"},
            {"kind": "plane", "point": [0, 0, 1], "normal": [0, 0, -1], "material": "other"},
        ],
        film={"width": 12, "height": 9},  # the same colour everywhere, and the cost is that of a thousand reflections a pixel
        recursion_limit=limit,
    )


def _weak_mirror(weight: float, model: str) -> Spec:
    """A mirror that reflects little of a lamp shade that shines the more: the picture stays the same."""
    return spec(
        perspective((0.1, 0.9, 2.2), (0, 0, 0.3), 38),
        {},
        {"mirror": {"reflection": weight, "emission": 0.02}, "shade": {"emission": [0.6 / weight, 0.4 / weight, 0.2 / weight]}},
        [
            rectangle((-0.8, 0, 1.4), (1.6, 0, 0), (0, 0, -2.5), "mirror"),
            {"kind": "sphere", "center": [0.2, 1.3, -0.9], "radius": 0.6, "material": "shade"},
        ],
        recursion_limit=1,
        background=0.0,
    )


def _glass_ball(excess: float, model: str) -> Spec:
    """A glass ball before a wall, n − 1 pushed; the recursion limit is just what is needed."""
    return spec(
        perspective((0.2, 0.1, 3), (0.1, 0, 0), 30),
        {"lamp": point_light((-1, 1.5, 2.5), 6.0)},
        {"glass": {"transparency": 0.9, "transmission": [0.9, 0.8, 0.7], "ior": 1 + excess, "emission": 0.01}, "wall": MATT},
        [
            {"kind": "sphere", "center": [0.2, 0, 0], "radius": 0.45, "material": "glass"},
            rectangle((-0.6, -0.5, -1), (1.2, 0, 0), (0, 1.1, 0), "wall"),
        ],
        recursion_limit=2,
        background=0.0625,
    )


def _critical(width: float, model: str) -> Spec:
    """A surface into thinner air, seen under the critical angle in the middle of a film as wide as the pushed angle."""
    angle = math.asin(1 / 1.5)
    eye = (-math.sin(angle), math.cos(angle), 0)
    across = (math.cos(angle), math.sin(angle), 0)
    return spec(
        perspective(eye, (0, 0, 0), width, up=across),
        {},
        {"thin": {"transparency": 1.0, "transmission": [0.5, 0.3, 0.1], "ior": 1 / 1.5, "emission": 0.05}},
        [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "thin"}],
        recursion_limit=2,
        background=0.5,
    )


AXES = (
    Axis(
        "recursion", "reflections between two mirrors", "", 1.0, (), decades(1, 3), _mirrors,
        "Mirrors that face each other and shine; the recursion limit is pushed, their light divided by it.",
        "limits of depth (POV-Ray's 256), stacks, sums in float32",
        models=RAYTRACED,
    ),
    Axis(
        "mirror-weight", "reflectance of a mirror", "", 1.0, decades(-1, -30), (), _weak_mirror,
        "A mirror reflects ever less of a shade that shines ever more.",
        "rays that are cut by their weight (adc_bailout)",
        models=RAYTRACED,
    ),
    Axis(
        "index-near-1", "index of refraction above 1", "", 1.0, decades(-1, -15), decades(1, 6), _glass_ball,
        "A glass ball before a wall, with the recursion that it needs and no more.",
        "indices in float32, rays through index 1 that are not counted (POV-Ray below 1e-10)",
        models=RAYTRACED,
    ),
    Axis(
        "critical-angle", "film around the critical angle", "°", 10.0, decades(0, -10), (), _critical,
        "Half of the film is reflected totally, the other is not; its width is pushed.",
        "√(1 − s²) near 0, indices in float32",
        models=RAYTRACED,
    ),
)  # fmt: skip
