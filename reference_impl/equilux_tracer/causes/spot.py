"""Faults of spot lights: their cones and their exponents."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from equilux_scenes.case import Case
from equilux_scenes.model import Scene, SpotLight
from equilux_tracer.causes.exponent import KNOWN_CLAMPS
from equilux_tracer.causes.fits import Cones, with_round_numbers
from equilux_tracer.causes.rewrite import CheckedRule, spots, with_spots
from equilux_tracer.causes.rule import Applied, Continuous, Discrete, Evidence, Parameter

AS_POINT_LIGHT: dict[str, Any] = {"cone_half_angle_deg": 180.0, "exponent": 0.0}
"""Every direction is inside the cone, none is weaker."""
HEMISPHERE: dict[str, Any] = {"cone_half_angle_deg": 90.0, "exponent": 0.0}
"""As a point light, but nothing behind it."""

WITHOUT_A_CONE = {
    "": "a point light: neither cone nor exponent, I in all directions",
    "exponent kept": "no cone: I max(0, cos ψ)^e",
    "hemisphere": "neither cone nor exponent in front of the light, nothing behind it: I where ψ ≤ 90°",
}
"""What may be left of a spot light whose cone has no effect: reading → words."""


def _without_a_cone(spot: SpotLight, reading: str) -> dict[str, Any]:
    match reading:
        case "":
            return AS_POINT_LIGHT
        case "hemisphere":
            return HEMISPHERE
        case _:
            return _cone(spot, 180.0)


def _cone(spot: SpotLight, half_angle_deg: float) -> dict[str, Any]:
    """Another half-angle. max(0, cos)^e makes a wider one than 90° the same as 90°."""
    return {"cone_half_angle_deg": min(half_angle_deg, 180.0 if spot.exponent == 0 else 90.0)}


class _Spot(CheckedRule):
    """Base: a rule about spot lights."""

    group = "light"

    def touches(self, scene: Scene) -> bool:
        return bool(spots(scene))


class SpotIgnored(_Spot):
    """A spot light is a point light: it shines in all directions."""

    id = "spot-ignored"
    formula = ("I cos^e ψ where ψ ≤ half-angle, else 0", "I")
    readings: ClassVar[Mapping[str, str]] = WITHOUT_A_CONE

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_spots(case, lambda spot: _without_a_cone(spot, applied.reading))


class SpotConeDoubled(_Spot):
    """The cone is twice as wide: the half-angle was given where it is doubled again, or the full angle where half of it is
    asked for."""

    id = "spot-cone-doubled"
    formula = ("lit where ψ ≤ half-angle", "lit where ψ ≤ 2 half-angle")
    readings: ClassVar[Mapping[str, str]] = {
        "": "up to 180°",
        "at most 90°": "half-angles beyond 90° are taken as 90°",
        "a point light from 90° on": "where twice the half-angle is 90° or more, a point light without an exponent (VTK Q8)",
    }
    suspects = "translation"

    def change_case(self, case: Case, applied: Applied) -> Case:
        def change(spot: SpotLight) -> dict[str, Any]:
            doubled = 2 * spot.cone_half_angle_deg
            if applied.reading.startswith("a point light") and doubled >= 90:
                return AS_POINT_LIGHT
            return _cone(spot, min(doubled, 90.0) if applied.reading == "at most 90°" else doubled)

        return with_spots(case, change)


class SpotConeHalved(_Spot):
    """The cone is half as wide: the half-angle was given where the full angle is asked for."""

    id = "spot-cone-halved"
    formula = ("lit where ψ ≤ half-angle", "lit where ψ ≤ half-angle / 2")
    suspects = "translation"

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_spots(case, lambda spot: {"cone_half_angle_deg": spot.cone_half_angle_deg / 2})


class SpotExponentIgnored(_Spot):
    """The light is as strong everywhere in its cone as on its axis, as Mitsuba's own spot with equal angles is (Q7)."""

    id = "spot-exponent-ignored"
    formula = ("I cos^e ψ where ψ ≤ half-angle", "I where ψ ≤ half-angle")

    def change_case(self, case: Case, applied: Applied) -> Case:
        return with_spots(case, lambda _: {"exponent": 0.0})


class SpotExponentClamped(_Spot):
    """Spot exponents beyond a limit are taken as the limit: 128 in VTK (Q7) and in the fixed-function API (OpenGL Q6)."""

    id = "spot-exponent-clamped"
    formula = ("I cos^e ψ", "I cos^min(e, max) ψ")
    parameter = Continuous("max", "", 0.01, 1e6, "log")

    def touches(self, scene: Scene) -> bool:
        return any(spot.exponent > self.parameter.low for spot in spots(scene))

    def change_case(self, case: Case, applied: Applied) -> Case:
        most = float(applied.parameter)  # type: ignore[arg-type]
        return with_spots(case, lambda spot: {"exponent": min(spot.exponent, most)})

    def estimates(self, hypothesis: Applied, evidence: Evidence) -> Sequence[Applied]:
        largest = max(spot.exponent for spot in spots(evidence.case.scene))
        if largest <= self.parameter.low:  # under other causes nothing may be left to clamp
            return []
        cones = Cones(evidence)
        grid = np.geomspace(max(self.parameter.low, 1e-4 * largest), largest * 0.999, 60)
        best = cones.best(lambda most: cones.predicted(lambda exponent: min(exponent, most)), grid)
        known = [number for number in KNOWN_CLAMPS if number < largest]
        return [Applied(self.id, value) for value in with_round_numbers(best, known) or known[::-1]]


class SpotConeIgnored(_Spot):
    """A cone as wide as this, or wider, is no cone: the light shines backwards too, and loses its exponent. From 90° on in VTK
    (Q8)."""

    id = "spot-cone-ignored"
    formula = ("I cos^e ψ where ψ ≤ half-angle, else 0", "I in all directions where half-angle ≥ from")
    readings: ClassVar[Mapping[str, str]] = WITHOUT_A_CONE
    parameter = Discrete("from", "°")

    def values(self, case: Case, reading: str) -> Sequence[Parameter]:
        """The scene's own half-angles tell which spots are concerned; no other number makes another picture."""
        return sorted({spot.cone_half_angle_deg for spot in spots(case.scene)}, reverse=True)

    def change_case(self, case: Case, applied: Applied) -> Case:
        least = float(applied.parameter)  # type: ignore[arg-type]
        return with_spots(case, lambda spot: _without_a_cone(spot, applied.reading) if spot.cone_half_angle_deg >= least else {})
