"""Directional-hemispherical reflectance ρ(θ_i) = ∫ f_r cosθ_r dω_r over the hemisphere, dimensionless.

Lambert: π K_diff. The Phong lobe about R, clipped by the horizon, with α the angle from R and x = cos^{p+1} α:

    J(θ) = ∫ (R·V)^p (N·V) dω = 1/(p+1) ∫_0^1 A(α(x)) dx,
    A(α) = 2π cosθ cosα                                     where the whole ring about R is above the surface, α ≤ π/2 − θ
         = 2 (φ₀ cosθ cosα + sinθ sinα sinφ₀)               elsewhere, φ₀ = arccos(−cotθ cotα)

(the integral over the ring's azimuth done in closed form). phong-cosine: ρ = π K_diff + K_spec J; phong-classic: K_spec J / cosθ.
At normal incidence J = 2π/(p+2). The half-vector lobe has dω_r = 4 (L·H) dω_H and is integrated over H in two dimensions.
Each value comes with the difference of two orders of quadrature as its estimated error.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from equilux.brdf.lobes import Brdf, Floats

_ORDERS = (48, 96)
_HALF_ORDERS = ((64, 96), (128, 192))


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
    """∫ (N·H)^p (N·V) dω_V over V above the surface, (n,); over H with x = cos^{p+1} of its angle to N."""
    polar, polar_weights = _gauss(polar_order)
    azimuth, azimuth_weights = _gauss(azimuth_order)
    t, jacobian = polar**2 * (3 - 2 * polar), 6 * polar * (1 - polar)
    cos_h = (t ** (1 / (exponent + 1)))[:, None]
    sin_h = np.sqrt(np.maximum(0.0, 1 - cos_h**2))
    phi = np.pi * azimuth[None, :]  # the other half is its mirror image
    total = np.empty(len(theta))
    for i, angle in enumerate(theta):
        along = np.sin(angle) * sin_h * np.cos(phi) + np.cos(angle) * cos_h  # L·H
        cos_out = 2 * along * cos_h - np.cos(angle)
        ring = np.where((along > 0) & (cos_out > 0), 4 * along * cos_out, 0.0) @ (2 * np.pi * azimuth_weights)
        total[i] = np.sum(ring * jacobian * polar_weights) / (exponent + 1)
    return total
