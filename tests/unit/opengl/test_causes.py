"""Mesa's own rule for exponent 0, as the diagnosis applies it (Q10)."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.diagnose.catalogue import all_rules
from equilux_adapters.opengl.causes import RULES, MesaShininessZero
from equilux_scenes.case import Case
from equilux_scenes.loader import load_scene_text
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, ChangedTracer

SCENE = """
equilux: 1
name: flat-highlight
model: {model}
camera: {{projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40}}
film: {{width: 16, height: 12}}
lights:
  key: {light}
materials:
  flat: {{diffuse: 0.3, specular: [0.5, 0.4, 0.2], exponent: {exponent}}}
  matte: {{diffuse: 0.3}}
objects:
  - {{kind: sphere, center: [-0.3, 0, 0], radius: 0.5, material: flat}}
  - {{kind: sphere, center: [0.5, 0, 0], radius: 0.3, material: matte}}
"""
POINT = "{kind: point, position: [0, 2, 3], intensity: 7.5}"
SPOT = "{kind: spot, position: [0, 0, 3], direction: [0, 0, -1], intensity: 5, cone_half_angle_deg: 60}"
CONSTANT = "{kind: point, position: [0, 2, 3], intensity: 7.5, attenuation: {constant: 1}}"
SUN = "{kind: directional, direction: [0, -1, -1], irradiance: 1}"


def case(light: str = POINT, exponent: float = 0, model: str = "opengl") -> Case:
    return load_scene_text(SCENE.format(light=light, exponent=exponent, model=model)).cases[0]


def test_the_rule_is_registered_and_its_name_is_a_third_partys():
    assert [rule.id for rule in RULES] == ["mesa:shininess-zero"]
    assert isinstance(all_rules()["mesa:shininess-zero"], MesaShininessZero)


@pytest.mark.parametrize("light", [POINT, SPOT])
def test_the_highlight_is_the_cosine_raised_to_itself(light: str):
    scene = case(light)
    changed = ChangedTracer(scene, [Applied("mesa:shininess-zero")], all_rules()).render()["radiance"]
    truth = Tracer(scene).render(("radiance", "diffuse", "specular", "object_id"))
    flat = (truth["object_id"] == 0) & (truth["specular"][..., 0, 0] > 0)
    assert flat.sum() > 10
    share = truth["specular"][flat][:, 0] / np.array([0.5, 0.4, 0.2])
    cosine = truth["diffuse"][flat][:, 0] / (0.3 * share)
    expected = truth["radiance"][flat] + truth["specular"][flat][:, 0] * (cosine**cosine - 1)
    np.testing.assert_allclose(changed[flat], expected, rtol=1e-12)
    np.testing.assert_array_equal(changed[~flat], truth["radiance"][~flat])


@pytest.mark.parametrize(
    ("light", "exponent", "model"), [(SUN, 0, "opengl"), (CONSTANT, 0, "opengl"), (POINT, 1, "opengl"), (POINT, 0, "phong")]
)
def test_it_is_no_hypothesis_where_mesa_does_what_the_model_says(light: str, exponent: float, model: str):
    assert RULES[0].hypotheses(case(light, exponent, model)) == []
