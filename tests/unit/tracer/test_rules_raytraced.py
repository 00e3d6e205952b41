"""Changed rules of model raytraced: weights, shadows, media and limits, each on one ray whose radiance is a short sum."""

from __future__ import annotations

import math

import numpy as np
import pytest

from equilux_tracer import Tracer
from equilux_tracer.shading_rules import ShadingRules
from support.one_ray import box, close, plane, scene, sphere, sun
from support.random_scenes import case_of


def value(*objects, rules=None, channel="radiance", **what):
    case = case_of(scene(*objects, **what))
    tracer = Tracer(case) if rules is None else Tracer(case, rules=ShadingRules(**rules))
    return tracer.render([channel])[channel][0, 0]


# --- weights of L_1 and L_2 -----------------------------------------------------------------------------------------------

T, K_DIFF, K_SPEC = 0.25, 0.3, 0.7
PANE = {"diffuse": K_DIFF, "specular": K_SPEC, "exponent": 3, "transparency": T, "transmission": 0.5, "reflection": 0.4}
DOWN, UP = [0.0, 0.6, -0.8], [0.0, 0.6, 0.8]  # N·L = ±0.8; seen along −z, R·V = T·V = 0.8
LOBE = 0.8**3
BEHIND_GLOW, FRONT_GLOW = 2.0, 3.0

WEIGHTS = [
    ({"highlight_weighted": False}, (1 - T, 1, T, T)),
    ({"transmitted_highlight": False}, (1 - T, 1 - T, T, 0)),
    ({"front_weighted": False}, (1, 1, T, T)),
    ({"behind_weighted": False}, (1 - T, 1 - T, 1, 1)),
    ({"front_weighted": False, "behind_weighted": False}, (1, 1, 1, 1)),
    ({"diffuse_two_sided": True}, (1, 1 - T, 1, T)),
    ({"diffuse_two_sided": True, "front_weighted": False}, (1 + T, 1, 1 + T, T)),
    ({"diffuse_two_sided": True, "two_sided_behind": False}, (1 - T, 1 - T, 1, T)),
    ({"highlight_cosine": True}, (1 - T, 0.8 * (1 - T), T, 0.8 * T)),
    ({"highlight_cosine": True, "cosine_behind": False}, (1 - T, 0.8 * (1 - T), T, T)),
    ({"highlight_two_sided": True}, (1 - T, 1 - T, T, T)),  # R about −N is R about N, and points away from V
]


def pane(rules, lights):
    """A pane between two glowing walls, seen along −z; occlusion off, so that the walls do not shade it."""
    walls = [plane([0, 0, -5], [0, 0, 1], "low"), plane([0, 0, 9], [0, 0, 1], "high")]
    materials = {"pane": PANE, "low": {"emission": BEHIND_GLOW}, "high": {"emission": FRONT_GLOW}}
    return value(
        plane([0, 0, 0], [0, 0, 1], "pane"),
        *walls,
        materials=materials,
        lights=lights,
        eye=[0, 0, 4],
        target=[0, 0, 0],
        rules={"occlusion": False, **rules},
    )[0]


@pytest.mark.parametrize(("rules", "weights"), WEIGHTS)
def test_what_light_and_secondary_rays_on_both_sides_count(rules, weights):
    front, front_highlight, behind, behind_highlight = weights
    secondary = 0.4 * (1 if rules.get("front_weighted") is False else 1 - T) * FRONT_GLOW
    secondary += 0.5 * (1 if rules.get("behind_weighted") is False else T) * BEHIND_GLOW
    close(pane(rules, [sun(DOWN)]), K_DIFF * 0.8 * front + K_SPEC * LOBE * front_highlight + secondary)
    close(pane(rules, [sun(UP)]), K_DIFF * 0.8 * behind + K_SPEC * LOBE * behind_highlight + secondary)


def test_an_opaque_surface_has_light_from_behind_only_if_told_so():
    def seen(**rules):
        floor = plane([0, 0, 0], [0, 0, 1], "floor")
        return value(
            floor,
            materials={"floor": {"diffuse": 0.5}},
            lights=[sun(UP)],
            eye=[0, 0, 4],
            target=[0, 0, 0],
            rules={"occlusion": False, "behind_weighted": False, **rules},
        )[0]

    assert seen() == 0
    close(seen(opaque_behind=True), 0.5 * 0.8)


