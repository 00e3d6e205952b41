"""The tracer and the oracle where one quantity is pushed to its end, against evaluation at 150 digits.

Within the promised ranges both are right to 1e-9 of the value of every band of every pixel, and to what they state themselves.
Beyond, where double-double or double must give up, they say so: the stated bound still covers the error (infinite, if need be),
or the scene is refused in words.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest
from mpmath import mp, mpf

import equilux_oracle
from equilux_oracle.precise import evaluate_at
from equilux_scenes.case import Case
from equilux_scenes.errors import SpecErrors
from equilux_scenes.loader import load_scene_text
from equilux_tracer import Tracer, TracerError
from support import extreme_scenes as extreme
from support.random_scenes import case_of

PROMISED = 1e-9
DIGITS = 150
POSITIONS = 4

Axis = Callable[[float], extreme.Look]

DECADES_OF_SCALE = (-15, -10, -5, 0, 5, 10, 15)
WITHIN: dict[str, tuple[Axis, tuple[float, ...]]] = {
    # The issue's own ranges.
    "scale": (extreme.scale, DECADES_OF_SCALE),
    "scale, intensities kept": (extreme.scale_alone, (-15, -7, 7, 15)),
    "scale, raytraced": (extreme.scale_raytraced, (-15, -5, 5, 15)),
    "scale, opengl": (extreme.scale_opengl, (-15, 0, 15)),
    "scale by transforms": (extreme.transformed, (-15, 15)),
    "offset": (extreme.offset, (0, 2, 4, 6, 7, 8)),
    "offset, raytraced": (extreme.offset_raytraced, (0, 4, 7, 8)),
    "offset, opengl": (extreme.offset_opengl, (4, 8)),
    "offset, one surface twice": (extreme.coincident, (0, 2, 4, 6, 8)),
    "radiance": (extreme.radiance, (-30, -20, -10, 0, 10, 20, 30)),
    "radiance, raytraced": (extreme.radiance_raytraced, (-30, 30)),
    "exponent": (extreme.exponent, (-1, 0, 1, 2, 3, 4, 5, 6, 7, 8)),
    # The axes of `equilux extremes`.
    "exponent below 1": (extreme.exponent_below_one, (-1, -4, -16)),
    "light distance": (extreme.light_distance, (-12, -8, -4, 0, 5, 10, 20)),
    "light distance, intensity kept": (extreme.light_distance_alone, (-12, -6, 0, 10, 20)),
    "light distance, a blocker on the way": (extreme.light_distance_raytraced, (-12, -6, -1, 0, 1, 10, 20)),
    "grazing sun": (extreme.grazing_light, (0, -1, -2, -3, -6, -9, -12)),
    "grazing lamp": (extreme.grazing_lamp, (0, -3, -6, -12)),
    "grazing view": (extreme.grazing_view, (0, -3, -6, -9, -12)),
    "grazing view of a mirror": (extreme.grazing_view_raytraced, (0, -6, -12)),
    "field of view": (extreme.field_of_view, (1e-4, 1e-2, 1, 90, 170, 179.9, 179.99)),
    "gap": (extreme.gap, (0, -3, -6, -9, -12, -14)),
    "gap of a ball": (extreme.gap_of_ball, (-1, -6, -12, -14)),
    "triangle size": (extreme.triangle_size, (-15, -8, 0, 8, 15)),
    "triangle slenderness": (extreme.triangle_slenderness, (0, -4, -8, -12)),
    "ball size": (extreme.ball_size, (-15, -8, 0, 8, 15)),
    "film height": (extreme.film_height, (-12, 0, 9)),
    "eye distance": (extreme.eye_distance, (2, 6, 10, 12)),
    "lights": (extreme.lights, (1, 1000)),
    "recursion": (extreme.recursion, (1, 20, 200)),
    "index above 1": (extreme.index_above_one, (-1, -8, -15)),
    "index below 1": (extreme.index_below_one, (-1, -8, -15)),
    "index": (extreme.index, (-8, -4, 4, 8)),
    "below the critical angle": (extreme.below_critical, (-2, -8, -15)),
    "above the critical angle": (extreme.above_critical, (-2, -8, -15)),
    "film aspect": (extreme.film_aspect, (-4, 4)),
    "spot cone": (extreme.spot_cone, (-6, -3, 0, 1, 2)),
    "attenuation": (extreme.attenuation, (-12, -6, 6, 12)),
    "coefficients": (extreme.coefficient, (-30, 30)),
    "pane": (extreme.slab, (0, -6, -12, -13)),
}

BEYOND: dict[str, tuple[Axis, tuple[float, ...]]] = {
    "scale": (extreme.scale_raytraced, (-300, -150, -70, -59, 59, 70, 150)),
    "scale, phong": (extreme.scale_alone, (-150, 70, 150)),
    "offset": (extreme.offset, (12, 14, 15, 16, 18, 30)),
    "offset, raytraced": (extreme.offset_raytraced, (12, 14, 15, 16)),
    "radiance": (extreme.radiance, (-322, -315, -308, -300, 300, 306, 307)),
    "radiance, raytraced": (extreme.radiance_raytraced, (-320, 307)),
    "exponent": (extreme.exponent, (10, 12, 15)),
    "eye distance": (extreme.eye_distance, (14, 15, 16, 18)),
    "ball size": (extreme.ball_size, (17, 18, 20, 25)),
    "gap": (extreme.gap, (-15, -16, -18)),
    "gap of a ball": (extreme.gap_of_ball, (-15, -16)),
    "pane": (extreme.slab, (-14, -15, -16, -30)),
    "film height": (extreme.film_height, (12, 15)),
    "index": (extreme.index, (-100, -20, 12, 20, 30, 100, 300)),
    "spot cone": (extreme.spot_cone, (-8, -10, -14)),
    "attenuation": (extreme.attenuation, (-300, -100, 100, 300)),
    "grazing sun": (extreme.grazing_light, (-14, -16)),
}


@dataclass(frozen=True)
class Found:
    """What one of the two says: radiance and its bound (n, 3), objects (n,)."""

    who: str
    radiance: npt.NDArray[np.float64]
    bound: npt.NDArray[np.float64]
    object_id: npt.NDArray[np.int64]


Evaluation = Callable[[Case, npt.NDArray[np.float64]], Found]


def loaded(spec: extreme.Spec) -> Case:
    """Through the loader, so that a limit of the spec itself would show; thousands of lights past it, which saves seconds."""
    return case_of(spec) if len(spec["lights"]) > 200 else load_scene_text(json.dumps(spec)).cases[0]


def by_tracer(case: Case, film_xy: npt.NDArray[np.float64]) -> Found:
    got = Tracer(case).evaluate(film_xy, ["radiance", "rounding", "object_id"], threads=1)
    return Found("tracer", got["radiance"], got["rounding"], got["object_id"])


def by_oracle(case: Case, film_xy: npt.NDArray[np.float64]) -> Found:
    found = equilux_oracle.examine(case, film_xy)
    return Found("oracle", found.radiance, found.bound, found.object_id)


def found_or_refused(evaluate: Evaluation, case: Case, film_xy: npt.NDArray[np.float64]) -> tuple[Found | None, str]:
    try:
        return evaluate(case, film_xy), ""
    except (TracerError, ValueError) as refusal:
        return None, str(refusal)


def each_case(look: extreme.Look):
    """The scene with all its objects for the tracer; and without meshes, of which the oracle has no closed form, for both."""
    film_xy = np.array(look.film_xy[:: max(1, len(look.film_xy) // POSITIONS)])
    yield loaded(look.spec), film_xy, (by_tracer,)
    rest = extreme.without_mesh(look.spec)
    if rest["objects"]:
        yield loaded(rest), film_xy, (by_oracle,)


def worst_of(found: Found, case: Case, film_xy: npt.NDArray[np.float64]) -> tuple[float, list[str]]:
    """The largest error relative to a band's value, and complaints of what is not covered by the stated bound."""
    worst, complaints = 0.0, []
    for k, (x, y) in enumerate(film_xy):
        true = evaluate_at(case, float(x), float(y), DIGITS)
        index = -1 if true.seen is None else true.seen.index
        vouched = bool(np.isfinite(found.bound[k]).all())
        if vouched and found.object_id[k] != index:
            complaints.append(f"{found.who} at ({x:g}, {y:g}) sees object {found.object_id[k]}, 150 digits see {index}")
            continue
        for band in range(3):
            got, bound, value = float(found.radiance[k, band]), float(found.bound[k, band]), true.radiance[band]
            error = abs(mpf(got) - value) if math.isfinite(got) else mp.inf
            if math.isnan(got) or math.isnan(bound) or error > bound:
                complaints.append(
                    f"{found.who} at ({x:g}, {y:g}), band {band}: {got!r} against {mp.nstr(value, 17)}, off {mp.nstr(error, 3)}, "
                    f"stated {bound:.3g}"
                )
            if error > 0:
                worst = max(worst, float(error / value) if value > 0 else math.inf)
    return worst, complaints


