"""Rules of lights, ambient and emission, against the scene written by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_tracer import Tracer
from equilux_tracer.causes import RULES, Applied
from support.faulty import assert_same, estimated, evidence_of, picture, tried, with_cause
from support.random_scenes import case_of, changed

SPEC = {
    "equilux": 1,
    "name": "three-lights",
    "model": "phong",
    "camera": {"projection": "perspective", "eye": [0.4, 0.6, 3], "target": [0, 0, 0], "fov_y_deg": 38},
    "film": {"width": 24, "height": 18},
    "ambient": [0.1, 0.2, 0.3],
    "lights": {
        "key": {"kind": "point", "position": [1.5, 2, 3], "intensity": [7, 8, 9],
                "attenuation": {"constant": 0.5, "linear": 0.25, "quadratic": 1.5}},
        "lamp": {"kind": "spot", "position": [-0.5, 1.5, 1], "direction": [0.2, -1, -0.4], "intensity": [5, 4, 3],
                 "cone_half_angle_deg": 50, "exponent": 12},
        "sun": {"kind": "directional", "direction": [1, -0.4, -0.3], "irradiance": [0.3, 0.5, 0.4]},
    },
    "materials": {
        "clay": {"diffuse": [0.6, 0.4, 0.2], "specular": [0.5, 0.4, 0.3], "exponent": 20, "ambient": [0.7, 0.8, 0.9]},
        "wax": {"diffuse": [0.1, 0.3, 0.5], "specular": 0.2, "exponent": 3, "emission": [0.05, 0.06, 0.07], "ambient": 0.3},
    },
    "objects": [
        {"kind": "sphere", "center": [-0.5, 0, 0], "radius": 0.6, "material": "clay"},
        {"kind": "sphere", "center": [0.6, 0.2, 0.3], "radius": 0.4, "material": "wax"},
        {"kind": "plane", "point": [0, -0.7, 0], "normal": [0, 1, 0], "material": "clay"},
    ],
}  # fmt: skip
CASE = case_of(SPEC)


def lights_by_hand(spec=SPEC, **lights):
    """The case with these keys of these lights."""
    return case_of(changed(spec, lights={name: {**light, **lights.get(name, {})} for name, light in spec["lights"].items()}))


GREY = {"key": {"intensity": 7}, "lamp": {"intensity": 5}, "sun": {"irradiance": 0.3}}
"""Keys of lights without a colour."""


def materials_by_hand(spec=SPEC, **keys):
    """The case with these keys of all materials; a function is given the material's spec."""
    spec = changed(spec)
    for material in spec["materials"].values():
        material.update({key: value(material) if callable(value) else value for key, value in keys.items()})
    return case_of(spec)


def bands(value):
    return np.broadcast_to(np.asarray(value, float), 3)


def product(term, factor=1.0):
    return lambda m: (factor * bands(m.get(term, 0)) * bands(m["diffuse"])).tolist()


ONE, NONE = {"constant": 1}, {"constant": 0, "linear": 0, "quadratic": 0}
KEY = SPEC["lights"]["key"]["attenuation"]


@pytest.mark.parametrize(
    ("cause", "parameter", "reading", "lights"),
    [
        ("light-missing", "sun", "", {"sun": {"irradiance": 0}}),
        ("light-missing", ("key", "lamp"), "", {"key": {"intensity": 0}, "lamp": {"intensity": 0}}),
        ("attenuation-ignored", None, "", {"key": {"attenuation": ONE}, "lamp": {"attenuation": ONE}}),
        ("attenuation-ignored", None, "inverse-square instead", {"key": {"attenuation": {"quadratic": 1}}}),
        ("attenuation-ignored", None, "spot lights only", {"lamp": {"attenuation": ONE}}),
        ("attenuation-term-missing", "linear", "", {"key": {"attenuation": {**KEY, "linear": 0}}}),
        ("attenuation-term-missing", "quadratic", "",
         {"key": {"attenuation": {**KEY, "quadratic": 0}}, "lamp": {"attenuation": ONE}}),
        ("attenuation-term-missing", "quadratic", "none left, none lit",
         {"key": {"attenuation": {**KEY, "quadratic": 0}}, "lamp": {"intensity": 0}}),
        ("attenuation-term-missing", "quadratic", "one power lower",
         {"key": {"attenuation": {"constant": 0.5, "linear": 1.75}}, "lamp": {"attenuation": {"linear": 1}}}),
        ("attenuation-term-missing", "constant", "left at the default",
         {"key": {"attenuation": {**KEY, "constant": 1}}, "lamp": {"attenuation": {"constant": 1, "quadratic": 1}}}),
        ("spot-ignored", None, "hemisphere", {"lamp": {"cone_half_angle_deg": 90, "exponent": 0}}),
        ("spot-ignored", None, "exponent kept", {"lamp": {"cone_half_angle_deg": 90}}),
        ("spot-cone-doubled", None, "at most 90°", {"lamp": {"cone_half_angle_deg": 90}}),
        ("spot-cone-halved", None, "", {"lamp": {"cone_half_angle_deg": 25}}),
        ("spot-exponent-ignored", None, "", {"lamp": {"exponent": 0}}),
        ("spot-exponent-clamped", 4.0, "", {"lamp": {"exponent": 4}}),
    ],
)  # fmt: skip
def test_a_changed_light_is_the_light_written_by_hand(cause, parameter, reading, lights):
    got = with_cause(CASE, cause, parameter, reading)
    assert_same(got, picture(lights_by_hand(**lights)))
    assert np.abs(got - picture(CASE)).max() > 1e-4