# --- shadows --------------------------------------------------------------------------------------------------------------

FLOOR = plane([0, 0, 0], [0, 0, 1], "floor")
MATT = {"diffuse": 1.0}
SLANT = [0.0, math.sin(math.pi / 3), -0.5]  # 60° off the normal: twice the height to go


def floor_under(*objects, materials=None, rules=None, direction=(0, 0, -1), **what):
    return value(
        FLOOR,
        *objects,
        materials={"floor": MATT, **(materials or {})},
        lights=[sun(direction)],
        eye=[0, -3, 0.05],
        target=[0, 0, 0],
        rules=rules,
        **what,
    )


def test_without_occlusion_nothing_casts_a_shadow():
    ball = sphere([0, 0, 2], 1, "floor")
    assert floor_under(ball).max() == 0
    close(floor_under(ball, rules={"occlusion": False})[0], 1.0)


GLASS = {"transparency": 0.5, "transmission": [0.8, 0.4, 0.2]}


@pytest.mark.parametrize(
    ("rule", "share"),
    [
        ("model", [0.4, 0.2, 0.1]),
        ("opaque", [0, 0, 0]),
        ("t-only", [0.5, 0.5, 0.5]),
        ("k-only", [0.8, 0.4, 0.2]),
        ("one-minus-t", [0.5, 0.5, 0.5]),
        ("once", [0.4, 0.2, 0.1]),
        ("ignored", [1, 1, 1]),
    ],
)
@pytest.mark.parametrize("spec_says", ["attenuate", "ignore"])
def test_what_a_transparent_object_leaves_of_light(rule, share, spec_says):
    glass = plane([0, 0, 1], [0, 0, 1], "glass")
    rules = {"transparent_shadow": rule, "nested_media": True}
    got = floor_under(glass, materials={"glass": GLASS}, rules=rules, transparent_shadows=spec_says)
    expected = [1, 1, 1] if (rule, spec_says) == ("model", "ignore") else share
    np.testing.assert_allclose(got, expected, rtol=1e-15, atol=0)


@pytest.mark.parametrize(
    ("bias", "along", "lit"),
    [(0.15, "along-ray", False), (0.25, "along-ray", True), (0.05, "along-normal", False), (0.15, "along-normal", True)],
)
def test_blockers_nearer_than_the_bias_are_missed(bias, along, lit):
    # 0.1 above the floor, which is 0.2 along the ray
    lid = plane([0, 0, 0.1], [0, 0, 1], "floor")
    got = floor_under(lid, rules={"shadow_bias_m": bias, "shadow_bias": along}, direction=SLANT)[0]
    close(got, 0.5 if lit else 0)


def test_an_object_that_is_crossed_twice_may_take_its_share_once():
    ball = sphere([0, 0, 2], 1, "glass")
    np.testing.assert_allclose(floor_under(ball, materials={"glass": GLASS}), [0.16, 0.04, 0.01], rtol=1e-14)
    once = floor_under(ball, materials={"glass": GLASS}, rules={"transparent_shadow": "once"})
    np.testing.assert_allclose(once, [0.4, 0.2, 0.1], rtol=1e-14)
    two = floor_under(ball, sphere([0, 0, 5], 1, "glass"), materials={"glass": GLASS}, rules={"transparent_shadow": "once"})
    np.testing.assert_allclose(two, [0.16, 0.04, 0.01], rtol=1e-14)


@pytest.mark.parametrize(
    ("bias", "kind", "height", "lit"),
    [
        (0.2, "before-light", 0.9, True),
        (0.2, "before-light", 0.7, False),
        (0.2, "before-light", 0.1, False),
        (0.2, "both-ends", 0.9, True),
        (0.2, "both-ends", 0.1, True),
        (0.2, "both-ends", 0.5, False),
        (0.2, "along-lit-normal", 0.15, True),
        (0.2, "along-lit-normal", 0.25, False),
        (0.2, "along-lit-face", 0.15, True),
        (0.2, "along-lit-face", 0.25, False),
        (0.2, "not-aimed", 0.15, True),
        (0.2, "not-aimed", 0.25, False),
    ],
)
def test_what_is_near_either_end_of_a_shadow_ray_may_be_missed(bias, kind, height, lit):
    lamp = {"kind": "point", "position": [0.1, 0, 1.0], "intensity": 1.0}
    lid = {"kind": "disc", "center": [0, 0, height], "normal": [0, 0, 1], "radius": 0.25, "material": "floor"}
    what = {"materials": {"floor": MATT}, "lights": [lamp], "eye": [0, -3, 0.05], "target": [0, 0, 0]}
    assert value(FLOOR, lid, **what)[0] == 0
    assert (value(FLOOR, lid, rules={"shadow_bias_m": bias, "shadow_bias": kind}, **what)[0] > 0) == lit


