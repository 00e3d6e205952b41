"""Scenes of the oracle's tests: a spec with one thing in it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from equilux_scenes.case import Case
from support.random_scenes import case_of

STRAIGHT_DOWN = {"projection": "orthographic", "eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "height_m": 8}


@pytest.fixture
def make_case() -> Callable[..., Case]:
    """One object, one material and some lights; by default seen straight from above (+z), 8 × 8 metres on 8 × 8 pixels."""

    def make(shape: dict[str, Any], material: dict[str, Any], *lights: dict[str, Any], **scene: Any) -> Case:
        spec = {
            "equilux": 1,
            "name": "one",
            "model": "phong",
            "camera": STRAIGHT_DOWN,
            "film": {"width": 8, "height": 8},
            "lights": {f"l{k}": light for k, light in enumerate(lights)},
            "materials": {"m": material},
            "objects": [{**shape, "material": "m"}],
        }
        return case_of({**spec, **scene})

    return make
