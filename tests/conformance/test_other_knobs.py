"""Every step of OpenGL's and of Mitsuba's knobs: the error is within the budget at every pixel off edges, and comes near it."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_adapters.opengl.knobs import OpenGLKnobs
from equilux_tracer import Tracer
from support import mitsuba, opengl
from support.mitsuba import case_of_text
from support.within import complaint

LOCAL = """
equilux: 1
name: ball-and-floor
model: opengl
camera: {projection: perspective, eye: [0.1, 0.4, 3], target: [0, 0, 0], fov_y_deg: 40}
film: {width: 64, height: 48}
background: 0.1
lights: {key: {kind: point, position: [0.5, 2, 3], intensity: 7.5}}
materials:
  clay: {diffuse: [0.6, 0.4, 0.2], specular: 0.5, exponent: 20, emission: 0.01}
  floor: {diffuse: [0.2, 0.3, 0.4]}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}
  - {kind: plane, point: [0, -0.5, 0], normal: [0, 1, 0], material: floor}
"""
SOFT = """
equilux: 1
name: soft-shadow
model: reflection-equation
camera: {projection: perspective, eye: [0, 1.2, 3], target: [0, 0, 0], fov_y_deg: 40}
film: {width: 32, height: 24}
lights: {panel: {kind: disc, center: [0.3, 1.5, 0], normal: [0, -1, 0], radius: 0.5, radiance: 2}}
materials: {chalk: {brdf: lambert, diffuse: 0.25}}
objects:
  - {kind: plane, point: [0, 0, 0], normal: [0, 1, 0], material: chalk}
  - {kind: sphere, center: [0, 0.4, 0], radius: 0.3, material: chalk}
"""
COARSE = {"triangle_px": 16}
"""With smaller triangles than facets the division of round shapes would not show."""


def steps(model: type, knob: str) -> list:
    return model.model_fields[knob].json_schema_extra["steps"]


OF_OPENGL = [{"triangle_px": step} for step in steps(OpenGLKnobs, "triangle_px")]
OF_OPENGL += [{"tessellation": step, **COARSE} for step in steps(OpenGLKnobs, "tessellation")[:3]]


@pytest.mark.parametrize("setting", OF_OPENGL, ids=str)
def test_a_step_of_opengl_is_as_good_as_it_says_and_no_better(setting, tmp_path):
    said = complaint(opengl.run(case_of_text(LOCAL), tmp_path, **setting), setting)
    assert said is None, said


def test_smaller_triangles_are_nearer_to_the_truth(tmp_path):
    case = case_of_text(LOCAL)
    truth = Tracer(case).render()["radiance"]
    errors = [float(np.median(np.abs(opengl.run(case, tmp_path, triangle_px=px).image - truth))) for px in (16.0, 4.0, 1.0)]
    assert errors[0] > errors[1] > errors[2], errors


@pytest.mark.parametrize("samples", steps(MitsubaKnobs, "samples"))
def test_the_noise_of_any_number_of_samples_is_stated(samples, tmp_path):
    said = complaint(mitsuba.run(case_of_text(SOFT), tmp_path, samples=samples), samples)
    assert said is None, said


def test_more_repeats_state_less_noise(tmp_path):
    case = case_of_text(SOFT)
    sigma = {}
    for repeats in steps(MitsubaKnobs, "repeats"):
        result = mitsuba.run(case, tmp_path / str(repeats), samples=4, repeats=repeats)
        assert complaint(result, repeats) is None
        (noise,) = [term for term in result.budget.terms if term.kind == "sampled"]
        sigma[repeats] = float(np.sqrt(np.mean(noise.sigma**2)))
    assert sigma[128] == pytest.approx(sigma[32] / 2, rel=0.2), sigma
