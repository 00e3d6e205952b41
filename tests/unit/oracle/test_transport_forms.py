"""The oracle's ray-traced pictures against formulas that trace nothing, at fifty digits, on scenes of the corpus."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mpmath import mp, mpf

import equilux_oracle
from equilux_oracle import transport_forms as forms
from equilux_oracle.precise import evaluate_at
from equilux_scenes.loader import corpus_folder, load_scene_file
from equilux_scenes.model import Plane, Sphere
from support.plain_phong import film_positions_of
from support.random_scenes import case_of

EVERY = 23
"""Of the pixels, every so manieth is compared: a prime, so that no row or column is left out."""


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


def cases_of(name):
    return load_scene_file(corpus_folder() / "raytraced" / f"{name}.scene.yaml").cases


def camera_ray(case, x, y):
    """Eye and direction of a perspective view, not unit, at fifty digits."""
    camera, film = case.scene.camera, case.scene.film
    eye, target, up = (mp.matrix([mpf(c) for c in v]) for v in (camera.eye, camera.target, camera.up))
    forward = (target - eye) / mp.norm(target - eye)
    right = cross(forward, up)
    right /= mp.norm(right)
    half = mp.tan(mp.radians(mpf(camera.fov_y_deg)) / 2)
    a = (2 * mpf(x) / film.width - 1) * film.width / film.height * half
    b = (1 - 2 * mpf(y) / film.height) * half
    return eye, forward + a * right + b * cross(right, forward)


def cross(a, b):
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def compare(case, formula, least):
    """At some of the pixels: formula(x, y) → three bands, or None where it does not apply; at least so many must."""
    positions = equilux_oracle.pixel_centers(case.scene.film)[::EVERY]
    found = equilux_oracle.examine(case, positions)
    compared, worst = 0, 0.0
    for k, (x, y) in enumerate(positions):
        true = formula(x, y)
        if true is None:
            continue
        compared += 1
        for band in range(3):
            error, allowed = abs(mpf(found.radiance[k, band]) - true[band]), found.bound[k, band]
            assert error <= allowed or error == 0, (
                f"{case.name} at ({x}, {y}), band {band}: oracle {found.radiance[k, band]!r}, formula {mp.nstr(true[band], 20)}, "
                f"off by {mp.nstr(error, 3)}, bound {allowed:.3g}"
            )
            worst = max(worst, float(error / allowed) if allowed else 0.0)
    print(f"\n{case.name}: {compared} pixels, worst error ÷ bound {worst:.2g}")
    assert compared >= least, f"{case.name}: the formula applied to {compared} pixels only"


def bands(values):
    return [mpf(v) for v in values]


# --- mirrors ----------------------------------------------------------------------------------------------------------


def met_between(case, x, y):
    """How many of two mirrors across z a ray meets before it leaves: unfolded, they are met at equal steps of depth."""
    eye, d = camera_ray(case, x, y)
    mirrors = []
    for shape in case.scene.objects:
        (x0, x1), (y0, y1) = (sorted((shape.corner[k], shape.corner[k] + shape.edge_u[k] + shape.edge_v[k])) for k in (0, 1))
        mirrors.append((mpf(shape.corner[2]), x0, x1, y0, y1))
    gap = abs(mirrors[1][0] - mirrors[0][0])
    ahead = min(mirrors) if d[2] < 0 else max(mirrors)
    order = [ahead, next(m for m in mirrors if m != ahead)]
    depth, met = abs(ahead[0] - eye[2]), 0
    while met < 100:
        _, x0, x1, y0, y1 = order[met % 2]
        across = [eye[k] + d[k] * depth / abs(d[2]) for k in (0, 1)]
        if not (x0 <= across[0] <= x1 and y0 <= across[1] <= y1):
            break
        met, depth = met + 1, depth + gap
    return met


@pytest.mark.parametrize("case", cases_of("parallel-mirrors"), ids=lambda case: case.name)
def test_two_parallel_mirrors_show_the_geometric_series(case):
    material, limit = case.scene.materials["mirror"], case.scene.recursion_limit

    def formula(x, y):
        met = met_between(case, x, y)
        values = zip(material.emission, material.reflection, case.scene.background, strict=True)
        return [forms.bounces(mpf(e), mpf(k), mpf(b), met, limit) for e, k, b in values]

    compare(case, formula, 830)


def test_parallel_mirrors_leave_out_what_the_truncation_formula_says():
    endless = {
        "equilux": 1,
        "name": "endless",
        "model": "raytraced",
        "camera": {"projection": "perspective", "eye": [0, 0, 0], "target": [1, 0.3, 0.4], "fov_y_deg": 20},
        "film": {"width": 2, "height": 1},
        "materials": {"mirror": {"emission": [0.5, 0.25, 1], "reflection": [0.5, 0.75, 0.875]}},
        "objects": [{"kind": "plane", "point": [0, 0, z], "normal": [0, 0, 1], "material": "mirror"} for z in (-1, 2)],
    }
    whole = [mpf(e) / (1 - mpf(k)) for e, k in ((0.5, 0.5), (0.25, 0.75), (1, 0.875))]
    for limit in (0, 1, 2, 5, 8, 40):
        found = equilux_oracle.examine(case_of({**endless, "recursion_limit": limit}), [[0.5, 0.5]])
        for band, (e, k) in enumerate(((0.5, 0.5), (0.25, 0.75), (1, 0.875))):
            missing, stated = whole[band] - mpf(found.radiance[0, band]), forms.truncation(mpf(e), mpf(k), limit)
            assert abs(missing - stated) <= found.bound[0, band], (
                f"limit {limit}: {mp.nstr(missing, 17)} is missing of the series, the formula says {mp.nstr(stated, 17)}"
            )


def test_a_plane_mirror_shows_the_mirrored_world():
    (case,) = cases_of("mirror-plane")
    scene = case.scene
    plane, ball = scene.objects
    assert isinstance(plane, Plane)
    assert isinstance(ball, Sphere)
    lamp = scene.lights["lamp"]

    def alone(sign):
        """The ball under the lamp without the mirror, or its mirrored twin, in the local model: nothing occludes here."""
        spec = {
            "equilux": 1,
            "name": "alone",
            "model": "phong",
            "camera": scene.camera.model_dump(),
            "film": scene.film.model_dump(),
            "ambient": list(scene.ambient),
            "lights": {"lamp": {"kind": "point", "position": flipped(lamp.position, sign), "intensity": list(lamp.intensity)}},
            "materials": {"ball": scene.materials["ball"].model_dump(include={"diffuse", "specular", "exponent", "ambient"})},
            "objects": [{"kind": "sphere", "center": flipped(ball.center, sign), "radius": ball.radius, "material": "ball"}],
        }
        return case_of(spec)

    direct, mirrored, mirror = alone(1), alone(-1), scene.materials["mirror"]

    def formula(x, y):
        seen = evaluate_at(direct, x, y)
        if seen.seen is not None:
            return seen.radiance
        if camera_ray(case, x, y)[1][1] >= 0:
            return bands(scene.background)
        image = evaluate_at(mirrored, x, y).radiance
        return [mpf(mirror.emission[b]) + mpf(mirror.reflection[b]) * image[b] for b in range(3)]

    compare(case, formula, 830)


def flipped(v, sign):
    return [v[0], sign * v[1], v[2]]


def test_a_mirror_sphere_shows_the_wall_behind_the_viewer():
    (case,) = cases_of("mirror-sphere")
    scene = case.scene
    ball, wall = scene.objects
    lamp, film = scene.lights["lamp"], scene.film
    k, paint = scene.materials["mirror"].reflection, scene.materials["wall"]

    def formula(x, y):
        half = mpf(scene.camera.height_m) / 2
        at = ((2 * mpf(x) / film.width - 1) * half * film.width / film.height, (1 - 2 * mpf(y) / film.height) * half)
        ray = forms.off_sphere(at[0] - mpf(ball.center[0]), at[1] - mpf(ball.center[1]), mpf(ball.radius))
        if ray is None:
            return bands(scene.background)
        if ray.direction[2] <= 0:
            return [mpf(k[b]) * mpf(scene.background[b]) for b in range(3)]
        run = (mpf(wall.point[2]) - ray.point[2] - mpf(ball.center[2])) / ray.direction[2]
        spot = [mpf(ball.center[c]) + ray.point[c] + run * ray.direction[c] - mpf(lamp.position[c]) for c in (0, 1)]
        before, aside = mpf(wall.point[2]) - mpf(lamp.position[2]), mp.hypot(*spot)
        shown = [forms.lamp_on_wall(mpf(paint.diffuse[b]), mpf(lamp.intensity[b]), before, aside) for b in range(3)]
        return [mpf(k[b]) * (mpf(paint.emission[b]) + shown[b]) for b in range(3)]

    compare(case, formula, 830)


# --- refraction -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", cases_of("glass-slab"), ids=lambda case: case.name)
def test_a_slab_shifts_and_weights_the_wall_behind_it(case):
    slab, wall = case.scene.objects
    glass, paint, lamp = case.scene.materials["glass"], case.scene.materials["wall"], case.scene.lights["lamp"]
    low, high = [mpf(c) for c in slab.min], [mpf(c) for c in slab.max]
    wall_z, ior, t = mpf(wall.point[2]), mpf(glass.ior), mpf(glass.transparency)

    def formula(x, y):
        eye, d = camera_ray(case, x, y)
        sideways = mp.hypot(d[0], d[1])
        angle = mp.atan2(sideways, -d[2])
        way = [d[k] / sideways for k in (0, 1)]

        def at(z, shift):
            reach = (eye[2] - z) * mp.tan(angle) - shift
            return [eye[k] + way[k] * reach for k in (0, 1)]

        shift = forms.slab_shift(high[2] - low[2], angle, ior)
        entry, leaving = at(high[2], 0), at(low[2], shift)
        if not all(low[k] <= p[k] <= high[k] for p in (entry, leaving) for k in (0, 1)):
            return None  # past the slab, or out of one of its narrow sides
        spot = at(wall_z, shift)
        aside = mp.hypot(spot[0] - mpf(lamp.position[0]), spot[1] - mpf(lamp.position[1]))
        result = []
        for b in range(3):
            through, own = t * mpf(glass.transmission[b]), mpf(glass.emission[b])
            lit = forms.lamp_on_wall(mpf(paint.diffuse[b]), mpf(lamp.intensity[b]), mpf(lamp.position[2]) - wall_z, aside)
            result.append(own + through * (own + through * (mpf(paint.emission[b]) + lit)))
        return result

    compare(case, formula, 60)


def test_a_slab_of_index_one_shifts_nothing():
    assert forms.slab_shift(mpf(2), mpf("0.7"), mpf(1)) == 0
    shift = forms.slab_shift(mpf(2), mpf("0.7"), mpf("1.5"))
    assert 0 < shift < 2 * mp.tan(mpf("0.7")), f"a slab of glass shifts by {shift}"


@pytest.mark.parametrize("case", cases_of("sphere-lens-on-axis"), ids=lambda case: case.name)
def test_a_ball_lens_casts_parallel_rays_where_trigonometry_says(case):
    scene = case.scene
    ball, screen = scene.objects
    glass, paint, lamp, film = scene.materials["glass"], scene.materials["screen"], scene.lights["lamp"], scene.film
    distance, radius = -mpf(screen.point[2]), mpf(ball.radius)
    before = distance + mpf(lamp.position[2])

    def formula(x, y):
        half = mpf(scene.camera.height_m) / 2
        at = ((2 * mpf(x) / film.width - 1) * half * film.width / film.height, (1 - 2 * mpf(y) / film.height) * half)
        height = mp.hypot(*at)
        weight, spot = [mpf(1)] * 3, at
        if height <= radius:
            reflected = height > mpf(glass.ior) * radius
            cast = forms.through_ball(height, radius, mpf(glass.ior), distance)
            if cast is None:
                return bands(scene.background)
            spot = [c / height * cast for c in at]
            weight = [mpf(1) if reflected else (mpf(glass.transparency) * mpf(k)) ** 2 for k in glass.transmission]
        aside = mp.hypot(spot[0] - mpf(lamp.position[0]), spot[1] - mpf(lamp.position[1]))
        lit = [forms.lamp_on_wall(mpf(paint.diffuse[b]), mpf(lamp.intensity[b]), before, aside) for b in range(3)]
        return [weight[b] * (mpf(paint.emission[b]) + lit[b]) for b in range(3)]

    compare(case, formula, 460)


def test_under_water_the_sky_is_seen_within_the_critical_angle_only():
    (case,) = cases_of("critical-angle")
    water, bottom = case.scene.materials["water"], case.scene.materials["bottom"]
    limit, t = forms.critical_angle(mpf(water.ior)), mpf(water.transparency)
    seen = {"sky": 0, "total": 0}

    def formula(x, y):
        _, d = camera_ray(case, x, y)
        angle = mp.atan2(mp.hypot(d[0], d[2]), d[1])
        if angle >= mp.pi / 2:
            return bands(bottom.emission)
        seen["sky" if angle < limit else "total"] += 1
        floor = bands(bottom.emission)
        if angle > limit:
            return [mpf(water.emission[b]) + floor[b] for b in range(3)]
        sky = [t * mpf(water.transmission[b]) * mpf(case.scene.background[b]) for b in range(3)]
        mirrored = [(1 - t) * mpf(water.reflection[b]) * floor[b] for b in range(3)]
        return [mpf(water.emission[b]) + mirrored[b] + sky[b] for b in range(3)]

    compare(case, formula, 830)
    assert min(seen.values()) > 150, f"pixels: {seen}"


def test_the_window_under_water_ends_at_the_critical_angle():
    (case,) = cases_of("critical-angle")
    water, bottom = case.scene.materials["water"], case.scene.materials["bottom"]
    limit = float(forms.critical_angle(mpf(water.ior)))
    reflected = np.add(water.emission, bottom.emission)
    for azimuth in np.linspace(0, 2 * math.pi, 12, endpoint=False):
        for beyond in (-1e-9, 1e-9):
            angle = limit + beyond
            way = [math.sin(angle) * math.cos(azimuth), math.cos(angle), math.sin(angle) * math.sin(azimuth)]
            position = film_positions_of(case, np.add(case.scene.camera.eye, way)[np.newaxis])
            shown = equilux_oracle.evaluate(case, position)[0]
            total = bool(np.allclose(shown, reflected, rtol=1e-14))
            assert total == (beyond > 0), f"{beyond:+g} rad beyond the critical angle, azimuth {azimuth:.2f}: {shown.tolist()}"


@pytest.mark.parametrize("ior", [0.5, 1, 1.5, 3])
@pytest.mark.parametrize("limit", [0, 1, 2, 3, 8])
def test_at_normal_incidence_a_glass_ball_shows_the_series_of_its_inner_reflections(ior, limit):
    glass = {"emission": [0.1, 0.2, 0], "transparency": 0.75, "transmission": [0.5, 1, 0.875], "reflection": [1, 0.5, 0.25]}
    case = case_of(
        {
            "equilux": 1,
            "name": "ball",
            "model": "raytraced",
            "camera": {"projection": "perspective", "eye": [1, 2, 8], "target": [1, 2, 3], "fov_y_deg": 10},
            "film": {"width": 1, "height": 1},
            "background": [0.5, 0.25, 1],
            "materials": {"glass": {**glass, "ior": ior}},
            "objects": [{"kind": "sphere", "center": [1, 2, 3], "radius": 1.5, "material": "glass"}],
            "recursion_limit": limit,
        }
    )
    found = equilux_oracle.examine(case, [[0.5, 0.5]])
    t, background = mpf(0.75), bands((0.5, 0.25, 1))
    for b in range(3):
        through, mirrored = t * mpf(glass["transmission"][b]), (1 - t) * mpf(glass["reflection"][b])
        true = forms.ball_on_axis(mpf(glass["emission"][b]), through, mirrored, background[b], limit)
        assert abs(mpf(found.radiance[0, b]) - true) <= found.bound[0, b], (
            f"index {ior}, limit {limit}, band {b}: oracle {found.radiance[0, b]!r}, formula {mp.nstr(true, 17)}"
        )


def test_the_forms_of_a_ball_meet_where_total_reflection_begins():
    # Seen from a denser medium (n < 1), at h = n r the refracted ray runs along the surface, and then no ray enters.
    radius, ior, screen = mpf(1), mpf("0.8"), mpf(3)
    angle = mp.asin(ior)
    inside, outside = (forms.through_ball(ior * (1 + sign * mpf(10) ** -40), radius, ior, screen) for sign in (-1, 1))
    grazing = ior - (screen + mp.cos(angle)) * mp.tan(2 * angle)
    assert abs(outside - grazing) < mpf(10) ** -30, f"{outside} against {grazing}"
    assert abs(inside - grazing) < mpf(10) ** -15, f"{inside} against {grazing}: the angle goes like the root of what is missing"


def test_the_oracle_never_sees_what_is_nan_or_negative():
    for name in ("glass-sphere", "water-plane", "recursion-limit"):
        picture = equilux_oracle.radiance(cases_of(name)[-1])
        assert np.isfinite(picture).all()
        assert (picture >= 0).all(), f"{name}: {picture.min()}"
