"""Every step of the reference's knobs: the error is within the budget at every pixel off edges, and comes near it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from equilux.adapter import Budget, Limits, Program, Unsupported
from equilux_adapters.reference import ADAPTER
from equilux_adapters.reference.knobs import ReferenceKnobs
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from support.vtk import case_of_text
from support.within import complaint

SHAPES = """
equilux: 1
name: round-shapes
model: {model}
camera: {{projection: {camera}, eye: [0.2, 0.6, 4], target: [0, 0, 0]}}
film: {{width: 80, height: 60}}
lights: {{key: {{kind: point, position: [1, 2, 3], intensity: 9}}}}
materials: {{clay: {{diffuse: [0.6, 0.4, 0.2], specular: 0.5, exponent: 20}}}}
objects:
  - {{kind: sphere, center: [-0.7, 0, 0], radius: 0.5, material: clay}}
  - {{kind: sphere, center: [0, 0, 0], radius: 0.3, material: clay,
     transform: [{{scale: [-1.5, 0.8, 1]}}, {{rotate: {{axis: [1, 2, 3], degrees: 40}}}}, {{translate: [0.5, 0.5, 0]}}]}}
  - {{kind: cylinder, base: [0.7, -0.6, 0], top: [0.8, 0.2, -0.4], radius: 0.25, material: clay}}
  - {{kind: disc, center: [0, -0.6, 0.5], normal: [0, 1, 0.3], radius: 0.3, material: clay}}
  - {{kind: plane, point: [0, -0.8, 0], normal: [0, 1, 0], material: clay}}
"""
CAMERAS = {"perspective": "perspective, fov_y_deg: 30", "orthographic": "orthographic, height_m: 2"}
HALL = """
equilux: 1
name: hall
model: raytraced
camera: {projection: perspective, eye: [0, 0, 1], target: [0.4, 0.1, 0], fov_y_deg: 60}
film: {width: 48, height: 32}
lights: {sun: {kind: directional, direction: [0, -1, -1], irradiance: 0.2}}
materials: {glow: {emission: [0.1, 0.05, 0.02], diffuse: 0.1, reflection: [0.5, 0.25, 0.1]}}
objects:
  - {kind: plane, point: [0, 0, 0], normal: [0, 0, 1], material: glow}
  - {kind: plane, point: [0, 0, 2], normal: [0, 0, -1], material: glow}
recursion_limit: 12
"""
GLASS = """
equilux: 1
name: glass
model: raytraced
camera: {projection: perspective, eye: [0.3, 0.4, 4], target: [0, 0, 0], fov_y_deg: 40}
film: {width: 64, height: 48}
background: [0.1, 0.15, 0.2]
lights: {key: {kind: point, position: [1, 2, 3], intensity: 6}}
materials:
  glass: {diffuse: 0.1, specular: 0.2, exponent: 9, reflection: 0.1, transmission: [0.9, 0.8, 0.7], transparency: 0.8, ior: 1.5}
  mirror: {diffuse: [0.1, 0.2, 0.05], specular: [0.5, 0.1, 0.02], exponent: 12, reflection: [0.7, 0.3, 0.4]}
objects:
  - {kind: sphere, center: [-0.6, 0, 0.3], radius: 0.6, material: glass}
  - {kind: sphere, center: [0.7, 0, 0], radius: 0.7, material: mirror}
  - {kind: plane, point: [0, -0.9, 0], normal: [0, 1, 0], material: mirror}
recursion_limit: 6
"""


@dataclass(frozen=True)
class Run:
    case: Case
    program: Program
    image: np.ndarray
    budget: Budget


def run(case: Case, folder: Path, **knobs: object) -> Run:
    settings = ReferenceKnobs.model_validate(knobs)
    program = ADAPTER.translate(case, settings)
    for name, content in program.files.items():
        (folder / name).write_bytes(content)
    reading = ADAPTER.read(ADAPTER.render(program, folder, folder, Limits(), settings), program, settings)
    return Run(case, program, np.asarray(reading.image), reading.budget)


def steps(knob: str) -> list:
    return ReferenceKnobs.model_fields[knob].json_schema_extra["steps"]


FACETS = [("perspective", step) for step in steps("tessellation") if step] + [("orthographic", 96)]


@pytest.mark.parametrize(("camera", "segments"), FACETS)
def test_facets_displace_no_more_than_is_stated_and_not_much_less(camera, segments, tmp_path):
    case = case_of_text(SHAPES.format(model="phong", camera=CAMERAS[camera]))
    said = complaint(run(case, tmp_path, tessellation=segments), segments)
    assert said is None, said


def test_finer_facets_are_nearer_to_the_truth(tmp_path):
    case = case_of_text(SHAPES.format(model="opengl", camera=CAMERAS["perspective"]))
    truth = Tracer(case).render()["radiance"]
    off = [np.abs(run(case, tmp_path, tessellation=n).image - truth).max(axis=2) for n in (32, 64, 192)]
    errors = [float(np.median(one[off[0] > 1e-9])) for one in off]
    assert errors[0] > 2 * errors[1] > 8 * errors[2] > 0, errors


def test_facets_are_refused_where_rays_are_followed(tmp_path):
    with pytest.raises(Unsupported, match="facets are divided for camera rays"):
        run(case_of_text(GLASS), tmp_path, tessellation=64)


@pytest.mark.parametrize("depth", steps("recursion_depth"))
def test_bounces_are_cut_by_as_much_as_is_stated(depth, tmp_path):
    said = complaint(run(case_of_text(HALL), tmp_path, recursion_depth=depth), depth)
    # nothing is cut at the scene's own depth, and the reference is held against itself
    assert said is None or depth == "scene", said


@pytest.mark.parametrize("depth", [0, 2, 4])
def test_the_bound_holds_with_glass_and_curved_mirrors(depth, tmp_path):
    said = complaint(run(case_of_text(GLASS), tmp_path, recursion_depth=depth), depth)
    assert said is None or "nothing could trip it" in said, said


def test_a_depth_beyond_the_scenes_own_changes_nothing(tmp_path):
    case = case_of_text(GLASS)
    assert run(case, tmp_path, recursion_depth=100).program == run(case, tmp_path).program