@pytest.mark.parametrize(("kind", "lit"), [("along-lit-normal", True), ("not-aimed", False)])
def test_a_shadow_ray_that_is_not_aimed_runs_beside_the_one_that_is(kind, lit):
    """From 0.5 above the floor to a lamp at (1.5, 0, 1.5): parallel to L it passes through (0.5, 0, 1), aimed at 0.75."""
    blocker = {"kind": "disc", "center": [0.5, 0, 1.0], "normal": [0, 0, 1], "radius": 0.1, "material": "floor"}
    lamp = {"kind": "point", "position": [1.5, 0, 1.5], "intensity": 1.0}
    what = {"materials": {"floor": MATT}, "lights": [lamp], "eye": [0, -3, 0.05], "target": [0, 0, 0]}
    got = value(FLOOR, blocker, rules={"shadow_bias_m": 0.5, "shadow_bias": kind}, **what)[0]
    assert (got > 0) == lit


@pytest.mark.parametrize(("kind", "share"), [("along-normal", 0), ("along-lit-normal", 0.5)])
def test_the_bias_lies_on_the_light_s_side_of_glass_or_on_the_viewer_s(kind, share):
    """Light from below a pane, a lid 0.15 below it: a ray from 0.2 above the pane meets the lid, one from 0.2 below does not."""
    lid = plane([0, 0, -0.15], [0, 0, 1], "lid")
    pane_of = {"diffuse": 1.0, "transparency": 0.5, "transmission": 1.0}
    what = {"materials": {"pane": pane_of, "lid": {}}, "lights": [sun([0, 0, 1])], "eye": [0, 0, 4], "target": [0, 0, 0]}
    close(value(plane([0, 0, 0], [0, 0, 1], "pane"), lid, rules={"shadow_bias_m": 0.2, "shadow_bias": kind}, **what)[0], share)


def test_the_bias_hides_the_far_side_of_the_object_itself():
    def seen(bias):
        ball, light = sphere([0, 0, 0], 1, "floor"), [sun([0, 0, -1])]
        rules = {"shadow_bias_m": bias, "diffuse_two_sided": True}
        return value(ball, materials={"floor": MATT}, lights=light, eye=[0, 0, -4], target=[0, 0, 0], rules=rules)[0]

    assert seen(1.9) == 0
    close(seen(2.1), 1.0)


# --- how rays are followed ------------------------------------------------------------------------------------------------


def between_mirrors(rules=None, **what):
    """Ray after ray between two mirrors that glow with 1 and reflect a half."""
    mirror = {"emission": 1.0, "reflection": 0.5}
    mirrors = [plane([0, 0, 0], [0, 0, 1], "m"), plane([0, 0, 2], [0, 0, 1], "m")]
    return value(*mirrors, materials={"m": mirror}, eye=[0, 0, 1], target=[0, 0, 0], rules=rules, **what)[0]


@pytest.mark.parametrize(("cut", "followed"), [(0.6, 0), (0.5, 1), (0.3, 1), (0.2, 2), (1e-3, 9), (1e-9, 12)])
def test_rays_of_less_weight_are_not_followed(cut, followed):
    close(between_mirrors({"weight_cut": cut}, recursion_limit=12), sum(0.5**k for k in range(followed + 1)))


def test_the_weight_is_that_of_the_brightest_band():
    mirrors = [plane([0, 0, 0], [0, 0, 1], "m"), plane([0, 0, 2], [0, 0, 1], "m")]
    material = {"emission": 1.0, "reflection": [0.5, 0.1, 0]}
    got = value(*mirrors, materials={"m": material}, eye=[0, 0, 1], target=[0, 0, 0], rules={"weight_cut": 0.3})
    np.testing.assert_allclose(got, [1.5, 1.1, 1.0], rtol=1e-15)


