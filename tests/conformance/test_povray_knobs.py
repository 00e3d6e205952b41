"""Every step of POV-Ray's knobs: the error is within the budget at every pixel off edges, and comes near it."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_tracer import Tracer
from support.povray import AT_ONCE, Run, case_of_text, run, term
from support.within import complaint

BALL = """
equilux: 1
name: ball
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}
film: {width: 128, height: 96}
lights: {key: {kind: point, position: [0, 2, 3], intensity: 7.5}}
materials: {clay: {diffuse: 0.6, specular: 0.5, exponent: 20}}
objects: [{kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}]
"""
HALL = """
equilux: 1
name: hall
model: raytraced
camera: {projection: perspective, eye: [0, 0, 1], target: [0.4, 0.1, 0], fov_y_deg: 60}
film: {width: 48, height: 32}
materials: {glow: {emission: [0.1, 0.05, 0.02], reflection: [0.5, 0.25, 0.1]}}
objects:
  - {kind: plane, point: [0, 0, 0], normal: [0, 0, 1], material: glow}
  - {kind: plane, point: [0, 0, 2], normal: [0, 0, -1], material: glow}
recursion_limit: 24
"""
"""Between two mirrors of 0.5 every term of Σ 0.1 · 0.5ᵈ is known."""
BALLS = """
equilux: 1
name: balls
model: raytraced
camera: {projection: perspective, eye: [0.3, 0.4, 4], target: [0, 0, 0], fov_y_deg: 40}
film: {width: 64, height: 48}
background: [0.1, 0.15, 0.2]
lights: {key: {kind: point, position: [1, 2, 3], intensity: 6}}
materials:
  glass: {diffuse: 0.1, reflection: 0.1, transmission: [0.9, 0.8, 0.7], transparency: 0.8, ior: 1.5}
  mirror: {diffuse: [0.1, 0.2, 0.05], specular: [0.5, 0.1, 0.02], exponent: 12, reflection: [0.7, 0.3, 0.4],
           emission: [0, 0.02, 0]}
  floor: {diffuse: [0.3, 0.25, 0.2]}
objects:
  - {kind: sphere, center: [-0.6, 0, 0.3], radius: 0.6, material: glass}
  - {kind: sphere, center: [0.7, 0, 0], radius: 0.7, material: mirror}
  - {kind: plane, point: [0, -0.9, 0], normal: [0, 1, 0], material: floor}
recursion_limit: 8
"""
"""Surfaces of several layers, total reflection, rays that branch."""

STEPS = {knob: PovrayKnobs.model_fields[knob].json_schema_extra["steps"] for knob in ("max_trace_level", "adc_bailout")}


def runs(text: str, folder, settings: list[dict]) -> list[Run]:
    case = case_of_text(text)
    with ThreadPoolExecutor(AT_ONCE) as pool:
        return list(pool.map(lambda numbered: run(case, folder / str(numbered[0]), **numbered[1]), enumerate(settings)))


def complaints(text: str, folder, settings: list[dict]) -> list[str]:
    found = [complaint(result, setting) for setting, result in zip(settings, runs(text, folder, settings), strict=True)]
    return [line for line in found if line]


def largest_error(result: Run) -> float:
    return float(np.abs(result.image - Tracer(result.case).render()["radiance"]).max())


def test_every_channel_is_as_good_as_it_says_and_no_better(tmp_path):
    settings = [{"channel": "hdr"}, {"channel": "exr"}, {"channel": "png16"}, {"exposures": 1}, {"exposures": 2}]
    assert not complaints(BALL, tmp_path, settings)


@pytest.mark.parametrize(("channel", "relative"), [("exr", 2.0**-11), ("hdr", 2.0**-7)])
def test_a_float_channel_has_the_precision_of_its_format(channel, relative, tmp_path):
    result = run(case_of_text(BALL), tmp_path, channel=channel)
    truth = Tracer(result.case).render()["radiance"]
    lit = truth > 1e-3
    largest = float((np.abs(result.image - truth)[lit] / truth[lit]).max())
    assert 0.9 * relative < largest <= 1.001 * relative
    assert result.raw.data["rendered"] == 1


@pytest.mark.parametrize("brightness", [1e7, 1e-5])
def test_half_floats_hold_any_range_by_their_exposure(brightness, tmp_path):
    result = run(case_of_text(BALL.replace("intensity: 7.5", f"intensity: {brightness:g}")), tmp_path, channel="exr")
    assert complaint(result, brightness) is None
    truth = Tracer(result.case).render()["radiance"]
    bright = truth > truth.max() / 10
    assert float((np.abs(result.image - truth)[bright] / truth[bright]).max()) <= 1.001 * 2.0**-11


def test_levels_cut_as_much_as_is_stated(tmp_path):
    assert not complaints(HALL, tmp_path, [{"max_trace_level": step} for step in STEPS["max_trace_level"]])


def test_levels_never_exceed_the_scenes_own(tmp_path):
    default, deeper = runs(BALLS, tmp_path, [{}, {"max_trace_level": 200}])
    assert deeper.program.files == default.program.files


def test_a_bailout_cuts_as_much_as_is_stated(tmp_path):
    assert not complaints(HALL, tmp_path, [{"adc_bailout": step} for step in STEPS["adc_bailout"]])


def test_pov_rays_own_bailout_costs_what_is_left_of_the_series(tmp_path):
    # 0.5⁸ is the first power below 1/255: Σ_{d≥8} 0.1 · 0.5ᵈ
    result = run(case_of_text(HALL), tmp_path, adc_bailout=1 / 255)
    assert largest_error(result) == pytest.approx(0.2 * 0.5**8, rel=0.02)


@pytest.mark.parametrize("cut", [{"adc_bailout": step} for step in STEPS["adc_bailout"]] + [{"max_trace_level": 2}], ids=str)
def test_cuts_hold_with_layers_glass_and_total_reflection(cut, tmp_path):
    said = complaint(run(case_of_text(BALLS), tmp_path, **cut), cut)
    assert said is None or "nothing could trip it" in said, said


def test_a_mean_over_pixels_is_off_the_centres_by_no_more_than_is_stated(tmp_path):
    steps = [{"antialias": 2}, {"antialias": 3}, {"antialias": 3, "antialias_threshold": 0.0}, {"antialias": 3, "channel": "exr"}]
    assert not complaints(BALL, tmp_path / "steps", steps)
    plain, mean = runs(BALL, tmp_path / "two", [{}, steps[1]])
    changed = np.abs(mean.image - plain.image).max(axis=2) > 1e-3
    assert 0.005 < changed.mean() < 0.2, "silhouettes alone differ"
    assert np.all(term(mean.budget, "pixel mean").abs[changed] > 1e-3)
    assert mean.raw.seconds["centres"] > 0


def test_with_no_threshold_a_mean_is_taken_everywhere(tmp_path):
    plain, mean = runs(BALL, tmp_path, [{}, {"antialias": 2, "antialias_threshold": 0.0}])
    lit = plain.image.max(axis=2) > 0.1
    assert np.mean(mean.image[lit] != plain.image[lit]) > 0.5
