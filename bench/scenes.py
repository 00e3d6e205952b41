"""The scenes that are measured, as specs."""

from __future__ import annotations

import json
from typing import Any

from equilux_scenes.case import Case
from equilux_scenes.model import Scene

Spec = dict[str, Any]


def case_of(spec: Spec) -> Case:
    """The case of a spec without sweeps and without mesh files."""
    scene = Scene.model_validate_json(json.dumps(spec))
    return Case(scene.name, scene, scene.name)


def _wall(corner: list[float], edge_u: list[float], edge_v: list[float], material: str) -> Spec:
    return {"kind": "rectangle", "corner": corner, "edge_u": edge_u, "edge_v": edge_v, "material": material}


CORNELL: Spec = {
    "equilux": 1,
    "name": "cornell",
    "model": "raytraced",
    "recursion_limit": 8,
    "background": [0.05, 0.05, 0.1],
    "camera": {"projection": "perspective", "eye": [0, 1, 3.4], "target": [0, 1, 0], "fov_y_deg": 40},
    "film": {"width": 256, "height": 192},
    "lights": {
        "top": {"kind": "point", "position": [0, 1.9, 0.2], "intensity": 3},
        "side": {"kind": "point", "position": [0.5, 1.5, 0.9], "intensity": 1},
    },
    "materials": {
        "white": {"diffuse": 0.3},
        "red": {"diffuse": [0.3, 0.05, 0.05]},
        "green": {"diffuse": [0.05, 0.3, 0.05]},
        "mirror": {"specular": 0.5, "exponent": 50, "reflection": 0.9},
        "glass": {"specular": 0.5, "exponent": 80, "reflection": 0.1, "transmission": 0.95, "transparency": 0.9, "ior": 1.5},
    },
    "objects": [
        _wall([-1, 0, -1], [2, 0, 0], [0, 0, 2], "white"),
        _wall([-1, 2, -1], [0, 0, 2], [2, 0, 0], "white"),
        _wall([-1, 0, -1], [0, 2, 0], [2, 0, 0], "white"),
        _wall([-1, 0, -1], [0, 0, 2], [0, 2, 0], "red"),
        _wall([1, 0, -1], [0, 2, 0], [0, 0, 2], "green"),
        {"kind": "sphere", "center": [-0.45, 0.4, -0.3], "radius": 0.4, "material": "mirror"},
        {"kind": "sphere", "center": [0.45, 0.4, 0.3], "radius": 0.4, "material": "glass"},
        {"kind": "box", "min": [0.2, 0, -0.8], "max": [0.7, 1.1, -0.4], "material": "white"},
    ],
}
