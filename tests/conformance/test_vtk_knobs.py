"""Every step of VTK's knobs: the error is within the budget at every pixel off edges, and comes near it."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_tracer import Tracer
from support.vtk import case_of_text, run, term_of
from support.within import complaint

SCENE = """
equilux: 1
name: ball-and-floor
model: phong
camera: {{projection: perspective, eye: [0.1, 0.4, 3], target: [0, 0, 0], fov_y_deg: 40}}
film: {{width: 96, height: 72}}
background: {background}
lights: {{key: {{kind: point, position: [0.5, 2, 3], intensity: {intensity}}}}}
materials:
  clay: {{diffuse: [0.6, 0.4, 0.2], specular: 0.5, exponent: 20, emission: {emission}}}
  floor: {{diffuse: [0.2, 0.3, 0.4]}}
objects:
  - {{kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}}
  - {{kind: plane, point: [0, -0.5, 0], normal: [0, 1, 0], material: floor}}
"""


def scene(intensity: float = 7.5, background: float = 0.1, emission: float = 0.01):
    return case_of_text(SCENE.format(intensity=intensity, background=background, emission=emission))


def steps(knob: str) -> list:
    return VtkKnobs.model_fields[knob].json_schema_extra["steps"]


SETTINGS = [{knob: step} for knob in ("tessellation", "target", "samples", "interpolation") for step in steps(knob)]


@pytest.mark.parametrize("setting", [*SETTINGS, {"target": "uint8", "samples": 4}, {"target": "float16", "samples": 4}], ids=str)
def test_a_step_is_as_good_as_it_says_and_no_better(setting, tmp_path):
    said = complaint(run(scene(), tmp_path, **setting), setting)
    assert said is None, said


def test_gouraud_is_phong(tmp_path):
    gouraud, phong = (run(scene(), tmp_path / how, tessellation=16, interpolation=how) for how in ("gouraud", "phong"))
    assert np.array_equal(gouraud.image, phong.image)


@pytest.mark.parametrize("target", ["uint8", "float16"])
@pytest.mark.parametrize("brightness", [1e6, 1e-6])
def test_nothing_is_clipped_and_little_is_lost_whatever_the_brightness(target, brightness, tmp_path):
    case = scene(intensity=7.5 * brightness, background=0.1 * brightness, emission=0.01 * brightness)
    result = run(case, tmp_path, target=target)
    truth = Tracer(case).render()["radiance"]
    assert complaint(result, (target, brightness)) is None
    assert result.image.max() == pytest.approx(truth.max(), rel=0.01)
    full_scale = result.raw.data["full_scale"]
    assert np.log2(full_scale) == round(np.log2(full_scale))
    if target == "uint8":
        assert 0.5 < result.image.max() / full_scale < 1, f"full scale {full_scale}, brightest {result.image.max()}"


def test_half_floats_are_cut_off_not_rounded(tmp_path):
    case = scene()
    exact, half = run(case, tmp_path / "32", target="float32"), run(case, tmp_path / "16", target="float16")
    normal = exact.image > 1e-3
    off = (exact.image - half.image)[normal] / exact.image[normal]
    assert off.min() >= 0, f"{off.min()}: rounded up somewhere"
    assert 2.0**-11 < off.max() <= 2.0**-10


def test_a_mean_over_pixels_differs_from_the_centres_where_it_is_stated(tmp_path):
    case = scene()
    centres, mean = run(case, tmp_path / "0"), run(case, tmp_path / "4", samples=4)
    changed = np.abs(mean.image - centres.image).max(axis=2) > 0.02
    assert 0.005 < changed.mean() < 0.2
    assert np.all(np.max(term_of(mean, "pixel mean").abs, axis=2)[changed] > 0.02)


def test_more_samples_than_the_driver_has_are_refused_by_name(tmp_path):
    from equilux.adapter import RendererFailed

    with pytest.raises(RendererFailed, match="no framebuffer of 16 samples per pixel"):
        run(scene(), tmp_path, samples=16)
