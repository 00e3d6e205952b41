"""What the scenes of the corpus family `photometry` are there to measure: each law in two numbers, the picture's and its own.

The pictures are the truths', the tracer's and the oracle's; every other renderer is judged by them.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import equilux_oracle
from equilux_oracle import pixel_centers
from equilux_scenes.loader import corpus_folder, load_scenes
from equilux_scenes.photometry import (
    REC709_TO_XYZ,
    irradiance_of_cone,
    irradiance_of_point,
    luminance_weights,
    solid_angle_of_cone,
)
from equilux_scenes.spectral_data import matching_functions
from equilux_tracer import Tracer
from equilux_tracer.tracer import ERROR_TARGET

FILES = {file.scene.name: file for file in load_scenes([corpus_folder() / "photometry"])}

ROUNDING = 1e-12
"""Relative, what both truths promise for a surface seen within 84° of its normal."""

SEES = {
    "tracer": lambda case, film_xy: Tracer(case).evaluate(film_xy, ["radiance"])["radiance"],
    "oracle": equilux_oracle.evaluate,
}

INTEGRALS = {"tracer": ERROR_TARGET, "oracle": ROUNDING}
"""Relative, what each truth promises for the light of extended emitters."""


@pytest.fixture(params=SEES)
def subject(request):
    return request.param


@pytest.fixture
def see(subject):
    """see(case, film_xy) → radiance (n, 3) at film positions (n, 2)."""
    return SEES[subject]


def cases_of(scene):
    """Value of the one sweep axis → case."""
    return {next(iter(case.axes.values()), None): case for case in FILES[scene].cases}


def middle(case):
    """The film position of the middle, which in a film of odd size is a pixel's."""
    return np.array([[case.scene.film.width / 2, case.scene.film.height / 2]])


def luminance(case, radiance):
    return radiance @ np.array(luminance_weights(case.scene))


def directions(case, film_xy):
    """Unit directions (n, 3) through film positions of a perspective camera, by CONVENTIONS.md."""
    camera, film = case.scene.camera, case.scene.film
    forward = np.subtract(camera.target, camera.eye)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    half = math.tan(math.radians(camera.fov_y_deg) / 2)
    x = (2 * film_xy[:, 0] / film.width - 1) * film.width / film.height * half
    y = (1 - 2 * film_xy[:, 1] / film.height) * half
    found = forward + x[:, None] * right + y[:, None] * up
    return found / np.linalg.norm(found, axis=1)[:, None]


def seen_solid_angles(case, film_xy, areas_px):
    """Solid angle (n,) of patches of the film, small enough to be flat: dΩ = cos³ dA / f²."""
    camera, film = case.scene.camera, case.scene.film
    forward = np.subtract(camera.target, camera.eye)
    cosine = directions(case, film_xy) @ (forward / np.linalg.norm(forward))
    per_pixel = 2 * math.tan(math.radians(camera.fov_y_deg) / 2) / film.height
    return cosine**3 * areas_px * per_pixel**2


def ball_normals(case):
    """Normals (n, 3) of the sphere about the origin that the pixels' centres see; 0 where they miss it."""
    eye, away = np.array(case.scene.camera.eye), directions(case, pixel_centers(case.scene.film))
    half = away @ eye
    root = half**2 - (eye @ eye - case.scene.objects[0].radius ** 2)
    t = -half - np.sqrt(np.maximum(root, 0))
    return np.where(root[:, None] > 0, (eye + t[:, None] * away) / case.scene.objects[0].radius, 0)


# --- constancy of radiance --------------------------------------------------------------------------------------------


def test_radiance_does_not_change_with_the_distance_to_a_glowing_wall(see):
    pictures = {d: see(case, pixel_centers(case.scene.film)) for d, case in cases_of("constancy-of-radiance").items()}
    assert set(pictures) == {1, 10, 1000}
    film = FILES["constancy-of-radiance"].scene.film
    x, y = pixel_centers(film).T
    expected = np.where(((x > film.width / 2) & (y < film.height / 2))[:, None], (2.0, 3.0, 1.0), 0.125)
    for distance, picture in pictures.items():
        assert np.array_equal(picture, expected), f"from {distance} m: {np.unique(picture, axis=0)}"


