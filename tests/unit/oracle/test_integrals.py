"""Known integrals: what the pictures must add up to, by Gauss–Legendre quadrature of the oracle's own values."""

from __future__ import annotations

import math

import numpy as np
import pytest

import equilux_oracle
from equilux_oracle import evaluate

LOOKING_DOWN = {"projection": "perspective", "eye": [0, 0, 1], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 90}
FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
CUBE_FACES = [([1, 0, 0], [0, 1, 0]), ([-1, 0, 0], [0, 1, 0]), ([0, 1, 0], [0, 0, 1])]
CUBE_FACES += [([0, -1, 0], [0, 0, 1]), ([0, 0, 1], [0, 1, 0]), ([0, 0, -1], [0, 1, 0])]
QUADRATURE = 1e-12
"""The integrands are polynomials of the node, of degree below 80, for which forty nodes are exact but for rounding."""


def gauss(low, high, count=40):
    """Nodes and weights on [low, high]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return low + (high - low) * (x + 1) / 2, w * (high - low) / 2


def film_at_cosine(mu, azimuth=0.7):
    """Positions on the 8 × 8 film of a 90° view whose rays make these cosines with the axis."""
    tangent = np.sqrt(1 - mu**2) / mu
    return np.stack([4 + 4 * tangent * math.cos(azimuth), 4 - 4 * tangent * math.sin(azimuth)], axis=1)


@pytest.mark.parametrize("exponent", [0, 1, 5, 20, 60])
@pytest.mark.parametrize(("cosine", "name"), [(0, "solid angle 2π/(p+1)"), (1, "reflectance 2π/(p+2)")])
def test_the_phong_lobe_integrates_to(make_case, exponent, cosine, name):
    # A sun at the zenith: R = N everywhere, so the eye above the floor sees the whole lobe, each ray its own R·V.
    sun = {"kind": "directional", "direction": [0, 0, -1], "irradiance": 1}
    case = make_case(FLOOR, {"specular": 1, "exponent": exponent}, sun, camera=LOOKING_DOWN)
    mu, weight = gauss(0, 1)
    value = evaluate(case, film_at_cosine(mu))[:, 0]
    integral, true = 2 * math.pi * np.sum(weight * value * mu**cosine), 2 * math.pi / (exponent + 1 + cosine)
    assert abs(integral - true) <= QUADRATURE * true, f"p = {exponent}: oracle {integral}, {name} {true}"


@pytest.mark.parametrize("place", [[0, 0, 0], [0.3, -0.2, 0.1], [0, 0.5, 0]])
def test_the_flux_through_an_enclosing_sphere_is_4_pi_i(make_case, place):
    # Seen from the centre of a Lambert sphere of K = 1 and radius R, radiance is the irradiance, and dA = R² dω.
    lamp, radius = {"kind": "point", "position": place, "intensity": [1, 2, 3]}, 2.0
    flux = np.zeros(3)
    x, w = gauss(-1, 1)
    a, b = (grid.ravel() for grid in np.meshgrid(x, x))
    solid_angle = np.outer(w, w).ravel() / (1 + a**2 + b**2) ** 1.5
    for target, up in CUBE_FACES:
        view = {"projection": "perspective", "eye": [0, 0, 0], "target": target, "up": up, "fov_y_deg": 90}
        case = make_case({"kind": "sphere", "center": [0, 0, 0], "radius": radius}, {"diffuse": 1}, lamp, camera=view)
        flux += solid_angle @ evaluate(case, np.stack([4 + 4 * a, 4 - 4 * b], axis=1)) * radius**2
    true = 4 * math.pi * np.array([1, 2, 3])
    assert np.allclose(flux, true, rtol=1e-10, atol=0), f"light at {place}: oracle {flux}, 4πI {true}"


@pytest.mark.parametrize(("half_angle", "exponent"), [(20, 0), (90, 0), (60, 3), (90, 7), (10, 40)])
def test_the_flux_of_a_spot_is_that_of_its_cone(make_case, half_angle, exponent):
    # ∫ I cos^e θ dω over the cone = 2πI (1 − cos^(e+1) α)/(e + 1), light and eye both at the sphere's centre.
    spot = {"kind": "spot", "position": [0, 0, 0], "direction": [0, 0, -1], "intensity": 1, "cone_half_angle_deg": half_angle}
    view = {**LOOKING_DOWN, "eye": [0, 0, 0], "target": [0, 0, -1]}
    ball = {"kind": "sphere", "center": [0, 0, 0], "radius": 3}
    case = make_case(ball, {"diffuse": 1}, {**spot, "exponent": exponent}, camera=view)
    edge = math.cos(math.radians(half_angle))
    mu, weight = gauss(edge, 1)
    flux = 2 * math.pi * np.sum(weight * evaluate(case, film_at_cosine(mu))[:, 0]) * 9
    true = 2 * math.pi * (1 - edge ** (exponent + 1)) / (exponent + 1)
    assert abs(flux - true) <= QUADRATURE * true, f"oracle {flux}, cone {true}"


def test_a_lambert_ball_far_from_its_lamp_sends_two_thirds_of_its_zenith(make_case):
    # Full phase: lit and seen from the same side, L = E K cos θ, and the mean over the disc ∫ cos θ 2ρ dρ, ρ = sin θ, is 2/3.
    sun = {"kind": "directional", "direction": [0, 0, -1], "irradiance": 2}
    case = make_case({"kind": "sphere", "center": [0, 0, 0], "radius": 3}, {"diffuse": 0.25}, sun)
    mu, weight = gauss(0, 1)
    rho = np.sqrt(1 - mu**2)
    value = evaluate(case, np.stack([4 + 3 * rho, np.full_like(rho, 4.0)], axis=1))[:, 0]
    # 4 + 3ρ is rounded by up to 2^-51, which moves the cosine by 2^-51 ρ/3 over itself.
    apart = np.abs(value - 0.5 * mu) * mu
    assert apart.max() <= 2**-51, f"oracle {value[apart.argmax()]}, E K cos θ {0.5 * mu[apart.argmax()]}"
    mean = np.sum(weight * value * 2 * mu)
    assert abs(mean - 0.5 * 2 / 3) <= QUADRATURE, f"oracle {mean}, 2/3 E K = {1 / 3}"


def test_a_row_of_lamps_over_a_floor_adds_up_to_a_hyperbolic_cotangent(make_case):
    # With E = I/r (attenuation linear) and the cosine h/r, lamps at every s along a line give
    # Σ I h/(h² + n²s²) = I (π/s) coth(π h/s). Beyond |n| ≤ N there remains (2/s) (π/2 − arctan((N + ½) s/h)), but for O(N^-3).
    height, spacing, last = 0.7, 0.5, 300
    row = [
        {"kind": "point", "position": [n * spacing, 0, height], "intensity": 1, "attenuation": {"linear": 1}}
        for n in range(-last, last + 1)
    ]
    value = evaluate(make_case(FLOOR, {"diffuse": 1}, *row), [[4, 4]])[0, 0]
    rest = 2 / spacing * (math.pi / 2 - math.atan((last + 0.5) * spacing / height))
    true = math.pi / spacing / math.tanh(math.pi * height / spacing)
    assert abs(value + rest - true) <= last**-3, f"oracle {value} + rest {rest}, series {true}"


def test_irradiance_falls_by_the_square_of_the_distance(make_case):
    def under(height):
        lamp = {"kind": "point", "position": [0, 0, height], "intensity": 1}
        return evaluate(make_case(FLOOR, {"diffuse": 1}, lamp), [[4, 4]])[0, 0]

    for height in (1e-3, 1.0, 3.0, 1e3, 1e6):
        assert abs(under(height) * height**2 - 1) <= 1e-15 * 4, f"E r² = {under(height) * height**2} at {height} m"


def test_sixty_four_lights_are_the_sum_of_each_alone(make_case):
    material = {"diffuse": 0.1, "specular": 0.1, "exponent": 9}
    lights = [{"kind": "point", "position": [k % 8, k // 8, 3], "intensity": 1} for k in range(64)]
    together = equilux_oracle.radiance(make_case(FLOOR, material, *lights))
    alone = sum(equilux_oracle.radiance(make_case(FLOOR, material, light)) for light in lights)
    assert np.allclose(together, alone, rtol=64 * 2**-53, atol=0), f"apart {np.abs(together - alone).max()}"
