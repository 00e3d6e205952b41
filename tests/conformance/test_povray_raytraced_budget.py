"""The terms that ray tracing adds to POV-Ray's budget: each is approached to within a factor of ten by the effect it bounds."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from equilux_adapters.povray.exposures import merge
from equilux_adapters.povray.png import read_codes
from equilux_tracer import Tracer
from support.povray import Run, bound, case_of_text, run, term

WITHIN = 0.1
"""What 'approached' means: a term a factor of ten above anything it bounds would prove nothing."""


def assert_approached(name: str, share: np.ndarray | float) -> None:
    """share: the effect in units of the term, at every value."""
    largest = float(np.max(share))
    assert WITHIN <= largest <= 1.0, f"{name}: the effect reaches {largest:.3g} of what the budget states"


def traced(text: str, folder: Path, **knobs: object) -> tuple[Run, np.ndarray, Tracer]:
    result = run(case_of_text(text), folder, **knobs)
    tracer = Tracer(result.case)
    return result, np.asarray(tracer.render(["radiance"])["radiance"]), tracer


def pool(surface: str, depth: str, off_normal_deg: float, ior: float, mirrored_deg: float) -> str:
    """A narrow look through a flat surface at the flank of a very sharp highlight on the ground below it.

    The light stands where the refracted view ray mirrors to, `mirrored_deg` off the normal, plus a little.
    """
    a = math.radians(off_normal_deg)
    eye = (math.sin(a), math.cos(a))
    b = math.radians(mirrored_deg)
    flank = 1.2e-4  # radians: with exponent 1e8 the highlight has fallen to e^−0.7
    light = (math.sin(b + flank), -math.cos(b + flank))
    return f"""
equilux: 1
name: pool
model: raytraced
camera: {{projection: perspective, eye: [{eye[0]!r}, {eye[1]!r}, 0], target: [0, 0, 0], up: [0, 0, 1], fov_y_deg: 1.0e-3}}
film: {{width: 32, height: 32}}
recursion_limit: 1
transparent_shadows: ignore
lights: {{sun: {{kind: directional, direction: [{light[0]!r}, {light[1]!r}, 0], irradiance: 1}}}}
materials:
  surface: {{transparency: 1, transmission: 1, ior: {ior!r}}}
  ground: {{specular: 1, exponent: 1.0e+8}}
  mirror: {{reflection: 1}}
objects:
  - {{{surface}, material: surface}}
  - {{kind: plane, point: [0, -{depth}, 0], normal: [0, 1, 0], material: ground}}
  - {{kind: sphere, center: [0, 50, 0], radius: 1, material: mirror}}
"""


def test_refraction(tmp_path):
    # halfway between two float32; the view ray goes into the water at 75°
    ior = 1.5 + 2.0**-24
    inside = math.degrees(math.asin(math.sin(math.radians(75)) / ior))
    text = pool("kind: plane, point: [0, 0, 0], normal: [0, 1, 0]", "1", 75, ior, inside)
    result, truth, tracer = traced(text, tmp_path, relative_precision=2e-5)
    tilt = term(result.budget, "refraction").normal[0]
    assert truth.max() > 0.1, "the highlight is not in the picture"
    allowed = np.asarray(tracer.sensitivity([tilt, 0.0, 0.0], [0.0, 0.0, 0.0]))
    excess = np.maximum(np.abs(result.image - truth) - bound(result.budget, truth), 0)
    assert_approached("refraction", excess / np.maximum(allowed, 1e-300))


def test_straight_through(tmp_path):
    # 80° off the normal of a pane: tan θ = 5.7
    text = pool("kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 3", "1", 80, 1.0, 80)
    text = text.replace("fov_y_deg: 1.0e-3", "fov_y_deg: 1.0e-2")
    result, truth, _ = traced(text, tmp_path, relative_precision=2e-5)
    assert truth.max() > 0.1, "the highlight is not in the picture"
    stated = term(result.budget, "straight-through").abs
    rest = bound(result.budget, truth, leave_out=["straight-through"])
    excess = np.maximum(np.abs(result.image - truth) - rest, 0)
    assert_approached("straight-through", excess / np.maximum(stated, 1e-300))


HORIZON = """
equilux: 1
name: horizon
model: raytraced
camera: {projection: perspective, eye: [0, 1, 0], target: [0, 1, -1], fov_y_deg: 0.1}
film: {width: 1, height: 400}
background: 0.5
recursion_limit: 1
materials:
  pane: {transparency: 0.5, transmission: 0.5, emission: 0.25}
  mirror: {reflection: 1}
objects:
  - {kind: plane, point: [0, 0, 0], normal: [0, 1, 0], material: pane}
  - {kind: sphere, center: [0, 0.5, 50], radius: 1, material: mirror}
"""


def test_horizon(tmp_path):
    result, truth, _ = traced(HORIZON, tmp_path)
    displaced = int((np.abs(result.image - truth) > 0.01).any(axis=2).sum())
    assert_approached("horizon", displaced / term(result.budget, "horizon").film_px)


LEAN_TO = """
equilux: 1
name: lean-to
model: raytraced
camera: {projection: perspective, eye: [0.05, 0.003, 3], target: [0, 0, 0], fov_y_deg: 5.0e-8}
film: {width: 400, height: 1}
lights: {sun: {kind: directional, direction: [0, -1, 0], irradiance: 1}}
materials: {m: {diffuse: 0.5}}
objects:   # a floor and a roof that rises from it at 8°; the eye looks under the roof, along the line where they meet
  - {kind: rectangle, corner: [-1, 0, -1], edge_u: [2, 0, 0], edge_v: [0, 0, 2], material: m}
  - {kind: rectangle, corner: [0, 0, -1], edge_u: [1, 0.1405, 0], edge_v: [0, 0, 2], material: m}
"""


def test_film_by_blockers_too_near(tmp_path):
    # floor and roof are dark there, but for the strip of the floor where the roof is too near
    result, truth, _ = traced(LEAN_TO, tmp_path, exposures=1)
    assert not truth.any()
    lit = int((np.abs(result.image - truth) > 0.01).any(axis=2).sum())
    assert_approached("film", lit / term(result.budget, "film").film_px)


PARALLEL = """
equilux: 1
name: parallel-mirrors
model: raytraced
camera: {projection: perspective, eye: [0, 0, 0.2], target: [1, 0.2, 1], fov_y_deg: 30}
film: {width: 80, height: 60}
recursion_limit: 255
lights: {lamp: {kind: point, position: [0.3, 0, 0.5], intensity: 0.1}}
materials: {m: {reflection: 0.993, emission: 0.0067, diffuse: 0.5}}
objects:
  - {kind: plane, point: [0, 0, 0], normal: [0, 0, 1], material: m}
  - {kind: plane, point: [0, 0, 1], normal: [0, 0, 1], material: m}
"""


def test_float32_colours_over_255_bounces(tmp_path):
    # many pixels, so that some lie at the brink of half a step; what goes beyond it is arithmetic
    result, truth, _ = traced(PARALLEL, tmp_path, exposures=1)
    film, scales = result.case.scene.film, result.raw.data["full_scales"]
    shown = merge({scales[name]: read_codes(path, film.width, film.height) for name, path in result.raw.files.items()})[0]
    rest = bound(result.budget, truth, leave_out=["float32-colours", "storage"])
    beyond = np.maximum(np.abs(shown - truth) - rest, 0)
    assert_approached("float32-colours", beyond / (term(result.budget, "float32-colours").rel * truth))
