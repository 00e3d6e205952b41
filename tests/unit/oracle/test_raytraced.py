"""Model `raytraced`: against fifty digits, against a plain evaluation, and the laws that hold whatever the scene."""

from __future__ import annotations

import random

import numpy as np
import pytest
from mpmath import mp, mpf

import equilux_oracle
from equilux_oracle.affordable import CROSSINGS
from equilux_oracle.precise import evaluate_at
from support import plain_raytraced
from support.random_raytraced import random_raytraced
from support.random_scenes import ANALYTIC, case_of, changed, random_spec

TRACERS_BOUND = 1e-12
SHARE = 0.1
"""What the oracle may use up of a bound relative to the scale."""

CLOSED = ("sphere", "box", "plane")


def anywhere(seed, *, limit=5, exponents=(1.0, 200.0), **options):
    """Any shapes, transformed and overlapping, at any place, of matt, mirroring and transparent materials."""
    rng = random.Random(f"anywhere {seed}")
    spec = random_spec(seed, exponents=exponents, **{"objects": (3, 6), **options})

    def share():
        return [rng.uniform(0.3, 1.0) for _ in range(3)]

    spec["materials"]["m1"].update(reflection=share())
    spec["materials"]["m2"].update(reflection=share(), transmission=share(), transparency=rng.uniform(0.2, 1.0))
    spec["materials"]["glass"] = {**spec["materials"]["m2"], "ior": rng.choice([rng.uniform(0.5, 0.9), rng.uniform(1.2, 2.5)])}
    for shape in spec["objects"]:
        if (shape["kind"] in CLOSED or shape.get("capped")) and rng.random() < 0.6:
            shape["material"] = "glass"
    rule = rng.choice(["attenuate", "ignore"])
    return {**spec, "model": "raytraced", "recursion_limit": limit, "transparent_shadows": rule}


GROUPS = {
    "disjoint": (random_raytraced, {}),
    "disjoint, deep": (random_raytraced, {"recursion": (6, 8)}),
    "cylinders": (random_raytraced, {"shapes": ("cylinder", "sphere")}),
    "anything": (anywhere, {}),
    "a million metres from the origin": (anywhere, {"offset": (1e6, -1e6, 1e6)}),
    "narrow and far": (anywhere, {"fov_deg": (1.0, 1.0), "offset": (-1e6, 1e6, 1e6)}),
    "orthographic": (anywhere, {"fov_deg": None}),
    "soft highlights": (anywhere, {"exponents": (0.1, 0.9)}),
    "sharp highlights": (anywhere, {"exponents": (300.0, 1000.0)}),
    **{f"only {shape}": (anywhere, {"shapes": (shape,), "objects": (6, 6), "limit": 3}) for shape in ANALYTIC},
}


@pytest.mark.parametrize("group", GROUPS)
def test_the_oracle_agrees_with_fifty_digits(group):
    make, options = GROUPS[group]
    of_scale, of_bound, hits = 0.0, 0.0, 0
    for seed in range(4):
        case, rng = case_of(make(seed, **options)), random.Random(seed)
        film = case.scene.film
        positions = [(rng.uniform(0, film.width), rng.uniform(0, film.height)) for _ in range(5)]
        found = equilux_oracle.examine(case, positions)
        for k, (x, y) in enumerate(positions):
            true = evaluate_at(case, x, y)
            where = f"{case.name} at ({x}, {y})"
            assert found.object_id[k] == (-1 if true.seen is None else true.seen.index), where
            if true.scale is None:
                assert found.radiance[k].tolist() == [float(band) for band in true.radiance], where
                continue
            hits += 1
            with mp.workdps(50):
                for band in range(3):
                    error, bound = abs(mpf(found.radiance[k, band]) - true.radiance[band]), found.bound[k, band]
                    assert error <= bound, f"{where}: {found.radiance[k, band]!r}, off by {mp.nstr(error, 3)}, bound {bound}"
                    if error > 0:
                        of_scale = max(of_scale, float(error / (true.scale[band] * TRACERS_BOUND)))
                        of_bound = max(of_bound, float(error / bound))
                    off = abs(mpf(found.scale[k, band]) - true.scale[band])
                    assert off <= TRACERS_BOUND * true.scale[band], f"{where}: scale {found.scale[k, band]!r}, off by {off}"
    print(f"\n{group}: worst error ÷ (1e-12 scale) {of_scale:.2g}, ÷ own bound {of_bound:.2g}, over {hits} positions")
    assert hits >= 5, f"only {hits} positions hit anything"
    assert of_scale <= SHARE, f"{group}: error is {of_scale} of 1e-12 of the scale, allowed {SHARE}"


