"""Rules of shadows, mirrors and glass, against the scene written by hand and against numbers of single rays."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_tracer import Tracer
from equilux_tracer.causes import RULES, Applied
from support.faulty import assert_same, estimated, evidence_of, picture, tried, with_cause
from support.one_ray import box, lamp, plane, scene, sphere
from support.random_scenes import case_of, changed

GLASS = {
    "diffuse": 0.1,
    "specular": 0.3,
    "exponent": 9,
    "reflection": 0.2,
    "transmission": [0.9, 0.8, 0.7],
    "transparency": 0.6,
    "ior": 1.4,
}
SPEC = {
    "equilux": 1,
    "name": "mirror-and-glass",
    "model": "raytraced",
    "camera": {"projection": "perspective", "eye": [0.4, 1.2, 3], "target": [0, 0, 0], "fov_y_deg": 40},
    "film": {"width": 32, "height": 24},
    "ambient": [0.02, 0.03, 0.01],
    "background": [0.3, 0.4, 0.5],
    "lights": {
        "key": {"kind": "point", "position": [1.5, 3, 2], "intensity": [7, 8, 9]},
        "sun": {"kind": "directional", "direction": [1, -0.8, -0.6], "irradiance": [0.9, 0.5, 0.4]},
    },
    "materials": {
        "mirror": {"diffuse": 0.1, "specular": 0.2, "exponent": 30, "reflection": [0.7, 0.6, 0.5]},
        "glass": GLASS,
        "floor": {"diffuse": [0.4, 0.3, 0.2], "ambient": 1, "reflection": 0.1},
    },
    "objects": [
        {"kind": "sphere", "center": [-0.6, 0, 0], "radius": 0.5, "material": "mirror"},
        {"kind": "sphere", "center": [0.5, 0, 0.4], "radius": 0.4, "material": "glass"},
        {"kind": "rectangle", "corner": [-2, -0.5, 2], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4], "material": "floor"},
    ],
    "recursion_limit": 5,
}  # fmt: skip
CASE = case_of(SPEC)


def by_hand(glass=None, mirror=None, floor=None, **scene_keys):
    spec = changed(SPEC, **scene_keys)
    for name, keys in (("glass", glass), ("mirror", mirror), ("floor", floor)):
        spec["materials"][name].update(keys or {})
    return case_of(spec)


OWN = {"diffuse": 0.1 * 0.4, "specular": 0.3 * 0.4, "reflection": 0.2 * 0.4}


@pytest.mark.parametrize(
    ("cause", "parameter", "reading", "changes"),
    [
        ("transparent-shadow-rule", None, "", {"transparent_shadows": "ignore"}),
        ("reflection-missing", None, "", {key: {"reflection": 0} for key in ("glass", "mirror", "floor")}),
        ("refraction-missing", None, "", {"glass": {"transmission": 0}}),
        ("refraction-missing", None, "opaque", {"glass": {"transparency": 0, "ior": 1}}),
        ("refraction-missing", None, "opaque, 1 − t of its own", {"glass": {"transparency": 0, "ior": 1, **OWN}}),
        ("refraction-missing", None, "not bent", {"glass": {"ior": 1}}),
        ("recursion-cut", 2, "", {"recursion_limit": 2}),
        ("recursion-cut", 7, "beyond the limit", {"recursion_limit": 7}),
        ("index-inverted", None, "", {"glass": {"ior": 1 / 1.4}}),
        ("background-missing", None, "", {"background": 0}),
        ("background-missing", None, "ambient", {"background": SPEC["ambient"]}),
        ("background-missing", (0.5, 0.25, 0.75), "another radiance", {"background": [0.5, 0.25, 0.75]}),
    ],
)
def test_a_changed_scene_is_the_scene_written_by_hand(cause, parameter, reading, changes):
    got = with_cause(CASE, cause, parameter, reading)
    assert_same(got, picture(by_hand(**changes)))
    assert np.abs(got - picture(CASE)).max() > 1e-6


def test_a_recursion_limit_below_the_cut_stays():
    assert_same(with_cause(CASE, "recursion-cut", 9), picture(CASE))


def test_without_occlusion_the_local_terms_are_those_of_model_phong():
    plain = {name: {k: v for k, v in material.items() if k != "reflection"} for name, material in SPEC["materials"].items()}
    spec = changed(SPEC, materials={**plain, "glass": plain["mirror"]})
    phong = changed(spec, model="phong")
    del phong["recursion_limit"]
    assert_same(with_cause(case_of(spec), "occlusion-ignored"), picture(case_of(phong)))


def directly_seen(case, obj):
    return Tracer(case).render(["object_id"])["object_id"] == obj


@pytest.mark.parametrize(
    ("reading", "glass"),
    [
        ("opaque", {"transmission": 0}),
        ("1 − t", {"transmission": 0.4 / 0.6}),
        ("once per object", {"transmission": np.sqrt([0.9 / 0.6, 0.8 / 0.6, 0.7 / 0.6]).tolist()}),
        ("t only", {"transmission": 1}),
        ("k_trans only", {"transmission": [0.9 / 0.6, 0.8 / 0.6, 0.7 / 0.6]}),
    ],
)
def test_the_shadow_of_glass_is_that_of_other_glass(reading, glass):
    floor = directly_seen(CASE, 2)
    # No mirror shows the glass itself.
    dull = {"floor": {"reflection": 0}}
    got = with_cause(by_hand(**dull), "transparent-shadow-rule", None, reading)[floor]
    assert_same(got, picture(by_hand(glass=glass, **dull))[floor])
    assert np.abs(got - picture(by_hand(**dull))[floor]).max() > 1e-3


def test_black_glass_may_cast_the_shadow_of_clear_glass():
    dull = {"floor": {"reflection": 0}}
    got = with_cause(by_hand(**dull), "refraction-missing", None, "black, shadows by t")
    floor = directly_seen(CASE, 2)
    assert_same(got[floor], picture(by_hand(glass={"transmission": 1}, **dull))[floor])


def test_the_background_may_be_missing_in_mirrors_only_or_for_the_camera_only():
    black, full, missed = picture(by_hand(background=0)), picture(CASE), directly_seen(CASE, -1)
    in_mirrors = with_cause(CASE, "background-missing", None, "black in mirrors")
    for_camera = with_cause(CASE, "background-missing", None, "black for the camera")
    assert missed.any()
    assert (in_mirrors[missed] == full[missed]).all()
    assert_same(in_mirrors[~missed], black[~missed])
    assert np.abs(for_camera[missed]).max() == 0
    assert_same(for_camera[~missed], full[~missed])


# --- single rays ------------------------------------------------------------------------------------------------------


def seen(case, cause, parameter=None, reading=""):
    return float(with_cause(case, cause, parameter, reading)[0, 0, 0])


@pytest.mark.parametrize(
    ("reading", "weight"),
    [
        ("", 0.4 * 0.3),
        ("k_refl", 0.3),
        ("t k_trans", 0.6 * 0.8),
        ("transmitted too", 0.4 * 0.3 + 0.6 * 0.8),
        ("none", 0.0),
        ("t", 0.6),
        ("t too", 0.4 * 0.3 + 0.6),
        ("k_trans", 0.8),
        ("1 − t", 0.4),
    ],
)
def test_total_reflection_has_the_weight_of_the_rule(reading, weight):
    water = {"reflection": 0.3, "transmission": 0.8, "transparency": 0.6, "ior": 1.33}
    case = case_of(
        scene(plane([0, 0, 0], [0, 1, 0], "w"), materials={"w": water}, eye=[0, -1, 0], target=[3, 0, 0], background=2.0)
    )
    assert picture(case)[0, 0, 0] == 2.0
    assert seen(case, "tir-weight", None, reading) == pytest.approx(2 * weight, abs=1e-15)
    assert seen(case, "reflection-missing", None, "total reflection too") == 0
    assert seen(case, "refraction-missing", None, "not followed") == 2.0
    assert seen(case, "refraction-missing", None, "not followed, nor totally reflected") == 0


def test_weights_of_total_reflection_that_are_the_same_here_are_tried_once():
    clear = {"diffuse": 0.1, "reflection": 0.2, "transmission": 1, "transparency": 1, "ior": 1.5}
    assert [reading for _, reading in tried(by_hand(glass=clear), "tir-weight")] == ["", "k_refl"], (
        "0 and 0.2; all others are 0 or 1"
    )


def test_glass_in_glass_of_the_same_index_is_not_there_where_media_nest():
    clear = {"transparency": 1, "transmission": 1, "ior": 1.5}
    outer, inner = sphere([0, 0, 0], 1, "g"), sphere([0.2, 0, 0], 0.4, "g")
    what = {
        "materials": {"g": clear, "f": {"diffuse": 1}}, "eye": [0.3, 0.4, 4], "target": [0.25, 0.1, 0],
        "lights": [lamp([1, 2, -3])],
        "transparent_shadows": "ignore",
    }  # fmt: skip
    screen = plane([0, 0, -4], [0, 0, 1], "f")
    both, alone = case_of(scene(outer, inner, screen, **what)), case_of(scene(outer, screen, **what))
    assert seen(both, "nested-media") == pytest.approx(picture(alone)[0, 0, 0], rel=1e-12)
    assert abs(picture(both)[0, 0, 0] - picture(alone)[0, 0, 0]) > 1e-4
    assert tried(both, "nested-media") == [(None, "")]
    assert tried(alone, "nested-media") == []


def test_transmitted_rays_that_do_not_count_reach_the_background():
    case = case_of(
        scene(sphere([0, 0, 0], 1, "g"), materials={"g": {"transparency": 0.5, "transmission": 1, "ior": 1.5}}, eye=[0, 0, 4],
              target=[0, 0, 0], background=2.0, recursion_limit=1)
    )  # fmt: skip
    assert picture(case)[0, 0, 0] == 0
    assert seen(case, "transmission-uncounted") == 2 * 0.25


def sheet(**more):
    material = {"diffuse": 0.5, "reflection": 0.4, "transmission": 0.8, "transparency": 0.25}
    lights = [{"kind": "directional", "direction": [0, 0, -1], "irradiance": 3.0}]
    return case_of(scene(plane([0, 0, 0], [0, 0, 1], "s"), materials={"s": material}, eye=[0, 0, 4], target=[0, 0, 0],
                         background=2.0, lights=lights, **more))  # fmt: skip


@pytest.mark.parametrize(
    ("reading", "front", "behind"),
    [("", 1, 1), ("1 − t left out", 1, 0.25), ("t left out", 0.75, 1), ("in shadows too", 1, 1), ("opaque surfaces too", 1, 1)],
)
def test_weights_of_a_transparent_surface_are_those_of_the_rule(reading, front, behind):
    own, through = 3 * 0.5 + 0.4 * 2, 0.8 * 2
    assert picture(sheet())[0, 0, 0] == pytest.approx(0.75 * own + 0.25 * through, rel=1e-14)
    assert seen(sheet(), "transparency-weight-ignored", None, reading) == pytest.approx(front * own + behind * through, rel=1e-14)


def between_mirrors(k=0.5, limit=12):
    mirror = {"emission": 1.0, "reflection": k}
    return case_of(
        scene(plane([0, 0, 0], [0, 0, 1], "m"), plane([0, 0, 4], [0, 0, -1], "m"), materials={"m": mirror}, eye=[0, 0, 2],
              target=[0.3, 0, 0], recursion_limit=limit)
    )  # fmt: skip


@pytest.mark.parametrize(("cut", "terms"), [(0.6, 1), (0.1, 4), (1 / 255, 8)])
def test_rays_below_the_weight_are_not_followed(cut, terms):
    assert seen(between_mirrors(), "weight-cut", cut) == pytest.approx(sum(0.5**n for n in range(terms)), rel=1e-14)


@pytest.mark.parametrize("cut", [0.3, 0.1, 1 / 255, 0.0005])
def test_the_weight_at_which_rays_end_is_among_the_estimates(cut):
    case = between_mirrors()
    shown = seen(case, "weight-cut", cut)
    tried_cuts = estimated(case, "weight-cut", cut)
    assert len(tried_cuts) <= 12, "one for each number of mirrors"
    assert [seen(case, "weight-cut", value) for value in tried_cuts].count(shown) == 1
    if cut == 1 / 255:
        assert cut in tried_cuts


@pytest.mark.parametrize(
    ("reading", "length", "shadow"),
    [
        ("", 0.3, False),
        ("", 0.2, True),
        ("off the surface", 0.3, False),
        ("off the surface", 0.2, True),
        ("off the surface, not aimed", 0.3, False),
        ("off the face", 0.3, False),
        ("both ends", 0.3, False),
        ("before the light", 49.8, False),
        ("before the light", 49.7, True),
    ],
)
def test_blockers_nearer_than_the_bias_cast_no_shadow(reading, length, shadow):
    """A lid a quarter above the floor, the floor seen from beside it."""
    objects = [plane([0, 0, 0], [0, 1, 0], "f"), box([-1, 0.25, -1], [1, 0.26, 1], "f")]
    case = case_of(
        scene(*objects, materials={"f": {"diffuse": 1}}, eye=[3, 0.6, 0], target=[0.5, 0, 0], lights=[lamp([0, 50, 0], 2500.0)])
    )
    bare = picture(case_of(scene(objects[0], materials={"f": {"diffuse": 1}}, eye=[3, 0.6, 0], target=[0.5, 0, 0],
                                 lights=[lamp([0, 50, 0], 2500.0)])))  # fmt: skip
    assert picture(case)[0, 0, 0] == 0
    assert seen(case, "shadow-bias", length, reading) == pytest.approx(0 if shadow else bare[0, 0, 0], rel=1e-12)
    lengths = [value.parameter for value in RULES["shadow-bias"].estimates(Applied("shadow-bias"), evidence_of(case, bare))]
    assert min(lengths) < 1e-3 < 0.5 in lengths


def test_of_many_weights_a_few_are_tried_and_the_right_one_is_among_them():
    glass = {"reflection": [0.31, 0.2, 0.17], "transmission": [0.93, 0.8, 0.7], "transparency": 0.55}
    case = by_hand(glass=glass, mirror={"reflection": [0.7, 0.6, 0.5]}, floor={"reflection": [0.13, 0.1, 0.2]}, recursion_limit=6)
    for cut in (1 / 255, 0.05, 0.0137):
        shown = with_cause(case, "weight-cut", cut)
        assert np.abs(shown - picture(case)).max() > 1e-6
        cuts = estimated(case, "weight-cut", cut)
        assert len(cuts) <= 20
        assert any(np.array_equal(with_cause(case, "weight-cut", value), shown) for value in cuts), (cut, cuts)


def test_the_weight_of_each_ray_alone_may_decide():
    assert seen(between_mirrors(), "weight-cut", 0.4, "each ray alone") == picture(between_mirrors())[0, 0, 0]
    assert seen(between_mirrors(), "weight-cut", 0.6, "each ray alone") == 1.0
    assert [value for value in estimated(between_mirrors(), "weight-cut", 0.6, "each ray alone") if value > 0.5]


# --- what is tried ----------------------------------------------------------------------------------------------------


def test_another_background_is_read_off_the_picture():
    got = estimated(CASE, "background-missing", (0.5, 0.25, 0.75), "another radiance")
    assert got == [pytest.approx((0.5, 0.25, 0.75))]
    assert not RULES["background-missing"].estimates(
        Applied("background-missing", None, "another radiance"), evidence_of(CASE, with_cause(CASE, "recursion-cut", 0))
    ), "rays that miss agree"


def test_beyond_the_cut_the_background_may_show():
    shown = {n: seen(between_mirrors(), "recursion-cut", n, "then background") for n in (3, 12)}
    assert shown[3] == sum(0.5**n for n in range(4)), "it is black"
    bright = scene(plane([0, 0, 0], [0, 0, 1], "m"), plane([0, 0, 4], [0, 0, -1], "m"), eye=[0, 0, 2], target=[0.3, 0, 0],
                   materials={"m": {"emission": 1.0, "reflection": 0.5}}, background=8.0, recursion_limit=12)  # fmt: skip
    assert seen(case_of(bright), "recursion-cut", 3, "then background") == sum(0.5**n for n in range(4)) + 8 * 0.5**4
    assert (12, "then background") in tried(case_of(bright), "recursion-cut")


def test_glass_through_which_no_ray_is_followed_casts_its_shadow_all_the_same():
    case = by_hand(floor={"reflection": 0}, mirror={"reflection": 0})  # nothing shows the glass, which mirrors all the same
    got, glass = with_cause(case, "refraction-missing", None, "not followed"), directly_seen(case, 1)
    assert_same(got[~glass], picture(case)[~glass])
    assert_same(got[glass], (picture(case) - Tracer(case).render(["transmitted"])["transmitted"])[glass])
    assert "not followed" in {reading for _, reading in tried(CASE, "refraction-missing")}
    assert "not followed" not in {reading for _, reading in tried(by_hand(transparent_shadows="ignore"), "refraction-missing")}, (
        "that is k_trans = 0"
    )


@pytest.mark.parametrize("shadows", ["attenuate", "ignore"])
@pytest.mark.parametrize(("reading", "own"), [("opaque, shadows kept", 1.0), ("opaque, 1 − t of its own, shadows kept", 0.4)])
def test_glass_that_is_opaque_to_the_eye_alone_casts_its_own_shadow(reading, own, shadows):
    dull = {name: {"reflection": 0} for name in ("glass", "mirror", "floor")}
    case = by_hand(**dull, transparent_shadows=shadows)
    got, glass = with_cause(case, "refraction-missing", None, reading), directly_seen(case, 1)
    assert_same(got[~glass], picture(case)[~glass])
    # Of the ball itself L_1 is left; no light is in front of it that something stands before.
    seen_terms = Tracer(case).render(["diffuse", "specular", "normal", "position"])
    toward = [np.array([1.5, 3, 2]) - np.nan_to_num(seen_terms["position"]), np.broadcast_to([-1, 0.8, 0.6], got.shape)]
    front = sum(
        np.where(((seen_terms["normal"] * to_light).sum(axis=-1) > 0)[..., None], seen_terms[name][:, :, k], 0)
        for k, to_light in enumerate(toward)
        for name in ("diffuse", "specular")
    )
    assert_same(got[glass], front[glass] / 0.4 * own)


@pytest.mark.parametrize(
    ("cause", "everywhere", "reading"),
    [("refraction-missing", "not bent", "not bent, view rays"), ("index-inverted", "", "view rays")],
)
def test_the_highlight_of_light_from_behind_keeps_its_bend_where_view_rays_alone_are_wrong(cause, everywhere, reading):
    """A pane between lamp and eye: its own terms are the model's, and what is seen through it is not."""
    pane = {"specular": 1, "exponent": 4, "transparency": 0.5, "transmission": 0.8, "ior": 1.4}
    ground = {"kind": "plane", "point": [0, -2, 0], "normal": [0, 1, 0.3], "material": "wall"}
    case = case_of(
        scene(plane([0, 0, 0], [0, 0, 1], "pane"), ground, materials={"pane": pane, "wall": {"diffuse": 1.0}},
              lights=[lamp([1, 2, -3], 30.0)], eye=[0.4, 0.2, 4], target=[0, 0, 0])
    )  # fmt: skip
    black = {name: (m.model_copy(update={"transmission": (0, 0, 0)})) for name, m in case.scene.materials.items()}
    own = case.__class__(case.name, case.scene.model_copy(update={"materials": black}), case.scene_name)
    assert_same(with_cause(own, cause, None, reading), picture(own))
    assert seen(own, cause, None, everywhere) != seen(own, cause, None, reading), "T is bent otherwise"
    through, right = (
        seen(case, cause, None, reading) - seen(own, cause, None, reading),
        picture(case)[0, 0, 0] - picture(own)[0, 0, 0],
    )
    assert abs(through - right) > 1e-6, "and so is what is seen"
    assert (None, reading) in tried(case, cause)
    assert (None, reading) not in tried(by_hand(glass={"specular": 0}), cause), "without a highlight it is the plain reading"


