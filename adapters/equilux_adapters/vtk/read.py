"""The script's image, with its budget."""

from __future__ import annotations

import numpy as np

from equilux.adapter import Budget, Image, Program, RawRender, Reading, RendererFailed
from equilux.budget import pixel_mean
from equilux_adapters.vtk.budget import budget_of, of_storage
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_adapters.vtk.render import CENTRES, IMAGE


def read(raw: RawRender, program: Program, knobs: VtkKnobs) -> Reading:
    """float32 (h, w, 3). Raises RendererFailed when the script left no such image."""
    image = _loaded(raw, IMAGE)
    centres = _loaded(raw, CENTRES) if CENTRES in raw.files else image
    largest = float(np.max(np.abs(centres), initial=0.0, where=np.isfinite(centres)))
    terms = budget_of(program.data, largest).terms
    if knobs.target != "float32":
        terms = (*terms, of_storage(knobs.target, centres, raw.data["full_scale"]))
    if centres is not image:
        terms = (*terms, pixel_mean(image, centres, terms))
    return Reading(image.astype(np.float32), Budget(terms))


def _loaded(raw: RawRender, name: str) -> Image:
    try:
        return np.asarray(np.load(raw.files[name]))
    except (OSError, ValueError, EOFError) as error:
        raise RendererFailed(f"{name}: {error}") from error