PANES = [plane([0, 0, z], [0, 0, 1], "clear") for z in (1, 2, 3)]
BACK = plane([0, 0, 0], [0, 0, 1], "glow")
CLEAR = {"transparency": 1.0, "transmission": 0.5, "diffuse": 0.3}


def test_transmitted_rays_that_do_not_count():
    def seen(limit, **rules):
        materials = {"clear": CLEAR, "glow": {"emission": 1.0, "reflection": 1.0}}
        what = {"recursion_limit": limit, "background": 4.0, "materials": materials, "eye": [0, 0, 5], "target": [0, 0, 0]}
        return value(*PANES, BACK, rules=rules, **what)[0]

    assert seen(2) == 0
    close(seen(0, transmission_counted=False), 0.125)
    # the mirror ray counts, and passes the panes without counting any more
    close(seen(1, transmission_counted=False), 0.125 + 0.125 * 0.125 * 4)


def test_terms_of_the_first_surface_are_its_own_where_rays_do_not_count():
    # a floor beyond the panes is lit, the panes are not: the channel shows what the first surface does
    lights, materials = [sun([0, 0, -1])], {"clear": {**CLEAR, "diffuse": 0.0}, "glow": {"diffuse": 1.0}}
    what = {"materials": materials, "lights": lights, "eye": [0, 0, 5], "target": [0, 0, 0]}
    rules = {"transmission_counted": False}
    assert value(*PANES, BACK, rules=rules, channel="diffuse", **what).max() == 0
    assert value(*PANES, BACK, rules=rules, channel="transmitted", **what).min() > 0


def test_at_most_256_rays_go_through_where_they_do_not_count():
    panes = [plane([0, 0, 1 + z / 300], [0, 0, 1], "clear") for z in range(257)]
    clear = {"clear": {"transparency": 1.0, "transmission": 1.0}, "glow": {"emission": 1.0}}
    what = {"materials": clear, "eye": [0, 0, 5], "target": [0, 0, 0], "rules": {"transmission_counted": False}}
    assert value(*panes, BACK, **what)[0] == 0
    assert value(*panes[:256], BACK, **what)[0] == 1


# --- total reflection -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rule", "weight"),
    [
        ("one", 1.0),
        ("mirror", (1 - T) * 0.4),
        ("transmitted", (1 - T) * 0.4 + T * 0.5),
        ("none", 0.0),
        ("k-refl", 0.4),
        ("one-minus-t", 1 - T),
        ("through", T * 0.5),
        ("k-trans", 0.5),
        ("t", T),
        ("mirror-and-t", (1 - T) * 0.4 + T),
    ],
)
def test_the_weight_of_a_totally_reflected_ray(rule, weight):
    water = {"transparency": T, "reflection": 0.4, "transmission": 0.5, "ior": 1.5}
    objects = [plane([0, 0, 0], [0, 0, 1], "water"), plane([0, 0, -3], [0, 0, 1], "ground")]
    materials = {"water": water, "ground": {"emission": 2.0}}
    rules = {"total_reflection": rule, "opaque_behind": True}
    got = value(*objects, materials=materials, eye=[0, 0, -1], target=[0, 2, 0], rules=rules)[0]
    close(got, 2.0 * weight)


# --- nested media ---------------------------------------------------------------------------------------------------------

WATER, CORE = 1.33, 1.5
SIN = 0.6  # of the ray's angle in air
LAYERS = {"water": {"transparency": 1.0, "transmission": 1.0, "ior": WATER}, "glow": {"emission": 1.0}}


def landing(*layers):
    """y at z = 0 of a ray that starts at y = 0, z = 10 with sine SIN in air: through layers (thickness, sine)."""
    return sum(thickness * sine / math.sqrt(1 - sine * sine) for thickness, sine in layers)


def slabs(core_ior, y, rules, eye=(0, 0, 10), sine=SIN):
    """Whether the ray through a slab of water 6 thick around one 2 thick meets a dot at y on the ground."""
    dot = {"kind": "disc", "center": [0, y, 0], "normal": [0, 0, 1], "radius": 1e-9, "material": "glow"}
    objects = [box([-90, -90, 2], [90, 90, 8], "water"), box([-80, -80, 4], [80, 80, 6], "core"), dot]
    materials = {**LAYERS, "core": {**LAYERS["water"], "ior": core_ior}}
    target = [0, eye[1] + sine, eye[2] - math.sqrt(1 - sine * sine)]
    return value(*objects, materials=materials, eye=list(eye), target=target, rules=rules)[0]


