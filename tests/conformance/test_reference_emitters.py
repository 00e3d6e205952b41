"""The reference adapter on model `reflection-equation`: the error target is a knob, and what it leaves is in the budget."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from equilux.adapter import Bound, Limits, Reading
from equilux_adapters.reference import ADAPTER
from equilux_scenes.case import Case
from support.random_scenes import case_of

DESK: dict[str, Any] = {
    "equilux": 1, "name": "desk", "model": "reflection-equation", "film": {"width": 24, "height": 18},
    "camera": {"projection": "perspective", "eye": [2, 2, 2], "target": [0, 0, 0.3], "up": [0, 0, 1], "fov_y_deg": 40},
    "materials": {"m": {"diffuse": 0.25}},
    "objects": [
        {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"},
        {"kind": "sphere", "center": [0.3, 0.2, 0.4], "radius": 0.3, "material": "m"},
    ],
}  # fmt: skip
SHEET = {"kind": "rectangle", "corner": [-0.4, -0.7, 2.0], "edge_u": [0, 1.4, 0], "edge_v": [0.8, 0, 0], "radiance": 1.0}
SUN = {"kind": "directional", "direction": [0, 0.2, -1], "irradiance": 1.0}


def read(folder: Any, light: dict[str, Any], **knobs: Any) -> Reading:
    case: Case = case_of({**DESK, "lights": {"l": light}})
    chosen = ADAPTER.Knobs(**knobs)
    program = ADAPTER.translate(case, chosen)
    for name, content in program.files.items():
        (folder / name).write_bytes(content)
    return ADAPTER.read(ADAPTER.render(program, folder, folder, Limits(), chosen), program, chosen)


def bound(reading: Reading, name: str) -> np.ndarray:
    (term,) = (term for term in reading.budget.terms if term.name == name)
    assert isinstance(term, Bound)
    return np.asarray(term.abs)


def test_a_larger_error_target_is_stated_and_kept(tmp_path):
    fine, coarse = read(tmp_path, SHEET, error_target=1e-9), read(tmp_path, SHEET, error_target=1e-2)
    stated = bound(coarse, "quadrature")
    assert stated.shape == fine.image.shape
    assert bound(fine, "quadrature").max() < 1e-3 * stated.max()
    assert stated.max() <= 1e-2 * fine.image.max()
    assert (np.abs(coarse.image - fine.image) <= stated + bound(fine, "quadrature") + bound(fine, "arithmetic")).all()
    assert np.abs(coarse.image - fine.image).max() > 0, "the knob changes nothing"


def test_scenes_without_integrals_have_no_such_term(tmp_path):
    assert [term.name for term in read(tmp_path, SUN).budget.terms] == ["arithmetic"]


@pytest.mark.parametrize("target", [0, 1e-12, 0.5])
def test_targets_that_mean_nothing_are_refused(target):
    with pytest.raises(ValidationError, match="error_target"):
        ADAPTER.Knobs(error_target=target)