def test_luminance_does_not_change_with_the_distance_to_a_lamp_whose_solid_angle_does(see):
    solid_angles = {}
    for distance, case in cases_of("constancy-of-luminance").items():
        film_xy = pixel_centers(case.scene.film)
        seen = luminance(case, see(case, film_xy))
        lit = seen > 0
        assert seen[lit] == pytest.approx(np.full(lit.sum(), 1000.0), rel=ROUNDING)
        solid_angles[distance] = seen_solid_angles(case, film_xy, 1.0)[lit].sum()
    radius = 0.5
    for distance, got in solid_angles.items():
        case = cases_of("constancy-of-luminance")[distance]
        away = math.dist(case.scene.camera.eye, (0, 0, 0))
        cosine = distance / away
        expected = math.pi * radius**2 * cosine / away**2  # small from there: (r / d)² is left out
        pixel = seen_solid_angles(case, middle(case), 1.0)[0]
        on_the_border = 2 * math.pi * math.sqrt(expected / math.pi / pixel) + 4  # pixels that a circle of that size runs through
        allowed = on_the_border * pixel + expected * (radius / away) ** 2
        assert abs(got - expected) <= allowed, f"from {distance} m: got {got} sr, expected {expected} sr ± {allowed}"
    assert solid_angles[2] > 10 * solid_angles[8] > 100 * solid_angles[32] > 0


# --- inverse square, cosine -------------------------------------------------------------------------------------------


def test_irradiance_falls_with_the_square_of_the_distance(see):
    for height, case in cases_of("inverse-square").items():
        got = see(case, middle(case))[0] * math.pi  # a white plane sends E/π everywhere
        expected = irradiance_of_point(4.0, height)
        assert got == pytest.approx([expected] * 3, rel=ROUNDING), f"{height} m: E = {got}, I/h² = {expected}"


def test_irradiance_falls_with_the_cosine_of_the_tilt(see):
    for tilt, case in cases_of("cosine-law").items():
        film, height_m = case.scene.film, case.scene.camera.height_m
        card_x = film.width / 2 - 0.9 * film.height / height_m
        got = see(case, [[card_x, film.height / 2]])[0] * math.pi
        expected = math.cos(math.radians(tilt))
        assert got == pytest.approx([expected] * 3, rel=ROUNDING), f"{tilt}°: E = {got}, cos = {expected}"


# --- flux -------------------------------------------------------------------------------------------------------------


def _flux(see, faces, nodes, weights):
    """∫ E dA over the sphere, as seen from its middle: dA = R² dΩ."""
    film = faces[0].scene.film
    x, y = np.meshgrid((nodes + 1) / 2 * film.width, (nodes + 1) / 2 * film.height)
    film_xy = np.stack([x.ravel(), y.ravel()], axis=1)
    areas_px = np.outer(weights, weights).ravel() * film.width * film.height / 4
    radius = faces[0].scene.objects[0].radius
    shares = [see(face, film_xy) * math.pi * seen_solid_angles(face, film_xy, areas_px)[:, None] for face in faces]
    return np.sum(np.concatenate(shares), axis=0) * radius**2


def test_irradiance_integrated_over_an_enclosing_sphere_is_the_flux_of_the_lamp(see):
    faces = FILES["flux-through-a-sphere"].cases
    assert len(faces) == 6
    coarse, fine = (_flux(see, faces, *np.polynomial.legendre.leggauss(count)) for count in (20, 40))
    # Gauss's rule on an analytic function: twice the points square the relative error
    allowed = np.abs(fine - coarse) ** 2 / fine + 1e-11 * fine
    assert np.all(np.abs(fine - (10, 20, 5)) <= allowed), f"got {fine} W, Φ = 10, 20, 5 W, allowed {allowed}"
    assert np.all(allowed < 1e-9 * fine)


def test_the_pixels_of_six_renders_add_up_to_the_flux_of_the_lamp(see):
    faces = FILES["flux-through-a-sphere"].cases
    fine, coarse = (
        _flux(see, faces, (2 * np.arange(count) + 1) / count - 1, np.full(count, 2 / count)) for count in (48, 24)
    )  # the midpoint rule, 48 being the film's own pixels; its error falls to a quarter, so it is a third of the difference
    assert np.all(np.abs(fine - (10, 20, 5)) <= np.abs(fine - coarse)), (
        f"got {fine} W from 48², {coarse} W from 24², Φ = 10, 20, 5"
    )
    assert np.all(np.abs(fine - coarse) < 1e-2 * fine)


# --- solid angles -----------------------------------------------------------------------------------------------------


