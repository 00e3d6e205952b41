"""Walls that share an edge leave no gap between them."""

from __future__ import annotations

import numpy as np
import pytest

from equilux_oracle import examine, pixel_centers
from equilux_scenes.loader import load_scene_text

CORNER = """
equilux: 1
name: corner
model: phong
camera: {projection: perspective, eye: [0, 1, 3.9], target: [0, 1, 0], fov_y_deg: FOV}
film: {width: 90, height: 90}
materials: {m: {emission: 1}}
objects:
  - {kind: rectangle, corner: [-1, 0, 1], edge_u: [2, 0, 0], edge_v: [0, 0, -200], material: m}
  - {kind: rectangle, corner: [-1, 2, -199], edge_u: [2, 0, 0], edge_v: [0, 0, 200], material: m}
  - {kind: rectangle, corner: [-1, 0, 1], edge_u: [0, 0, -200], edge_v: [0, 2, 0], material: m}
  - {kind: rectangle, corner: [1, 0, -199], edge_u: [0, 0, 200], edge_v: [0, 2, 0], material: m}
  - {kind: rectangle, corner: [-1, 0, -199], edge_u: [2, 0, 0], edge_v: [0, 2, 0], material: m}
"""


@pytest.mark.parametrize("fov", [5, 17, 33, 38])
def test_a_ray_through_the_crease_of_two_walls_meets_one_of_them(fov: int) -> None:
    case = load_scene_text(CORNER.replace("FOV", str(fov))).cases[0]
    seen = examine(case, pixel_centers(case.scene.film)).object_id.reshape(90, 90)
    diagonals = np.concatenate([seen.diagonal(), np.fliplr(seen).diagonal()])  # exactly along the four creases
    assert (diagonals >= 0).all(), f"{(diagonals < 0).sum()} of {diagonals.size} rays slip through"