def as_point_light(exponent=None):
    lamp = {
        key: value for key, value in SPEC["lights"]["lamp"].items() if key not in ("direction", "cone_half_angle_deg", "exponent")
    }
    return case_of(changed(SPEC, lights={**SPEC["lights"], "lamp": {**lamp, "kind": "point"}}))


@pytest.mark.parametrize(
    ("cause", "parameter", "reading"),
    [("spot-ignored", None, ""), ("spot-cone-ignored", 50.0, ""), ("spot-cone-doubled", None, "a point light from 90° on")],
)
def test_a_spot_without_a_cone_is_a_point_light(cause, parameter, reading):
    assert_same(with_cause(CASE, cause, parameter, reading), picture(as_point_light()))


def test_cones_below_the_limit_are_kept():
    assert_same(with_cause(CASE, "spot-cone-ignored", 60.0), picture(CASE))
    assert [parameter for parameter, _ in tried(CASE, "spot-cone-ignored")] == [50.0] * 3


@pytest.mark.parametrize("angle", [20.0, 45.0])
def test_a_doubled_cone_is_twice_as_wide(angle):
    narrow = lights_by_hand(lamp={"cone_half_angle_deg": angle})
    assert_same(with_cause(narrow, "spot-cone-doubled"), picture(lights_by_hand(lamp={"cone_half_angle_deg": 2 * angle})))


def test_a_cone_doubled_beyond_90_degrees_has_no_light_behind_unless_the_exponent_is_0():
    assert_same(with_cause(CASE, "spot-cone-doubled"), picture(lights_by_hand(lamp={"cone_half_angle_deg": 90})))
    even = lights_by_hand(lamp={"cone_half_angle_deg": 90, "exponent": 0})
    assert_same(with_cause(even, "spot-cone-doubled"), picture(as_point_light()))


@pytest.mark.parametrize(
    ("cause", "reading", "keys"),
    [
        ("ambient-missing", "", {"ambient": 0}),
        ("ambient-tinted", "", {"ambient": product("ambient")}),
        ("ambient-tinted", "albedo", {"ambient": product("ambient", math.pi)}),
        ("ambient-tinted", "diffuse instead", {"ambient": lambda m: m["diffuse"]}),
        ("emission-missing", "", {"emission": 0}),
        ("emission-tinted", "", {"emission": product("emission")}),
        ("emission-tinted", "hue", {"emission": lambda m: product("emission", 1 / max(m["diffuse"]))(m)}),
    ],
)
def test_a_changed_glow_is_the_glow_written_by_hand(cause, reading, keys):
    got = with_cause(CASE, cause, None, reading)
    assert_same(got, picture(materials_by_hand(**keys)))
    assert np.abs(got - picture(CASE)).max() > 1e-4


def test_the_pigment_of_a_clear_surface_leaves_no_glow():
    glass = {"emission": 0.5, "diffuse": 0.8, "transparency": 0.75, "transmission": 1}
    case = case_of(changed(SPEC, model="raytraced", materials={**SPEC["materials"], "wax": glass}))
    by_hand = case_of(
        changed(SPEC, model="raytraced", materials={**SPEC["materials"], "wax": {**glass, "emission": 0.5 * 0.8 * 0.25}})
    )
    assert_same(with_cause(case, "emission-tinted", None, "pigment"), picture(by_hand))


# --- model opengl -----------------------------------------------------------------------------------------------------

SHARES = {"ambient": [0.1, 0.2, 0.3], "diffuse": [0.9, 0.8, 0.7], "specular": [0.2, 0.9, 0.4]}
OPENGL = changed(SPEC, model="opengl")
OPENGL["lights"] = {name: {**light, **SHARES} for name, light in OPENGL["lights"].items()}
OPENGL_CASE = case_of(OPENGL)


