"""Directional-hemispherical reflectance ρ(θ_i) = ∫ f_r cosθ_r dω_r over the hemisphere, dimensionless.

Lambert: π K_diff. The Phong lobe about R, clipped by the horizon, with α the angle from R and x = cos^{p+1} α:

    J(θ) = ∫ (R·V)^p (N·V) dω = 1/(p+1) ∫_0^1 A(α(x)) dx,
    A(α) = 2π cosθ cosα                                     where the whole ring about R is above the surface, α ≤ π/2 − θ
         = 2 (φ₀ cosθ cosα + sinθ sinα sinφ₀)               elsewhere, φ₀ = arccos(−cotθ cotα)

(the integral over the ring's azimuth done in closed form). phong-cosine: ρ = π K_diff + K_spec J; phong-classic: K_spec J / cosθ.
At normal incidence J = 2π/(p+2). The half-vector lobe has
dω_r = 4 (L·H) dω_H and is integrated over H in two dimensions, exactly to the horizon.
Each value comes with the difference of two orders of quadrature as its estimated error.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from equilux.brdf.lobes import Brdf, Floats

_ORDERS = (48, 96)
_HALF_ORDERS = ((32, 32), (64, 64))


def reflectance(brdf: Brdf, theta_i_rad: npt.ArrayLike) -> tuple[Floats, Floats]:
    """ρ and its estimated error, each shaped as `theta_i_rad`, angles of incidence in [0, π/2).

    Raises ValueError outside of that: a ray along the surface does not arrive.
    """
    theta = np.asarray(theta_i_rad, np.float64)
    if not np.all((theta >= 0) & (theta < np.pi / 2)):
        raise ValueError(f"angle of incidence: got {theta!r}, allowed [0, π/2)")
    diffuse = np.pi * brdf.diffuse
    if brdf.kind == "lambert" or brdf.specular == 0:
        return np.full(theta.shape, diffuse), np.zeros(theta.shape)
    if brdf.kind == "half-vector":
        coarse, fine = (_half_vector_lobe(theta.ravel(), brdf.exponent, *orders) for orders in _HALF_ORDERS)
    else:
        coarse, fine = (_phong_lobe(theta.ravel(), brdf.exponent, order) for order in _ORDERS)
    scale = brdf.specular / (1.0 if brdf.kind == "phong-cosine" else np.cos(theta))
    return diffuse + scale * fine.reshape(theta.shape), np.abs(scale * (fine - coarse).reshape(theta.shape))


@lru_cache
def _gauss(order: int) -> tuple[Floats, Floats]:
    """Nodes and weights on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return (nodes + 1) / 2, weights / 2


def _phong_lobe(theta: Floats, exponent: float, order: int) -> Floats:
    """J(θ), (n,). Split where the ring touches the horizon; t³-like maps take the sting out of the roots at both ends."""
    nodes, weights = _gauss(order)
    t, jacobian = nodes**3 * (10 - 15 * nodes + 6 * nodes**2), 30 * nodes**2 * (1 - nodes) ** 2
    power = exponent + 1
    split = np.sin(theta)[:, None] ** power  # x at α = π/2 − θ
    total = np.zeros(len(theta))
    for low, high in ((split, np.ones_like(split)), (np.zeros_like(split), split)):
        x = low + (high - low) * t
        with np.errstate(divide="ignore"):
            cos_a = np.exp(np.log(x) / power)
        total += np.sum(_ring(theta[:, None], cos_a) * (high - low) * jacobian * weights, axis=1)
    return total / power


def _ring(theta: Floats, cos_a: Floats) -> Floats:
    """A(α): ∫ max(0, N·V) dφ around the ring at angle α from R."""
    sin_a = np.sqrt(np.maximum(0.0, 1 - cos_a**2))
    level, swing = np.cos(theta) * cos_a, np.sin(theta) * sin_a
    ratio = np.divide(level, swing, out=np.full(np.broadcast_shapes(level.shape, swing.shape), np.inf), where=swing > 0)
    half_width = np.arccos(np.clip(-ratio, -1.0, 1.0))
    area: Floats = 2 * (half_width * level + swing * np.sin(half_width))
    return area


def _half_vector_lobe(theta: Floats, exponent: float, polar_order: int, azimuth_order: int) -> Floats:
    """∫ max(0, N·H)^p (N·V) dω_V over V above the surface, (n,).

    V is above where 2 (L·H)(N·H) > N·L. With u the angle of H to N and φ about it, that is a stretch of φ from 0 (and its mirror
    image) whose end is known, so that each integral is over a smooth function; u runs to where the stretch vanishes, split where
    it stops being the whole turn.
    """
    azimuth, azimuth_weights = _gauss(azimuth_order)
    nodes, weights = _gauss(polar_order)
    total = np.empty(len(theta))
    for i, angle in enumerate(theta):
        # cos_out at φ = 0 is cos(2u − θ) and at φ = π it is cos(2u + θ)
        cuts = (0.0, (np.pi / 2 - angle) / 2, (np.pi / 2 + angle) / 2)
        # for a sharp lobe most of it lies near 0: the first stretch is cut once more where u^2 p = 30
        near = min(cuts[1], np.sqrt(30 / (exponent + 1)))
        far = min(cuts[2], max(near, np.sqrt(60 / (exponent + 1))))
        ends = sorted({0.0, near, cuts[1], far, cuts[2]})
        total[i] = sum(_half_band(angle, exponent, a, b, (nodes, weights), (azimuth, azimuth_weights)) for a, b in pairwise(ends))
    return total


def _half_band(
    theta: float, exponent: float, low: float, high: float, polar: tuple[Floats, Floats], azimuth: tuple[Floats, Floats]
) -> float:
    """The part of `_half_vector_lobe` with u in [low, high]; ends are smoothed, the roots of the stretch's end sit there."""
    t, t_weights = polar
    u = (low + (high - low) * t**2 * (3 - 2 * t))[:, None]
    du = (high - low) * 6 * t * (1 - t) * t_weights
    cos_u, sin_u = np.cos(u), np.sin(u)
    level, swing = np.cos(theta) * cos_u, np.sin(theta) * sin_u  # L·H = level + swing cosφ
    needed = np.cos(theta) / (2 * cos_u)
    with np.errstate(divide="ignore", invalid="ignore"):
        end = np.arccos(np.clip(np.where(swing > 0, (needed - level) / swing, np.where(level >= needed, -1.0, 1.0)), -1.0, 1.0))
    s, s_weights = azimuth
    phi = end * s[None, :]
    along = level + swing * np.cos(phi)
    ring = 2 * end[:, 0] * ((4 * along * np.maximum(0.0, 2 * along * cos_u - np.cos(theta))) @ s_weights)
    return float(np.sum(ring * cos_u[:, 0] ** exponent * sin_u[:, 0] * du))
