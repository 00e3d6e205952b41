"""Model `opengl`: what the fixed-function rules do differently, light by light."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_tracer import Tracer
from support.random_scenes import case_of, changed, random_spec

FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
LAMP = {"kind": "point", "position": [0.5, 1.0, 2.0], "intensity": 3.0}


def look(make_case, *objects, eye=(2.0, 0.0, 1.5), target=(0.0, 0.0, 0.0), projection="perspective", **scene):
    size = {"fov_y_deg": 20} if projection == "perspective" else {"height_m": 1}
    camera = {"projection": projection, "eye": list(eye), "target": list(target), "up": [0, 0, 1], **size}
    case = make_case(*objects, model="opengl", camera=camera, film={"width": 1, "height": 1}, **scene)
    names = ["radiance", "emission", "ambient", "light_ambient", "diffuse", "specular", "rounding"]
    return {name: array[0, 0] for name, array in Tracer(case).render(names).items()}


def unit(v):
    return np.asarray(v, dtype=float) / np.linalg.norm(v)


def close(got, expected):
    assert abs(got - expected) <= 1e-14 * abs(expected), f"got {got!r}, expected {expected!r}"


@pytest.mark.parametrize("viewer", ["local", "infinite"])
@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_the_highlight_is_that_of_the_half_vector(make_case, viewer, projection):
    # off the middle of the film, so that the two viewers differ
    material = {"specular": 0.8, "exponent": 20}
    film = {"width": 3, "height": 3}
    eye, target = np.array([2.0, 0.3, 1.5]), np.array([0.0, 0.1, 0.0])
    size = {"fov_y_deg": 30} if projection == "perspective" else {"height_m": 1}
    camera = {"projection": projection, "eye": eye.tolist(), "target": target.tolist(), "up": [0, 0, 1], **size}
    case = make_case(FLOOR, lights=[LAMP], material=material, model="opengl", viewer=viewer, camera=camera, film=film)
    found = Tracer(case).render(["radiance", "position"])
    point = found["position"][0, 2]
    to_light = np.array(LAMP["position"]) - point
    v = unit(eye - target) if viewer == "infinite" else unit(eye - point)
    expected = 3.0 / (to_light @ to_light) * 0.8 * unit(unit(to_light) + v)[2] ** 20
    assert abs(found["radiance"][0, 2, 0] - expected) < 1e-13, f"got {found['radiance'][0, 2, 0]}, expected {expected}"


def test_attenuation_and_cone_weaken_the_ambient_share_of_a_light_too(make_case):
    spot = {**LAMP, "kind": "spot", "direction": [-0.5, -1.0, -2.0], "exponent": 2, "cone_half_angle_deg": 30, "ambient": 0.5}
    spot["attenuation"] = {"constant": 1.0, "linear": 0.5}
    found = look(make_case, FLOOR, lights=[spot], material={"ambient": 0.2}, ambient=0.7)
    r = math.sqrt(0.25 + 1 + 4)
    close(float(found["light_ambient"][0, 0]), 3.0 * 0.5 * 0.2 / (1 + 0.5 * r))
    close(float(found["ambient"][0]), 0.2 * 0.7)
    close(float(found["radiance"][0]), 0.2 * 0.7 + 3.0 * 0.5 * 0.2 / (1 + 0.5 * r))
    outside = look(make_case, FLOOR, lights=[{**spot, "direction": [1, 0, 0]}], material={"ambient": 0.2}, ambient=0.7)
    close(float(outside["radiance"][0]), 0.2 * 0.7)


def test_a_light_below_the_surface_still_gives_its_ambient_share(make_case):
    below = {"kind": "directional", "direction": [0, 0, 1], "irradiance": 2.0, "ambient": 0.25}
    found = look(make_case, FLOOR, lights=[below], material={"ambient": 0.5, "diffuse": 1.0, "specular": 1.0, "exponent": 0})
    close(float(found["radiance"][0]), 2.0 * 0.25 * 0.5)


def test_shares_of_a_light_multiply_their_terms_and_no_other(make_case):
    sun = {"kind": "directional", "direction": [0, 0, -1], "irradiance": [1.0, 2.0, 4.0]}
    shares = {"ambient": [0.1, 0.2, 0.3], "diffuse": [0.4, 0.5, 0.6], "specular": [0.7, 0.8, 0.9]}
    material = {"ambient": 0.5, "diffuse": 0.25, "specular": 0.125, "exponent": 0}
    found = look(make_case, FLOOR, lights=[{**sun, **shares}], material=material)
    for band, irradiance in enumerate((1.0, 2.0, 4.0)):
        close(float(found["light_ambient"][0, band]), irradiance * shares["ambient"][band] * 0.5)
        close(float(found["diffuse"][0, band]), irradiance * shares["diffuse"][band] * 0.25)
        close(float(found["specular"][0, band]), irradiance * shares["specular"][band] * 0.125)


def test_a_highlight_of_exponent_zero_is_there_wherever_the_light_is_in_front(make_case):
    # the infinite viewer is below the floor, where N·H < 0: max(0, N·H)^0 = 1
    camera = {"projection": "perspective", "eye": [0, 0, 1], "target": [4, 0, 2], "up": [0, 0, 1], "fov_y_deg": 150}
    grazing = {"kind": "directional", "direction": [1, 0, -0.01], "irradiance": 2.0}
    view = {"model": "opengl", "viewer": "infinite", "camera": camera, "film": {"width": 1, "height": 4}}
    for exponent, expected in ((0, 0.5), (1, 0.0)):
        case = make_case(FLOOR, lights=[grazing], material={"specular": 0.25, "exponent": exponent}, **view)
        got = Tracer(case).render()["radiance"][3, 0, 0]
        assert got == expected, f"got {got}, expected {expected} with exponent {exponent}"


def test_both_faces_are_lit_alike(make_case):
    setting = {"lights": [LAMP], "material": {"diffuse": 0.5, "specular": 0.5, "exponent": 5}}
    above, turned = look(make_case, FLOOR, **setting), look(make_case, {**FLOOR, "normal": [0, 0, -1]}, **setting)
    assert above["radiance"].tolist() == turned["radiance"].tolist()


def test_nothing_casts_a_shadow(make_case):
    shade = {"kind": "sphere", "center": [0.25, 0.5, 1.0], "radius": 0.3}
    alone = look(make_case, FLOOR, lights=[LAMP], material={"diffuse": 0.5})
    shaded = look(make_case, FLOOR, shade, lights=[LAMP], material={"diffuse": 0.5})
    assert alone["radiance"].tolist() == shaded["radiance"].tolist()


@pytest.mark.parametrize("seed", range(3))
def test_without_highlights_and_shares_it_is_phong(seed):
    spec = random_spec(seed)
    for material in spec["materials"].values():
        material["specular"] = 0.0
    phong, opengl = (Tracer(case_of(changed(spec, model=model))).render()["radiance"] for model in ("phong", "opengl"))
    np.testing.assert_allclose(opengl, phong, rtol=1e-15, atol=0)


@pytest.mark.parametrize("viewer", ["local", "infinite"])
@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_sensitivity_moves_the_half_vector(make_case, viewer, projection):
    # a normal turned by δ: the plane really turned about the point that is seen
    step, material = 1e-3, {"specular": 0.8, "exponent": 20, "diffuse": 0.1}
    setting = {"lights": [LAMP], "material": material, "viewer": viewer, "projection": projection}
    base = look(make_case, FLOOR, **setting)["radiance"][0]
    expected = 0.0
    for tangent in ([1, 0, 0], [0, 1, 0]):
        turned = [{**FLOOR, "normal": np.add([0, 0, 1], np.multiply(s * step, tangent)).tolist()} for s in (1, -1)]
        expected += max(abs(look(make_case, floor, **setting)["radiance"][0] - base) for floor in turned)
    size = {"fov_y_deg": 20} if projection == "perspective" else {"height_m": 1}
    camera = {"projection": projection, "eye": [2.0, 0.0, 1.5], "target": [0.0, 0.0, 0.0], "up": [0, 0, 1], **size}
    film = {"width": 1, "height": 1}
    case = make_case(FLOOR, lights=[LAMP], material=material, model="opengl", viewer=viewer, camera=camera, film=film)
    got = Tracer(case).sensitivity(step, 0)[0, 0, 0]
    assert abs(got - expected) <= 1e-9 * expected, f"got {got}, expected {expected}"