def steps(axes: dict[str, tuple[Axis, tuple[float, ...]]]):
    return [pytest.param(make, value, id=f"{name} {value:g}") for name, (make, values) in axes.items() for value in values]


@pytest.mark.parametrize(("make", "value"), steps(WITHIN))
def test_within_the_promised_ranges_both_are_right_to_a_billionth(make, value):
    for case, film_xy, evaluations in each_case(make(value)):
        for evaluate in evaluations:
            found = evaluate(case, film_xy)
            assert np.isfinite(found.bound).all(), f"{found.who} vouches for no digit: {found.bound}"
            with mp.workdps(DIGITS):
                worst, complaints = worst_of(found, case, film_xy)
            assert not complaints, "\n".join(complaints)
            assert worst <= PROMISED, f"{found.who}: off by {worst:.3g} of a band's value, promised {PROMISED:g}"
            print(f"\n{found.who}: off by {worst:.2g} of a band's value")


@pytest.mark.parametrize(("make", "value"), steps(BEYOND))
def test_beyond_them_whoever_gives_up_says_so(make, value):
    try:
        cases = list(each_case(make(value)))
    except SpecErrors as refusal:  # its numbers have become one
        print(f"\nrefused: {refusal}")
        return
    for case, film_xy, evaluations in cases:
        for evaluate in evaluations:
            found, refusal = found_or_refused(evaluate, case, film_xy)
            if found is None:
                assert len(refusal.split()) >= 5, f"refused without a reason: {refusal!r}"
                print(f"\nrefused: {refusal}")
                continue
            with mp.workdps(DIGITS):
                worst, complaints = worst_of(found, case, film_xy)
            assert not complaints, "\n".join(complaints)
            print(f"\n{found.who}: off by {worst:.2g} of a band's value, stated up to {found.bound.max():.2g}")


def test_no_film_position_is_too_far_off():
    # x of the ray overflows float, in which Embree traverses.
    spec = {**extreme.everything(), "model": "phong"}
    spec["camera"] = {**spec["camera"], "fov_y_deg": 179.99}
    found = Tracer(loaded(spec)).evaluate([[1e29, 3.0], [-1e29, 1e29]], ["radiance", "object_id"])
    assert np.isfinite(found["radiance"]).all(), found["radiance"]


def test_a_thousand_decades_of_light_never_become_nan():
    spec = extreme.everything()
    for light in spec["lights"].values():
        light["irradiance" if "irradiance" in light else "intensity"] = 1.7e308
    spec["materials"]["matt"]["specular"] = [0.0, 0.4, 7.0]
    film_xy = np.array(extreme.grid())
    found = Tracer(loaded(spec)).evaluate(film_xy, ["radiance", "rounding"])
    assert not np.isnan(found["radiance"]).any(), found["radiance"]
    overflown = np.isinf(found["radiance"])
    assert overflown.any(), f"the largest radiance is {found['radiance'].max():g}"
    assert np.isinf(found["rounding"][overflown]).all(), found["rounding"][overflown]