def test_a_cone_covers_two_pi_times_one_minus_its_cosine(see):
    for alpha_deg, case in cases_of("solid-angle-of-a-cone").items():
        film_xy = pixel_centers(case.scene.film)
        lit = see(case, film_xy).any(axis=1)
        each = seen_solid_angles(case, film_xy, 1.0)
        got, expected = each[lit].sum(), solid_angle_of_cone(math.radians(alpha_deg))
        # a pixel may be counted wrongly where the cone's rim passes within half of its diagonal
        angle_to_axis = np.degrees(np.arccos(directions(case, film_xy) @ (0, 0, -1)))
        half_diagonal_deg = math.degrees(math.tan(math.radians(50)) * 2 / case.scene.film.height / math.sqrt(2))
        allowed = each[np.abs(angle_to_axis - alpha_deg) <= half_diagonal_deg].sum()
        assert abs(got - expected) <= allowed, f"{alpha_deg}°: got {got} sr, 2π(1 − cos α) = {expected} sr ± {allowed}"
        assert allowed < expected


def test_a_spots_lumens_all_arrive_in_its_cone(see):
    checked = 0
    for alpha_deg, case in cases_of("solid-angle-of-a-cone").items():
        off_axis_deg = math.degrees(math.acos(-directions(case, middle(case))[0][2]))
        if off_axis_deg >= alpha_deg:
            continue
        checked += 1
        lux = luminance(case, see(case, middle(case)))[0] * math.pi
        lumens = lux * 1.5**2 * solid_angle_of_cone(math.radians(alpha_deg))
        assert lumens == pytest.approx(100, rel=ROUNDING), f"{alpha_deg}°: got {lumens} lm, expected 100 lm"
    assert checked == 2


def test_a_glowing_ball_irradiates_by_the_square_of_the_sine_of_its_half_angle(see, subject):
    for radius, case in cases_of("solid-angle-of-a-ball").items():
        got = see(case, middle(case))[0] * math.pi
        expected = [irradiance_of_cone(band, math.asin(radius / 2)) for band in (1.0, 0.5, 2.0)]
        assert got == pytest.approx(expected, rel=INTEGRALS[subject]), f"r = {radius} m: E = {got}, π L sin²α = {expected}"


# --- photometry -------------------------------------------------------------------------------------------------------


def test_one_watt_at_555_nm_has_683_lumens(see):
    (case,) = FILES["one-watt-at-555-nm"].cases
    lamp = case.scene.lights["lamp"]
    assert lamp.intensity == pytest.approx((0, 1 / (4 * math.pi), 0), rel=ROUNDING)
    film_xy = pixel_centers(case.scene.film)
    seen = see(case, film_xy)
    hit = seen[:, 0] == 0  # the background has red
    # the luminance of what is seen, over its radiance: K_m times the mean of V over the band of 1 nm
    efficacy = luminance(case, seen[hit & (seen[:, 1] > 0)]) / seen[hit & (seen[:, 1] > 0)][:, 1]
    assert len(efficacy) > 100
    assert efficacy == pytest.approx(np.full(len(efficacy), 683.0), abs=0.1), f"got {efficacy[0]} lm/W"
    # V is at its peak of 1 at 555 nm, and its curvature is 2 (1 − V(556)) per nm²: the band's mean is lower by less than that
    assert np.all(efficacy < 683.002)


def _planck_bands(kelvin):
    """Bands of 100 cd of a blackbody, by Simpson's rule between the CIE's samples, in steps of 1/16 nm."""
    functions = matching_functions()
    nm = np.linspace(360, 830, 470 * 16 + 1)
    planck = 1 / nm**5 / np.expm1(6.62607015e-34 * 299792458 / 1.380649e-23 * 1e9 / nm / kelvin)
    weights = np.ones_like(nm)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    xyz = [weights * planck @ np.interp(nm, functions.wavelengths_nm, column) for column in functions.values.T]
    return 100 / 683.002 * np.linalg.solve(REC709_TO_XYZ, np.divide(xyz, xyz[1]))


def test_the_temperature_of_a_lamp_changes_its_colour_and_not_its_luminance(see):
    pictures = {}
    for kelvin, case in cases_of("blackbodies-of-100-candela").items():
        seen = see(case, pixel_centers(case.scene.film))
        pictures[kelvin] = luminance(case, seen)
        lit = seen[:, 1] > 0
        ratio = seen[lit, 0] / seen[lit, 2]
        assert ratio == pytest.approx(np.full(lit.sum(), ratio[0]), rel=ROUNDING)
        bands = case.scene.lights["lamp"].intensity
        assert ratio[0] == pytest.approx(bands[0] / bands[2], rel=ROUNDING)
        # the bands' luminance is that of the whole spectrum
        assert np.dot(bands, luminance_weights(case.scene)) == pytest.approx(100, rel=ROUNDING)
        assert bands == pytest.approx(_planck_bands(kelvin), rel=1e-9)
    assert pictures[2000].max() > 1
    for kelvin in (2700, 6500):
        assert pictures[kelvin] == pytest.approx(pictures[2000], rel=1e-11)


