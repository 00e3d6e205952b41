"""The region integrals against the textbook's form factors, solid angles and lobe integrals, and those against each other."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from mpmath import mp, mpf

from equilux_oracle.emitters import closed_forms
from equilux_oracle.emitters.arcs import edge_arc
from equilux_oracle.emitters.frame import Frame
from equilux_oracle.emitters.lobe import curves
from equilux_oracle.emitters.panels import integrate
from equilux_scenes.model import DiscEmitter, RectangleEmitter, SphereEmitter
from support.random_emitters import random_direction

from .conftest import double_double, receiver_of

UP = (0.0, 0.0, 1.0)
ROUNDING = 1e-14
"""Some thirty roundings of the textbook formulas, of which arccos and the square roots of differences cost most."""


def factor(received, emitter, normal=UP):
    """F = ∫ N·ω dω / π at the origin, and its bound."""
    value, bound = received(emitter, receiver_of(normal, normal, 1.0))[0]
    return value / math.pi, bound / math.pi


def agrees(found, textbook, what):
    value, bound = found
    assert abs(value - textbook) <= bound + ROUNDING, f"{what}: closed form {value!r}, textbook {textbook!r}, bound {bound}"


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 60.0, 75.0, 89.0, 90.0, 95.0, 110.0, 130.0])
@pytest.mark.parametrize(("radius", "distance"), [(0.3, 1.0), (0.9, 1.0), (1.0, 40.0)])
def test_a_sphere_on_an_element(received, angle_deg, radius, distance):
    angle = math.radians(angle_deg)
    center = (distance * math.sin(angle), 0.0, distance * math.cos(angle))
    ball = SphereEmitter(kind="sphere", center=center, radius=radius, radiance=(1, 1, 1))
    textbook = closed_forms.sphere_on_element(radius, distance, math.cos(angle))
    if angle_deg > 90 and math.sin(angle - math.pi / 2) >= radius / distance:
        textbook = 0.0
    agrees(factor(received, ball), textbook, f"sphere {radius} at {distance} m, {angle_deg}°")


@pytest.mark.parametrize("offset", [0.0, 1e-9, 0.3, 1.0, 5.0])
@pytest.mark.parametrize("radius", [1e-3, 0.5, 2.0])
def test_a_disc_on_a_parallel_element(received, offset, radius):
    disc = DiscEmitter(kind="disc", center=(offset, 0.0, 0.7), normal=(0, 0, -1), radius=radius, radiance=(1, 1, 1))
    parallel = closed_forms.disc_on_parallel_element(radius, 0.7, offset)
    agrees(factor(received, disc), parallel, f"disc {radius}, {offset} off its axis")
    if offset == 0.0:
        agrees(factor(received, disc), closed_forms.coaxial_disc_on_element(radius, 0.7), f"disc {radius} on its axis")


def test_a_small_disc_keeps_its_relative_digits(received):
    disc = DiscEmitter(kind="disc", center=(0.6, 0.3, 0.7), normal=(-0.5, 0.1, -1), radius=1e-6, radiance=(1, 1, 1))
    value, bound = factor(received, disc)
    d2 = 0.6**2 + 0.3**2 + 0.7**2
    facing = (0.5 * 0.6 - 0.1 * 0.3 + 0.7) / math.sqrt(1.26)
    small = 1e-12 * (0.7 / math.sqrt(d2)) * (facing / math.sqrt(d2)) / d2
    assert abs(value / small - 1) <= 1e-11, f"closed form {value}, r² cosθ cosθ'/d² {small}"
    assert bound <= 1e-13 * value, f"bound {bound} of {value}"


@pytest.mark.parametrize("sides", [(0.5, 0.8), (3.0, 0.2), (100.0, 100.0)])
def test_a_rectangle_before_its_corner(received, sides):
    w, h = sides
    corner = (0.0, 0.0, 0.7)
    parallel = RectangleEmitter(kind="rectangle", corner=corner, edge_u=(0.0, h, 0), edge_v=(w, 0.0, 0), radiance=(1, 1, 1))
    agrees(factor(received, parallel), closed_forms.rectangle_on_parallel_element(w, h, 0.7), f"rectangle {sides}, parallel")
    # Across: the rectangle stands on the horizon of an element that looks along y.
    across = factor(received, parallel, (0.0, 1.0, 0.0))
    agrees(across, closed_forms.rectangle_on_perpendicular_element(w, h, 0.7), f"rectangle {sides}, across")


@pytest.mark.parametrize("near", [1.0, 1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("long", [1.0, 100.0, 1e5])
def test_close_to_the_edge_of_a_long_rectangle(received, near, long):
    # Lambert's polygon formula at fifty digits: half the sum of angle times the cosine of the edge's plane.
    corner = (-0.3 * long, near, 0.6 * near)
    panel = RectangleEmitter(kind="rectangle", corner=corner, edge_u=(0, 1.3, 0.2), edge_v=(long, 0, 0), radiance=(1, 1, 1))
    value, bound = received(panel, receiver_of(UP, UP, 1.0))[0]
    with mp.workdps(50):
        c, u, v = (mp.matrix(list(vector)) for vector in (corner, panel.edge_u, panel.edge_v))
        corners = [c, c + v, c + v + u, c + u]  # counter-clockwise seen along +z
        total = mpf(0)
        for first, last in zip(corners, [*corners[1:], corners[0]], strict=True):
            normal = cross(first, last)
            total += mp.atan2(mp.norm(normal), dot(first, last)) * normal[2] / mp.norm(normal)
        true = total / 2
    apart = float(abs(mpf(value) - true))
    assert apart <= bound, f"closed form {value!r}, fifty digits {mp.nstr(true, 20)}, bound {bound}"
    assert bound <= 1e-13 * max(1.0, long / near), f"bound {bound} of {value}"


def dot(a, b):
    return sum(a[k] * b[k] for k in range(3))


def cross(a, b):
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def test_parallel_discs_by_reciprocity():
    # The mean of a disc's factor over another one on its axis; A₁ F₁₂ = A₂ F₂₁.
    x, weight = np.polynomial.legendre.leggauss(40)
    r1, r2, d = 0.8, 0.5, 0.6
    offsets, weights = r1 * (x + 1) / 2, r1 * weight / 2
    elements = np.array([closed_forms.disc_on_parallel_element(r2, d, offset) for offset in offsets])
    mean = 2 / r1**2 * np.sum(weights * offsets * elements)
    textbook = closed_forms.disc_to_parallel_disc(r1, r2, d)
    assert abs(mean - textbook) <= 1e-13, f"mean over the disc {mean!r}, C-41 {textbook!r}"
    back = closed_forms.disc_to_parallel_disc(r2, r1, d)
    assert abs(r1**2 * textbook - r2**2 * back) <= 1e-15, f"A₁F₁₂ {r1**2 * textbook}, A₂F₂₁ {r2**2 * back}"


def test_solid_angles(received):
    # With p = 0 the lobe's integral is the solid angle, as far as it is before both horizons.
    ball = SphereEmitter(kind="sphere", center=(0.1, 0.2, 1.0), radius=0.3, radiance=(1, 1, 1))
    edges = {"edge_u": (0, 0.6, 0), "edge_v": (0.8, 0, 0)}
    panel = RectangleEmitter(kind="rectangle", corner=(-0.4, -0.3, 0.9), **edges, radiance=(1, 1, 1))
    at = receiver_of(UP, UP, 0.0)
    for emitter, textbook in (
        (ball, closed_forms.sphere_solid_angle(0.3, math.sqrt(1.05))),
        (panel, closed_forms.rectangle_solid_angle(0.8, 0.6, 0.9)),
    ):
        value, bound = received(emitter, at)[1]
        assert abs(value - textbook) <= bound + ROUNDING, f"{emitter.kind}: closed form {value!r}, textbook {textbook!r}"
    assert abs(received(None, at)[1][0] - 2 * math.pi) <= 1e-13, f"hemisphere {received(None, at)[1][0]}, 2π"


@pytest.mark.parametrize("exponent", [0.0, 0.5, 1.0, 7.0, 50.5, 1000.0, 1e5])
def test_the_lobe_over_the_hemisphere_at_normal_view(received, exponent):
    _, lobe, with_cosine = received(None, receiver_of(UP, UP, exponent))
    for name, (value, bound), textbook in (
        ("2π/(p+1)", lobe, closed_forms.lobe_solid_angle(exponent)),
        ("2π/(p+2)", with_cosine, closed_forms.lobe_reflectance(exponent)),
    ):
        assert abs(value - textbook) <= bound, f"p = {exponent}: closed form {value!r}, {name} = {textbook!r}, bound {bound}"
        assert bound <= 1e-12 * textbook, f"p = {exponent}: bound {bound} of {textbook}"


@pytest.mark.parametrize("exponent", [0.0, 0.5, 7.0, 50.5, 1000.0])
def test_the_lobe_in_a_cone_about_the_mirror_direction(received, exponent):
    ball = SphereEmitter(kind="sphere", center=(0.0, 0.0, 2.0), radius=0.8, radiance=(1, 1, 1))
    disc = DiscEmitter(kind="disc", center=(0.0, 0.0, 2.0), normal=(0, 0, -1), radius=0.8, radiance=(1, 1, 1))
    at = receiver_of(UP, UP, exponent)
    for emitter, half_angle in ((ball, math.asin(0.4)), (disc, math.atan(0.4))):
        value, bound = received(emitter, at)[1]
        textbook = closed_forms.lobe_in_cone(exponent, half_angle)
        what = f"{emitter.kind}, p = {exponent}: {value!r}, textbook {textbook!r}"
        assert abs(value - textbook) <= bound + ROUNDING * textbook, what


@pytest.mark.parametrize("exponent", [0, 1, 2, 5, 12, 31])
def test_arvos_axial_moments_of_a_polygon(exponent):
    # His recurrence for whole p, edge by edge, for a triangle all of which is less than 90° away from the axis.
    rng = random.Random(exponent)
    frame = Frame.of(double_double((0, 0, 1)), double_double((0, 0, 1)))
    corners = [(0.1 + 0.5 * x, -0.2 + 0.5 * y, 0.9) for x, y, _ in (random_direction(rng) for _ in range(3))]
    a, b, c = (np.array(corner) for corner in corners)
    if np.cross(b - a, c - a)[2] < 0:
        b, c = c, b
    triangle = [v / np.linalg.norm(v) for v in (a, b, c)]
    edges = [(triangle[k].reshape(3, 1), triangle[(k + 1) % 3].reshape(3, 1)) for k in range(3)]
    arcs = [edge_arc(*edge, *edge) for edge in edges]
    value, bound = integrate(curves(arcs, frame, np.array([float(exponent)]), np.array([False])), 1)
    true = arvo(triangle, np.array(UP), exponent)
    assert abs(value[0] - true) <= bound[0] + 1e-14, f"p = {exponent}: by panels {value[0]!r}, by recurrence {true!r}"


def arvo(corners, axis, p):
    """τ_p = ∫ (axis·ω)^p dω over a spherical triangle: (q + 1) τ_q = (q − 1) τ_{q−2} + Σ_edges (n·axis) ∫ (axis·r)^(q−1) ds.

    It starts from the solid angle τ_0, or from nothing at q = 1.
    """

    def edge_integral(q, first, last):
        """∫ (axis·r)^q along the edge, by 60-node Gauss–Legendre: a polynomial of degree q in sine and cosine."""
        x, w = np.polynomial.legendre.leggauss(60)
        normal = np.cross(first, last)
        angle = math.atan2(np.linalg.norm(normal), first @ last)
        side = np.cross(normal / np.linalg.norm(normal), first)
        t = angle * (x + 1) / 2
        return angle / 2 * np.sum(w * (axis @ (np.outer(first, np.cos(t)) + np.outer(side, np.sin(t)))) ** q)

    edges = [(corners[k], corners[(k + 1) % len(corners)]) for k in range(len(corners))]
    start = p % 2
    if start == 0:
        a, b, c = corners
        tau = 2 * math.atan2(abs(a @ np.cross(b, c)), 1 + a @ b + b @ c + c @ a)
    else:
        tau = 0.0
    for q in range(start, p + 1, 2):
        if q == 0:
            continue
        border = 0.0
        for first, last in edges:
            normal = np.cross(first, last)
            border += (normal / np.linalg.norm(normal)) @ axis * edge_integral(q - 1, first, last)
        tau = ((q - 1) * tau + border) / (q + 1)
    return tau


def test_a_sphere_is_a_point_light_to_a_lambertian_receiver(received):
    # π L sin²α cosθ = (π r² L) cosθ/d²
    for radius in (0.5, 1e-3, 1e-8):
        ball = SphereEmitter(kind="sphere", center=(0.3, 0.1, 1.0), radius=radius, radiance=(1, 1, 1))
        value, bound = received(ball, receiver_of(UP, UP, 1.0))[0]
        d2 = 0.3**2 + 0.1**2 + 1
        point = closed_forms.sphere_intensity(radius, 1.0) / d2**1.5
        assert abs(value - point) <= bound + 1e-15 * point, f"radius {radius}: {value!r}, I cosθ/d² {point!r}"
        flux = closed_forms.sphere_flux(radius, 1.0)
        assert math.isclose(flux, 4 * math.pi * closed_forms.sphere_intensity(radius, 1.0), rel_tol=1e-15), f"Φ {flux}, 4π I"
