"""What is said of one BRDF: polar curve for a fixed incoming direction, ρ(θ), reciprocity, energy. Plain numbers, JSON-ready."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import lru_cache

import numpy as np

from equilux.brdf.lobes import Brdf, Floats, direction
from equilux.brdf.reflectance import reflectance

REFLECTANCE_DEG = tuple(float(angle) for angle in (*range(0, 90, 5), 87, 89))
"""Angles at which ρ is tabulated."""

_CURVE_POINTS = 361
_PAIRS = 4096
_STEPS_PER_BISECTION = 30
_ROUNDING = 1e-12
"""Relative error of a power of a rounded cosine away from 0, per unit of the exponent: far below any asymmetry of a formula."""


@dataclass(frozen=True)
class Reciprocity:
    """How far f_r(ω_i, ω_r) and f_r(ω_r, ω_i) are apart over pairs of directions.

    largest: |difference| relative to the larger of the two, at the worst pair, whose angles follow; 0 up to rounding: reciprocal.
    """

    reciprocal: bool
    largest: float
    theta_i_deg: float
    theta_r_deg: float
    pairs: int


@dataclass(frozen=True)
class Energy:
    """The largest ρ found, where, and from which angle on ρ > 1; null where it never is. `unbounded`: ρ grows like 1/cosθ_i."""

    conserved: bool
    largest: float
    theta_i_deg: float
    above_one_from_deg: float | None
    unbounded: bool


@dataclass(frozen=True)
class Study:
    """One BRDF examined.

    curve_deg: θ_r in the plane of incidence, −90 (the light's side) to 90 (the mirror side). curve: f_r there, 1/sr. rho,
    rho_error: ρ at rho_deg and its estimated error.
    """

    brdf: Brdf
    theta_i_deg: float
    curve_deg: tuple[float, ...]
    curve: tuple[float, ...]
    rho_deg: tuple[float, ...]
    rho: tuple[float, ...]
    rho_error: tuple[float, ...]
    reciprocity: Reciprocity
    energy: Energy

    def to_json(self) -> dict[str, object]:
        return asdict(self)


@lru_cache(maxsize=1024)
def study(brdf: Brdf, theta_i_deg: float = 45.0) -> Study:
    """Examine a BRDF for light arriving at `theta_i_deg` from the normal. Raises ValueError outside [0, 90)."""
    if not 0 <= theta_i_deg < 90:
        raise ValueError(f"angle of incidence: got {theta_i_deg!r}°, allowed [0, 90)")
    angles = np.linspace(-90.0, 90.0, _CURVE_POINTS)
    to_light = direction(np.radians(theta_i_deg), np.pi)
    curve = brdf.value(np.broadcast_to(to_light, (_CURVE_POINTS, 3)), direction(np.radians(angles)))
    rho, error = reflectance(brdf, np.radians(REFLECTANCE_DEG))
    return Study(
        brdf, theta_i_deg, _rounded(angles), _rounded(curve), REFLECTANCE_DEG, _rounded(rho), _rounded(error),
        _reciprocity(brdf), _energy(brdf, rho),
    )  # fmt: skip


def _rounded(values: Floats) -> tuple[float, ...]:
    """Nine digits: more than any plot or table shows."""
    return tuple(float(f"{value:.9g}") for value in values)


def _reciprocity(brdf: Brdf) -> Reciprocity:
    generator = np.random.default_rng(1)
    polar = np.arccos(generator.uniform(0.01, 1.0, (2, _PAIRS)))
    azimuth = generator.uniform(0.0, 2 * np.pi, (2, _PAIRS))
    there, back = direction(polar[0], azimuth[0]), direction(polar[1], azimuth[1])
    forth, reverse = brdf.value(there, back), brdf.value(back, there)
    larger = np.maximum(forth, reverse)
    apart = np.divide(np.abs(forth - reverse), larger, out=np.zeros_like(larger), where=larger > 0)
    worst = int(np.argmax(apart))
    largest = float(apart[worst])
    theta_i_deg, theta_r_deg = (float(angle) for angle in np.degrees(polar[:, worst]))
    return Reciprocity(largest < _ROUNDING * max(1.0, brdf.exponent), largest, theta_i_deg, theta_r_deg, _PAIRS)


def _energy(brdf: Brdf, rho: Floats) -> Energy:
    worst = int(np.argmax(rho))
    unbounded = brdf.kind in ("phong-classic", "half-vector") and brdf.specular > 0 and _lobe_survives_grazing(brdf)
    conserved = not unbounded and bool(np.all(rho <= 1 + 1e-12))
    return Energy(conserved, float(rho[worst]), REFLECTANCE_DEG[worst], None if conserved else _crossing(brdf, rho), unbounded)


def _lobe_survives_grazing(brdf: Brdf) -> bool:
    """Whether the lobe's integral stays above 0 as θ_i → 90°: then ρ grows like 1/cosθ_i."""
    bare = Brdf(brdf.kind, 0.0, 1.0, brdf.exponent)
    near = reflectance(bare, np.radians([89.0, 89.9]))[0]
    return bool(near[1] > 2 * near[0])


def _crossing(brdf: Brdf, rho: Floats) -> float | None:
    """The smallest angle of incidence, degrees, from which ρ > 1."""
    above = np.flatnonzero(rho > 1)
    if len(above) and above[0] == 0:
        return 0.0
    low = REFLECTANCE_DEG[above[0] - 1] if len(above) else REFLECTANCE_DEG[-1]
    high = REFLECTANCE_DEG[above[0]] if len(above) else 90 * (1 - 1e-12)
    if reflectance(brdf, np.radians(high))[0] <= 1:
        return None
    for _ in range(_STEPS_PER_BISECTION):
        middle = (low + high) / 2
        low, high = (low, middle) if reflectance(brdf, np.radians(middle))[0] > 1 else (middle, high)
    return high
