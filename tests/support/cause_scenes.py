"""Small scenes on which causes of picture and geometry show: nothing in them is symmetric."""

from __future__ import annotations

import json
from typing import Any

from equilux_scenes.case import Case
from equilux_scenes.loader import load_scene_text

SPEC: dict[str, Any] = {
    "equilux": 1,
    "name": "lopsided",
    "model": "phong",
    "camera": {"projection": "perspective", "eye": [0.4, 0.6, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 38},
    "film": {"width": 24, "height": 16},
    "ambient": [0.1, 0.2, 0.3],
    "background": [0.02, 0.05, 0.11],
    "lights": {"key": {"kind": "point", "position": [1.5, 2, 3], "intensity": [14, 16, 18]}},
    "materials": {"clay": {"diffuse": [0.6, 0.4, 0.2], "specular": [0.5, 0.4, 0.3], "exponent": 20, "ambient": [0.7, 0.8, 0.9]}},
    "objects": [
        {"kind": "sphere", "center": [-0.5, 0, 0], "radius": 0.6, "material": "clay"},
        {"kind": "sphere", "center": [0.6, 0.2, 0.3], "radius": 0.4, "material": "clay"},
    ],
}

ROOF = {
    "kind": "mesh",
    "material": "clay",
    "vertices": [[-1, -0.6, 0], [1, -0.7, 0.1], [0.9, 0.8, -0.2], [-0.8, 0.7, 0.1], [0.1, 0, 0.6]],
    "faces": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
}
"""Four triangles around a tip, seen from the front."""


def lopsided(**changes: Any) -> Case:
    """The scene with some of its keys replaced."""
    return load_scene_text(json.dumps({**SPEC, **changes})).cases[0]