@pytest.mark.parametrize("core", [CORE, 1.0, 1.33], ids=["glass", "air", "the same"])
def test_slabs_in_slabs_bend_by_snell_s_law_throughout(core):
    y = landing((2, SIN), (2, SIN / WATER), (2, SIN / core), (2, SIN / WATER), (2, SIN))
    assert slabs(core, y, {"nested_media": True}) == 1


def test_the_model_bends_from_air_into_the_inner_slab():
    y = landing((2, SIN), (2, SIN / WATER), (2, SIN / WATER / CORE), (2, SIN / WATER), (2, SIN))
    assert slabs(CORE, y, None) == 1
    assert slabs(CORE, y, {"nested_media": True}) == 0


def test_an_eye_inside_the_outer_medium():
    y = landing((1, SIN), (2, SIN * WATER / CORE), (2, SIN), (2, SIN * WATER))
    assert slabs(CORE, y, {"nested_media": True}, eye=(0, 0, 7)) == 1


def test_panes_without_thickness_are_no_media():
    pane = {"kind": "disc", "center": [0, 0, 7], "normal": [0, 0, -1], "radius": 50, "material": "clear"}
    dot_at = landing((2, SIN), (6, SIN / WATER), (2, SIN))
    dot = {"kind": "disc", "center": [0, dot_at, 0], "normal": [0, 0, 1], "radius": 1e-9, "material": "glow"}
    materials = {**LAYERS, "clear": {"transparency": 1.0, "transmission": 1.0}}
    objects = [box([-90, -90, 2], [90, 90, 8], "water"), pane, dot]
    target = [0, SIN, 10 - math.sqrt(1 - SIN * SIN)]
    assert value(*objects, materials=materials, eye=[0, 0, 10], target=target, rules={"nested_media": True})[0] == 1


def test_an_inner_medium_can_reflect_totally_only_against_the_outer_one():
    # sin 0.7 in glass: beyond 1/1.5, within 1.33/1.5
    y = landing((1, 0.7), (2, 0.7 * CORE / WATER))
    inside = {"eye": (0, 0, 5), "sine": 0.7}
    assert slabs(CORE, y, None, **inside) == 0
    # and then totally, against air: the ray stays in the water and meets the slabs' sides far off
    assert slabs(CORE, y, {"nested_media": True}, **inside) == 0
    outer = {"kind": "disc", "center": [0, y, 2 + 1e-3], "normal": [0, 0, 1], "radius": 1e-2, "material": "glow"}
    objects = [box([-90, -90, 2], [90, 90, 8], "water"), box([-80, -80, 4], [80, 80, 6], "core"), outer]
    materials = {**LAYERS, "core": {**LAYERS["water"], "ior": CORE}}
    target = [0, 0.7, 5 - math.sqrt(1 - 0.49)]
    got = [value(*objects, materials=materials, eye=[0, 0, 5], target=target, rules=r)[0] for r in (None, {"nested_media": True})]
    assert got == [0, 1]


# --- how the transmitted ray goes on --------------------------------------------------------------------------------------


def through_a_slab(y, rules):
    """Whether the ray that enters a slab of glass, 4 thick, with sine 0.6 meets a dot at y on the ground 2 below."""
    dot = {"kind": "disc", "center": [0, y, 0], "normal": [0, 0, 1], "radius": 1e-6, "material": "glow"}
    glass = {"transparency": 1.0, "transmission": 1.0, "ior": CORE}
    what = {"materials": {"glass": glass, "glow": {"emission": 1.0}}, "eye": [0, 0, 10], "target": [0, SIN, 10 - 0.8]}
    return value(box([-90, -90, 2], [90, 90, 6], "glass"), dot, rules=rules, **what)[0]


@pytest.mark.parametrize(
    ("rules", "inside", "below"),
    [
        ({}, SIN / CORE, SIN),
        ({"transmitted_ray": "straight"}, SIN, SIN),
        ({"transmitted_ray": "inverted"}, SIN * CORE, SIN),
        ({"transmitted_ray": "entering"}, SIN / CORE, SIN / CORE / CORE),
        ({"always_entering": True}, SIN / CORE, SIN / CORE / CORE),
    ],
    ids=str,
)
def test_the_transmitted_ray_bends_as_the_rule_says(rules, inside, below):
    y = landing((4, SIN), (4, inside), (2, below))
    assert through_a_slab(y, rules) == 1
    assert through_a_slab(y + 1e-5, rules) == 0