def test_every_smaller_recursion_limit_is_tried_and_those_just_beyond():
    others = [(6, "beyond the limit"), (7, "beyond the limit"), (4, "then background"), (5, "then background")]
    assert tried(CASE, "recursion-cut") == [*((n, "") for n in range(5)), *others]
    deep = [n for n, reading in tried(by_hand(recursion_limit=200), "recursion-cut") if not reading]
    assert {0, 5, 99, 100, 128, 198, 199} - set(deep) == {99}
    assert len(deep) < 30


LOCAL = changed(SPEC, materials={name: {"diffuse": 0.5} for name in SPEC["materials"]})


@pytest.mark.parametrize(
    ("case", "causes"),
    [
        (case_of(LOCAL), ["transparent-shadow-rule", "reflection-missing", "refraction-missing", "recursion-cut",
                          "weight-cut", "index-inverted", "tir-weight", "nested-media", "transmission-uncounted",
                          "transparency-weight-ignored"]),
        (case_of(changed(LOCAL, lights={})), ["occlusion-ignored", "shadow-bias"]),
        (by_hand(glass={"ior": 1}), ["index-inverted", "tir-weight", "nested-media"]),
        (by_hand(recursion_limit=0), ["reflection-missing", "recursion-cut", "weight-cut", "tir-weight"]),
    ],
)  # fmt: skip
def test_what_cannot_change_the_picture_is_not_tried(case, causes):
    assert {cause: tried(case, cause) for cause in causes} == {cause: [] for cause in causes}


def test_v_of_the_camera_s_own_rays_is_tried_apart_where_it_is_wrong_and_others_differ():
    own = (None, "camera rays only")
    parallel = by_hand(camera={"projection": "orthographic", "eye": [0.4, 1.2, 3], "target": [0, 0, 0], "height_m": 2})
    assert own in tried(CASE, "view-vector-fixed")
    assert own not in tried(CASE, "view-vector-from-eye")
    assert own in tried(parallel, "view-vector-from-eye")
    assert own not in tried(parallel, "view-vector-fixed")
    first = with_cause(parallel, "view-vector-from-eye", None, "camera rays only")
    assert np.abs(first - with_cause(parallel, "view-vector-from-eye")).max() > 1e-6, "mirrors show it"
    assert np.abs(first - picture(parallel)).max() > 1e-6


def test_a_black_background_is_not_missed():
    readings = {reading for _, reading in tried(by_hand(background=0, ambient=0), "background-missing")}
    assert readings == {"another radiance"}