@pytest.mark.parametrize("make", [random_raytraced, anywhere])
def test_the_oracle_agrees_with_a_plain_evaluation_off_edges(make):
    worst, edges, pixels = 0.0, 0, 0
    for seed in range(100, 115):
        case = case_of(make(seed, film=(12, 9)))
        positions = equilux_oracle.pixel_centers(case.scene.film)
        plain, _ = plain_raytraced.radiance(case, positions)
        found = equilux_oracle.evaluate(case, positions)
        off = np.max(np.abs(plain - found) / (1 + np.abs(found)), axis=1)
        doubtful = np.flatnonzero(off > 1e-8)
        on_edge = plain_raytraced.on_edge(case, positions[doubtful], 1e-5) if len(doubtful) else np.zeros(0, dtype=bool)
        for k in doubtful[~on_edge]:
            pytest.fail(f"{case.name} at {positions[k]}: oracle {found[k].tolist()}, plain evaluation {plain[k].tolist()}")
        worst = max(worst, float(np.max(off[off <= 1e-8])))
        edges, pixels = edges + int(on_edge.sum()), pixels + len(positions)
    print(f"\n{make.__name__}: worst {worst:.2g} of 1 + L over {pixels} pixels, {edges} of them edges")
    assert edges <= pixels // 100, f"{edges} of {pixels} pixels are called edges"


# --- laws -------------------------------------------------------------------------------------------------------------


def pictures(*specs):
    """Radiance and bounds of several specs."""
    found = [equilux_oracle.radiance_with_bound(case_of(spec)) for spec in specs]
    return [radiance for radiance, _ in found], [bound for _, bound in found]


def assert_equal(a, b, allowed, what):
    worst = np.unravel_index(np.argmax(np.abs(a - b) - allowed), a.shape)
    assert np.all(np.abs(a - b) <= allowed), f"{what}: at {worst} {a[worst]!r} against {b[worst]!r}, allowed {allowed[worst]:.3g}"


def brighter(spec, factor):
    """All sources of radiance times a power of two."""
    spec = changed(spec)
    for term in ("ambient", "background"):
        spec[term] = [factor * c for c in spec[term]]
    for light in spec["lights"].values():
        key = "irradiance" if light["kind"] == "directional" else "intensity"
        light[key] = [factor * c for c in light[key]]
    for material in spec["materials"].values():
        material["emission"] = [factor * c for c in material["emission"]]
    return spec


@pytest.mark.parametrize("seed", range(4))
def test_doubling_all_sources_doubles_radiance_to_the_last_bit(seed):
    spec = random_raytraced(seed)
    (once, twice), _ = pictures(spec, brighter(spec, 2.0))
    assert np.array_equal(2.0 * once, twice), f"largest difference {np.abs(2 * once - twice).max()}"


@pytest.mark.parametrize("seed", range(4))
def test_radiance_never_falls_with_the_recursion_limit(seed):
    pictures_by_limit, bounds = pictures(*({**random_raytraced(seed), "recursion_limit": limit} for limit in range(7)))
    for limit in range(6):
        fewer, more = pictures_by_limit[limit], pictures_by_limit[limit + 1]
        allowed = bounds[limit] + bounds[limit + 1]
        assert np.all(more >= fewer - allowed), f"from limit {limit} to {limit + 1} by up to {(fewer - more).max()}"
    assert pictures_by_limit[6].mean() > pictures_by_limit[0].mean(), "the limit has no effect at all"


@pytest.mark.parametrize("seed", range(4))
def test_ignored_shadows_are_never_darker_than_attenuated_ones(seed):
    spec = random_raytraced(seed)
    (attenuated, ignored), (a, b) = pictures(
        {**spec, "transparent_shadows": "attenuate"}, {**spec, "transparent_shadows": "ignore"}
    )
    assert np.all(ignored >= attenuated - a - b), f"by up to {(attenuated - ignored).max()}"


def mirrored_across_x(spec):
    """The same scene with every x turned about: positions, directions and, as a first step, all shapes."""
    spec = changed(spec)
    camera = spec["camera"]
    for part, keys in [
        (camera, ("eye", "target", "up")),
        *((light, ("position", "direction")) for light in spec["lights"].values()),
    ]:
        for key in keys:
            if key in part:
                part[key] = [-part[key][0], *part[key][1:]]
    for shape in spec["objects"]:
        shape["transform"] = [*shape.get("transform", []), {"scale": [-1, 1, 1]}]
    return spec


@pytest.mark.parametrize("seed", range(4))
def test_the_mirrored_scene_has_the_mirrored_picture(seed):
    spec = {**random_raytraced(seed), "film": {"width": 24, "height": 18}}
    spec["camera"]["up"] = [0, 1, 0]
    (there, back), (a, b) = pictures(spec, mirrored_across_x(spec))
    assert_equal(there, back[:, ::-1], a + b[:, ::-1], "mirrored in x")