def test_transmitted_rays_may_be_left_out_while_total_reflection_stays():
    assert through_a_slab(landing((4, SIN), (4, SIN / CORE), (2, SIN)), {"transmitted_ray": "none"}) == 0
    water = {"transparency": 1.0, "transmission": 1.0, "ior": 1.5}
    above = plane([0, 0, 9], [0, 0, 1], "glow")
    what = {"materials": {"water": water, "glow": {"emission": 5.0}}, "eye": [0, 0, -1], "target": [0, 2, 0], "background": 3.0}
    seen = {way: value(plane([0, 0, 0], [0, 0, 1], "water"), above, rules={"transmitted_ray": way}, **what)[0] for way in WAYS}
    assert seen == {"model": 3, "none": 3, "straight": 5}


WAYS = ("model", "none", "straight")


def test_the_weight_of_the_last_ray_alone_may_be_compared():
    close(between_mirrors({"weight_cut": 0.3, "weight_cut_alone": True}, recursion_limit=12), sum(0.5**k for k in range(13)))
    close(between_mirrors({"weight_cut": 0.6, "weight_cut_alone": True}, recursion_limit=12), 1.0)


# --- V --------------------------------------------------------------------------------------------------------------------


def wall_seen(target, projection, viewer):
    """A shiny wall, seen at once or in a mirror."""
    lamp = {"kind": "point", "position": [1.0, 0, 2.0], "intensity": 1.0}
    objects = [plane([0, 0, 0], [0, 0, 1], "wall"), plane([4, 0, 0], [-1, 0, 0], "mirror")]
    materials = {"wall": {"specular": 1.0, "exponent": 4}, "mirror": {"reflection": 1.0}}
    spec = scene(*objects, materials=materials, lights=[lamp], eye=[1.0, 0.5, 2], target=target)
    spec["camera"] = {"eye": [1.0, 0.5, 2], "target": target, **projection}
    spec["film"] = {"width": 2, "height": 2}
    return Tracer(case_of(spec), rules=ShadingRules(viewer=viewer)).render()["radiance"][0, 0, 0]


@pytest.mark.parametrize(
    ("wrong", "projection"),
    [
        ("from-eye", {"projection": "orthographic", "height_m": 1.0}),
        ("fixed", {"projection": "perspective", "fov_y_deg": 30}),
    ],
)
def test_v_may_be_wrong_on_the_camera_s_own_surfaces_alone(wrong, projection):
    for target, first in (([0.5, 0, 0], True), ([4, 0, 1.0], False)):
        right, everywhere, here = (wall_seen(target, projection, viewer) for viewer in ("model", wrong, wrong + "-first"))
        assert right != everywhere
        assert here == (everywhere if first else right)


# --- the path signature ---------------------------------------------------------------------------------------------------


def signatures_across_a_shadow(**rules):
    camera = {"projection": "orthographic", "eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 8}
    spec = scene(FLOOR, sphere([4, 0, 9], 1, "floor"), materials={"floor": MATT}, lights=[sun([-0.6, 0, -0.8])], eye=[0, 0, 1],
                 target=[0, 0, 0])  # fmt: skip
    spec |= {"camera": camera, "film": {"width": 8, "height": 8}}
    centre = 4 + 4 - 9 * 0.75  # of the shadow, in pixels
    positions = [[centre, 4.0], [centre + 1.5, 4.0]]
    out = Tracer(case_of(spec), rules=ShadingRules(**rules)).evaluate(positions, ["signature", "radiance"])
    return out["signature"], out["radiance"][:, 0]


def test_without_occlusion_the_signature_knows_no_shadows():
    (in_shadow, lit), radiance = signatures_across_a_shadow(half_vector=True)
    assert in_shadow != lit
    assert radiance[0] == 0 < radiance[1]
    (in_shadow, lit), radiance = signatures_across_a_shadow(occlusion=False)
    assert in_shadow == lit
    assert radiance[0] == radiance[1] > 0