@pytest.mark.parametrize(
    ("reading", "shares"),
    [
        ("", {"ambient": 0, "diffuse": 1, "specular": 1}),
        ("ambient", {"ambient": 0}),
        ("specular", {"specular": 1}),
        ("ambient and diffuse", {"ambient": 0, "diffuse": 1}),
        ("diffuse for the highlight", {"ambient": 0, "specular": SHARES["diffuse"]}),
        ("diffuse for all", {"ambient": SHARES["diffuse"], "specular": SHARES["diffuse"]}),
        ("strength for all", {"ambient": 1, "diffuse": 1, "specular": 1}),
    ],
)
def test_colours_without_effect_are_the_shares_written_by_hand(reading, shares):
    by_hand = lights_by_hand(OPENGL, **dict.fromkeys(OPENGL["lights"], shares))
    assert_same(with_cause(OPENGL_CASE, "light-colours-ignored", None, reading), picture(by_hand))
    assert (None, reading) in tried(OPENGL_CASE, "light-colours-ignored")


@pytest.mark.parametrize(
    ("reading", "grey"),
    [
        ("grey", lambda r, g, b: (r + g + b) / 3),
        ("grey by luminance", lambda r, g, b: 0.2126 * r + 0.7152 * g + 0.0722 * b),
        ("grey by luma", lambda r, g, b: 0.299 * r + 0.587 * g + 0.114 * b),
        ("grey, largest", lambda r, g, b: max(r, g, b)),
        ("grey, first", lambda r, g, b: r),
        ("grey, middle", lambda r, g, b: g),
        ("white", lambda r, g, b: 1),
    ],
)
def test_lights_without_a_colour_are_grey_lights_written_by_hand(reading, grey):
    keys = {"key": "intensity", "lamp": "intensity", "sun": "irradiance"}
    by_hand = lights_by_hand(**{name: {key: grey(*SPEC["lights"][name][key])} for name, key in keys.items()})
    assert_same(with_cause(CASE, "light-colours-ignored", None, reading), picture(by_hand))
    assert (None, reading) in tried(CASE, "light-colours-ignored")


def test_the_ambient_term_of_opengl_has_a_global_part_and_one_of_each_light():
    without = materials_by_hand(OPENGL, ambient=0)
    assert_same(with_cause(OPENGL_CASE, "ambient-missing"), picture(without))
    assert_same(with_cause(OPENGL_CASE, "ambient-missing", None, "global only"), picture(case_of(changed(OPENGL, ambient=0))))
    of_lights = lights_by_hand(OPENGL, **{name: {"ambient": 0} for name in OPENGL["lights"]})
    assert_same(with_cause(OPENGL_CASE, "ambient-missing", None, "lights only"), picture(of_lights))
    assert len(tried(OPENGL_CASE, "ambient-missing")) == 3
    assert len(tried(CASE, "ambient-missing")) == 1


# --- lights with an extent --------------------------------------------------------------------------------------------

AREA = {
    "equilux": 1,
    "name": "emitters",
    "model": "reflection-equation",
    "camera": {"projection": "perspective", "eye": [0, 1, 4], "target": [0, 0.4, 0], "fov_y_deg": 40},
    "film": {"width": 12, "height": 9},
    "lights": {
        "ball": {"kind": "sphere", "center": [-0.8, 1.2, 0], "radius": 0.3, "radiance": [3, 2, 1]},
        "panel": {"kind": "disc", "center": [0.8, 1.2, 0], "normal": [-0.3, -1, 0.5], "radius": 0.3, "radiance": [1, 2, 3]},
        "sky": {"kind": "environment", "radiance": [0.2, 0.3, 0.4]},
    },
    "materials": {"clay": {"diffuse": [0.3, 0.2, 0.1], "brdf": "lambert"}},
    "objects": [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "clay"}],
}
AREA_CASE = case_of(AREA)
QUADRATURE = 1e-5
"""Integrals over the emitters are asked for with an error of 1e-6 of what each adds; there are three."""


def without(*names):
    return picture(case_of(changed(AREA, lights={name: light for name, light in AREA["lights"].items() if name not in names})))


@pytest.mark.parametrize("name", AREA["lights"])
def test_an_emitter_left_out_is_not_there_at_all(name):
    assert_same(with_cause(AREA_CASE, "light-missing", name), without(name), QUADRATURE)


def test_all_lights_can_be_left_out():
    assert with_cause(AREA_CASE, "light-missing", ("ball", "panel", "sky")).max() == 0
    assert (("ball", "panel", "sky"), "") in tried(AREA_CASE, "light-missing")