@pytest.mark.parametrize("seed", range(4))
def test_where_nothing_is_transparent_mirroring_or_in_the_way_it_is_the_local_model(seed):
    spec = random_spec(seed, shapes=("sphere",), objects=(1, 1), fov_deg=(30, 60))
    (ray_traced, local), (a, b) = pictures({**spec, "model": "raytraced"}, spec)
    assert_equal(ray_traced, local, a + b, "one ball")


@pytest.mark.parametrize("limit", [0, 1, 4, 12])
def test_weights_that_sum_to_one_keep_a_uniform_world_uniform(limit):
    # k_refl = k_trans = 1 and nothing else: (1 − t) + t = 1 at every surface, total reflection included. What is lacking is
    # the weight of the rays beyond the limit.
    spec = random_raytraced(3, plane=False, recursion=(limit, limit))
    glass = {"reflection": 1, "transmission": 1, "transparency": 0.75, "ior": 1.5}
    spec["materials"] = {name: {"reflection": 1} if name == "mirror" else dict(glass, ior=1.5) for name in spec["materials"]}
    for shape in spec["objects"]:
        shape["material"] = "glass" if shape["kind"] in CLOSED else "mirror"
    (picture,), (bound,) = pictures({**spec, "background": 1, "ambient": 0})
    assert np.all(picture <= 1 + bound), f"{picture.max()} in a world of radiance 1"
    lacking = 1 - picture
    least = {0: 1.0, 1: 1.0, 4: 0.5, 12: 0.02}[limit]
    assert lacking.max() <= least, f"limit {limit}: up to {lacking.max()} of the weight is beyond the limit"
    assert np.mean(lacking) <= {0: 1.0, 1: 0.5, 4: 0.1, 12: 0.001}[limit], f"limit {limit}: on average {np.mean(lacking)}"


# --- rules ------------------------------------------------------------------------------------------------------------

PANE = {"kind": "rectangle", "corner": [-1, -1, 1], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0], "material": "pane"}
FLOOR = {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"}
SUN = {"kind": "directional", "direction": [0, 0, -1], "irradiance": [4, 2, 1]}


def seen(make_case, materials, objects, *lights, **scene):
    """Radiance straight down the axis of a view from above."""
    case = make_case({}, {}, *lights, model="raytraced", materials=materials, objects=objects, **scene)
    return equilux_oracle.evaluate(case, [[4.25, 4.25]])[0].tolist()


def test_each_crossing_of_a_transparent_object_weakens_the_light_once_per_band(make_case):
    pane, floor = {"transparency": 0.5, "transmission": [1, 0.5, 0]}, {"diffuse": 1}
    # Seen through the pane (weight t k), lit through the pane (t k again): 4 · (½)², 2 · (¼)², 0.
    assert seen(make_case, {"pane": pane, "floor": floor}, [FLOOR, PANE], SUN) == [1, 0.125, 0]
    assert seen(make_case, {"pane": pane, "floor": floor}, [FLOOR, PANE], SUN, transparent_shadows="ignore") == [2, 0.5, 0]


def test_an_opaque_pane_shows_itself_and_casts_a_full_shadow(make_case):
    materials = {"pane": {"diffuse": 0.25, "transmission": 1}, "floor": {"diffuse": 1}}
    assert seen(make_case, materials, [FLOOR, PANE], SUN) == [1, 0.5, 0.25]
    below = {"kind": "point", "position": [0.25, -0.25, 0.5], "intensity": 1}
    assert seen(make_case, materials, [FLOOR, PANE], below) == [0, 0, 0], "lit from behind, but t = 0"


def test_light_from_behind_counts_with_t_and_from_the_front_with_the_rest(make_case):
    paper = {"pane": {"diffuse": 0.5, "transparency": 0.25, "transmission": 1}}
    assert seen(make_case, paper, [PANE], SUN) == [4 * 0.75 * 0.5, 2 * 0.75 * 0.5, 0.75 * 0.5]
    assert seen(make_case, paper, [PANE], {**SUN, "direction": [0, 0, 1]}) == [4 * 0.25 * 0.5, 2 * 0.25 * 0.5, 0.25 * 0.5]


def test_the_highlight_of_light_from_behind_is_about_the_refracted_direction(make_case):
    # Without bending T = d: from below against the view, T·V = 1, and at 60° from it ½.
    pane = {"pane": {"specular": 1, "exponent": 3, "transparency": 0.5, "transmission": 1}}
    assert seen(make_case, pane, [PANE], {**SUN, "direction": [0, 0, 1]}) == [2, 1, 0.5]
    slanted = seen(make_case, pane, [PANE], {**SUN, "direction": [3**0.5, 0, 1]})
    assert np.allclose(slanted, [2 / 8, 1 / 8, 0.5 / 8], rtol=1e-15), slanted
    # Into water from above, seen from below: the light at 60° goes on at asin(sin 60° / n), nearer to the axis.
    below = {"projection": "orthographic", "eye": [0, 0, -5], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 8}
    water = {"water": {"specular": 1, "exponent": 3, "transparency": 0.5, "transmission": 1, "ior": 2}}
    sea = [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "water"}]
    bent = seen(make_case, water, sea, {**SUN, "direction": [3**0.5, 0, -1]}, camera=below)
    cosine = (1 - 3 / 16) ** 0.5
    assert np.allclose(bent, [2 * cosine**3, cosine**3, 0.5 * cosine**3], rtol=1e-14), f"{bent}, expected cos³ = {cosine**3}"


