"""What a user reads: the messages of specs that are wrong in many places, kept as snapshots.

`pytest --force-regen` rewrites them; a change of wording is then seen in the diff.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

SPECS = {
    "everything_wrong": """\
equilux: 1
name: Clay Ball
model: raytraced
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 3], up: [0, 1, 0], fov_y_deg: 180}
film: {width: 256.0, height: 0}
lights:
  key: {kind: pont, position: [0, 2, 3], intensity: 7.5}
  a: {kind: point, position: [0, 2, .inf], intensity: -7.5, spectrum: 3}
  b: {kind: sphere, position: [0, 2, 3], intensity: [1, 2, -3]}
  c: {kind: point, position: [0, 2], intensity: 7.5, attenuation: {constant: 0}}
  7: {kind: point}
materials:
  clay: {diffuse: [.6, 0.6, 0.6], specular: 0.5, exponant: 2e1, transparency: 2, emission: ~}
  slate: {transparency: 1, viewer: local}
  slate: {}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.0, material: clai,
     transform: [{scale: 0}, {scale: 1, rotate: {axis: [0, 0, 0], degrees: 30}}, {}, {matrix: [[1, 0, 0, 0]]}]}
  - kind: mesh
    normals: smoth
    vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    faces: [[0, 1, 3]]
    material: clay
  - {kind: mesh, material: clay}
  - {kind: mesh, material: clay, file: ../x.ply}
  - {kind: mesh, material: clay, file: x.stl}
  - {kind: box, min: [0, 0, 0], max: [1, 0, -1], material: clay}
  - {kind: rectangle, corner: [0, 0, 0], edge_u: [1, 0, 0], edge_v: [1, 1, 0], material: clay}
  - {kind: cylinder, base: [0, 0, 0], top: [0, 0, 0], radius: 1, capped: yes, material: clay}
  - {kind: disc, center: [0, 0, 0], normal: [0, 0, 0], material: clay}
  - {center: [0, 0, 0]}
  - 7
sweep:
  exponent: {path: materials.clay.exponant, values: [1, 10, -0.1]}
  slate: {path: materials.slate.exponent, values: [1, 10, -0.1, 1.0]}
  nowhere: {path: objects.77.exponent, values: []}
expect:
  - {adapter: vtk, cause: exponent-clampd, when: "exponnt > 128 or slate < 1 and"}
  - {adapter: '', cause: exponent-clamped, when: "exponnt > 128 or slate < 1"}
  - adapter: vtk
surprise: 1
""",
    "terms_of_other_models": """\
equilux: 1
name: mirror
model: phong
camera: {projection: orthographic, eye: [0, 3, 0], target: [0, 0, 0], height_m: 1}
film: {width: 8, height: 8}
recursion_limit: 3
transparent_shadows: ignore
viewer: infinite
lights:
  sun: {kind: directional, direction: [0, -1, 0], irradiance: 1, ambient: 0.1, diffuse: 0.5, specular: [1, 1, 0]}
  sky: {kind: environment, radiance: 1}
materials:
  glass: {reflection: 0.1, transmission: [0.9, 0.9, 1], transparency: 0.9, ior: 1.5, brdf: lambert}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 1, material: glass}
""",
    "not_a_scene": "- 1\n- 2\n",
    "cut_off": "equilux: 1\nname: cut\nfilm: {width: 1, hei",
    "nothing_in_it": "{}\n",
}


@pytest.mark.parametrize("name", SPECS)
def test_the_messages_of_a_wrong_spec(errors_of: Callable[..., Any], file_regression: Any, name: str) -> None:
    file_regression.check("\n".join(str(error) for error in errors_of(SPECS[name])) + "\n", encoding="utf-8")