def test_an_emitter_may_be_seen_black_or_light_nothing():
    ball = Tracer(AREA_CASE).render(["object_id"])["object_id"] == 1
    full, dark, unlit = (
        picture(AREA_CASE),
        with_cause(AREA_CASE, "light-missing", "ball", "dark"),
        with_cause(AREA_CASE, "light-missing", "ball", "lights nothing"),
    )
    assert ball.any()
    assert dark[ball].max() == 0
    assert (unlit[ball] == full[ball]).all()
    assert (unlit[~ball] == dark[~ball]).all()
    black = with_cause(AREA_CASE, "emission-missing", None, "emitters seen black")
    seen = Tracer(AREA_CASE).render(["object_id"])["object_id"] >= 1
    assert np.abs(black[seen]).max() == 0
    assert (black[~seen] == full[~seen]).all()


def test_an_environment_that_lights_nothing_is_a_background():
    spec = changed(AREA, background=AREA["lights"]["sky"]["radiance"])
    del spec["lights"]["sky"]
    assert_same(with_cause(AREA_CASE, "light-missing", "sky", "lights nothing"), picture(case_of(spec)), QUADRATURE)


# --- what is tried, and with which parameter --------------------------------------------------------------------------


def test_the_clamp_of_spot_exponents_is_found():
    assert estimated(CASE, "spot-exponent-clamped", 7.3)[0] == pytest.approx(7.3, rel=1e-6)
    steep = lights_by_hand(lamp={"exponent": 900})
    assert estimated(steep, "spot-exponent-clamped", 128.0)[0] == pytest.approx(128, rel=1e-6)


def test_of_many_lights_the_missing_one_is_found():
    spec = changed(SPEC)
    spec["lights"] = {
        f"l{k}": {"kind": "point", "position": [math.sin(k) * 3, 2 + 0.1 * k, 2 + math.cos(k)], "intensity": 1 + 0.1 * k}
        for k in range(12)
    }
    case = case_of(spec)
    assert tried(case, "light-missing")[0] == (None, "")
    for name in ("l0", "l7", "l11"):
        evidence = evidence_of(case, with_cause(case, "light-missing", name))
        assert RULES["light-missing"].estimates(Applied("light-missing"), evidence)[0].parameter == name


@pytest.mark.parametrize(
    ("case", "causes"),
    [
        (case_of(changed(SPEC, lights={"sun": SPEC["lights"]["sun"]})),
         ["attenuation-ignored", "attenuation-term-missing", "spot-ignored", "spot-cone-doubled", "spot-cone-halved",
          "spot-exponent-ignored", "spot-exponent-clamped", "spot-cone-ignored"]),
        (case_of(changed(SPEC, lights={})), ["light-missing"]),
        (lights_by_hand(lamp={"exponent": 0}), ["spot-exponent-ignored", "spot-exponent-clamped"]),
        (case_of(changed(SPEC, ambient=0)), ["ambient-missing", "ambient-tinted"]),
        (materials_by_hand(ambient=0), ["ambient-missing"]),
        (materials_by_hand(emission=0), ["emission-missing", "emission-tinted"]),
        (lights_by_hand(**GREY), ["light-colours-ignored"]),
        (lights_by_hand(changed(SPEC, model="opengl"), **GREY), ["light-colours-ignored"]),
    ],
)  # fmt: skip
def test_what_cannot_change_the_picture_is_not_tried(case, causes):
    found = {cause: tried(case, cause) for cause in causes}
    if case.scene.model == "opengl":  # an ambient share that is given where none was meant is all that is left
        assert {reading for _, reading in found["light-colours-ignored"]} <= {"diffuse for all"}
    else:
        assert found == {cause: [] for cause in causes}


def test_of_a_spot_that_needs_no_cone_only_other_pictures_are_tried():
    wide = lights_by_hand(lamp={"cone_half_angle_deg": 90})
    assert [reading for _, reading in tried(wide, "spot-ignored")] == ["", "hemisphere"]
    assert [reading for _, reading in tried(wide, "spot-cone-doubled")] == ["a point light from 90° on"]
    assert [reading for _, reading in tried(CASE, "spot-cone-doubled")] == ["", "a point light from 90° on"]


def test_a_light_that_falls_off_as_1_over_r_squared_has_one_term_to_miss():
    spec = changed(SPEC, lights={"key": {key: value for key, value in SPEC["lights"]["key"].items() if key != "attenuation"}})
    assert tried(case_of(spec), "attenuation-term-missing") == [
        ("quadratic", ""),
        ("constant", "left at the default"),
        ("quadratic", "one power lower"),
        ("quadratic", "none left, none lit"),
    ]