def test_light_beyond_the_critical_angle_leaves_no_highlight(make_case):
    above = [{"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "water"}]
    water = {"water": {"specular": 1, "exponent": 0, "transparency": 0.5, "transmission": 1, "ior": 2}}
    within = {**SUN, "direction": [0.5, 0, 1]}  # from the water, at 26.6°: sin = 0.447, twice that is below 1
    beyond = {**SUN, "direction": [1, 0, 1]}
    assert seen(make_case, water, above, within) == [2, 1, 0.5]
    assert seen(make_case, water, above, beyond) == [0, 0, 0]


def test_a_tube_stands_in_its_own_light(make_case):
    tube = {"kind": "cylinder", "base": [0, 0, 0], "top": [4, 0, 0], "radius": 1, "capped": False, "material": "tube"}
    materials = {"tube": {"diffuse": 1}}
    side = {"projection": "orthographic", "eye": [0.5, 0, 0], "target": [2, 0, -0.5], "up": [0, 0, 1], "height_m": 0.5}
    lamp = {"kind": "directional", "direction": [0, 0, -1], "irradiance": 1}
    case = make_case({}, {}, lamp, model="raytraced", materials=materials, objects=[tube], camera=side)
    inside = equilux_oracle.evaluate(case, [[4, 4]])[0]
    assert inside.tolist() == [0, 0, 0], "the inner wall is lit through the outer one"
    (local,) = equilux_oracle.evaluate(
        make_case(tube, materials["tube"], lamp, materials=materials, objects=[tube], camera=side), [[4, 4]]
    )
    assert local[0] > 0, "without occlusion it would be lit"


def test_a_lamp_beyond_the_blocker_is_blocked_and_one_before_it_is_not(make_case):
    materials = {"pane": {"emission": 0}, "floor": {"diffuse": 1}}
    pane = {**PANE, "corner": [-1, -1, 3]}
    from_aside = {"projection": "orthographic", "eye": [0, -4, 2], "target": [0, 0, 0], "up": [0, 0, 1], "height_m": 1}
    for height, lit in ((2.5, True), (3.5, False)):
        lamp = {"kind": "point", "position": [0, 0, height], "intensity": 1}
        case = make_case({}, {}, lamp, model="raytraced", materials=materials, objects=[FLOOR, pane], camera=from_aside)
        value = equilux_oracle.evaluate(case, [[4, 4]])[0, 0]
        assert (value > 0) == lit, f"lamp at {height} m, pane at 3 m: {value}"


# --- what it costs ----------------------------------------------------------------------------------------------------


def maze(limit):
    """Surfaces that all mirror and let through, closed in by others: rays double at each of them."""
    material = {"reflection": 0.9, "transmission": 0.9, "transparency": 0.5}
    panes = [{**PANE, "corner": [-9, -9, z], "edge_u": [18, 0, 0], "edge_v": [0, 18, 0]} for z in (-2, -1, 0, 1)]
    walls = [{"kind": "sphere", "center": [0, 0, 0], "radius": 9, "material": "pane"}]
    view = {"projection": "perspective", "eye": [0, 0, 0.5], "target": [0.3, 0.2, 0], "fov_y_deg": 60}
    return {
        "equilux": 1,
        "name": "maze",
        "model": "raytraced",
        "camera": view,
        "film": {"width": 32, "height": 24},
        "materials": {"pane": material},
        "objects": panes + walls,
        "recursion_limit": limit,
    }


def test_a_recursion_that_cannot_be_afforded_is_refused_by_name():
    case = case_of(maze(40))
    assert equilux_oracle.supports(case) == ["reflection", "transparency"]
    (reason,) = set(equilux_oracle.lacking(case).values())
    assert reason == f"recursion_limit 40 asks for more than {CROSSINGS / 5:.2g} rays"
    with pytest.raises(ValueError, match="recursion_limit 40"):
        equilux_oracle.radiance(case)


def test_a_deep_limit_that_few_rays_reach_is_no_reason_to_refuse():
    spec = random_raytraced(1)
    assert equilux_oracle.supports(case_of({**spec, "recursion_limit": 60, "materials": spec["materials"]})) == []
    assert equilux_oracle.supports(case_of(maze(6))) == []