def test_a_white_ball_is_white_only_under_daylight(see):
    white = {}
    for illuminant, case in cases_of("illuminants-of-1000-lux").items():
        seen = see(case, pixel_centers(case.scene.film))
        white[illuminant] = seen[np.argmax(seen[:, 1])] / seen[:, 1].max()
        lux = 1000 * np.maximum(0, ball_normals(case) @ (0.5, 0.75, 1) / math.hypot(0.5, 0.75, 1))
        got = luminance(case, seen) * math.pi
        assert got == pytest.approx(lux, abs=1e-9), f"got {got.max()} lx at most, expected {lux.max()} lx"  # 1000 lx × 1e-12
        assert lux.max() > 990
    off = np.abs(white["D65"] - 1).max()
    assert off < 1e-3, f"D65: R G B = {white['D65']}"  # the four digits of Rec.709's white
    assert white["A"][0] > 1.5, f"A is {white['A']}"
    assert white["A"][2] < 0.5, f"A is {white['A']}"


def test_the_lectures_k_m_makes_0_146_percent_less_radiance_of_a_lux(see):
    pictures = {k: see(case, pixel_centers(case.scene.film)) for k, case in cases_of("k-m-of-the-lecture").items()}
    si, lecture = pictures[683.002], pictures[684]
    lit = si > 0
    ratio = lecture[lit] / si[lit]
    assert ratio == pytest.approx(np.full(lit.sum(), 683.002 / 684), rel=ROUNDING)
    assert round((1 / ratio[0] - 1) * 100, 3) == 0.146


def test_candelas_lumens_and_lux_arrive_on_the_floor_as_lux(see):
    """Each lamp's lux from its own definition, at a point of the floor that all three reach."""
    (case,) = FILES["candela-lux-lumen"].cases
    film = case.scene.film
    film_xy = np.array([[x + 0.5, film.height - 3.5] for x in range(0, film.width, 8)])
    away = directions(case, film_xy)
    eye = np.array(case.scene.camera.eye)
    floor = eye + away * ((-0.7 - eye[1]) / away[:, 1])[:, None]
    left, spot = np.array([-1.5, 0.5, 1.5]) - floor, np.array([2, 0.75, 1.5]) - floor
    r_left, r_spot = np.linalg.norm(left, axis=1), np.linalg.norm(spot, axis=1)
    axis = np.array([-2, -0.75, -1.5]) / math.hypot(2, 0.75, 1.5)
    cosine = -(spot @ axis) / r_spot
    candelas = 40 * 9 / (2 * math.pi * (1 - math.cos(math.radians(12)) ** 9))
    beam = np.where(cosine >= math.cos(math.radians(12)), candelas * cosine**8, 0)
    lux = 150 * left[:, 1] / r_left**3 + beam * spot[:, 1] / r_spot**3 + 30
    got = luminance(case, see(case, film_xy)) * math.pi
    assert got == pytest.approx(lux, rel=1e-11), f"got {got} lx, expected {lux} lx"
    assert len(set(np.round(lux, 3))) > 5


def test_lamps_of_400_lumens_have_the_luminance_of_their_area(see):
    (case,) = FILES["lamps-by-lumens"].cases
    camera, film = case.scene.camera, case.scene.film
    area = {"ball": 4 * math.pi * 0.25**2, "panel": 0.4, "disc": math.pi * 0.375**2}
    film_xy = pixel_centers(film)
    picture = luminance(case, see(case, film_xy))
    away = directions(case, film_xy)
    to_ball = np.subtract((-2, 2, 0), camera.eye)
    nearest = int(np.argmax(away @ (to_ball / np.linalg.norm(to_ball))))
    expected = 400 / (math.pi * area["ball"])
    assert picture[nearest] == pytest.approx(expected, rel=ROUNDING), f"got {picture[nearest]} cd/m², Φ/πA = {expected} cd/m²"
    for name, light in case.scene.lights.items():
        got = float(np.dot(light.radiance, luminance_weights(case.scene)))
        assert got * math.pi * area[name] == pytest.approx(400, rel=ROUNDING), name
