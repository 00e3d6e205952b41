"""The script's image, with its budget."""

from __future__ import annotations

import numpy as np

from equilux.adapter import Program, RawRender, Reading, RendererFailed
from equilux_adapters.vtk.budget import budget_of
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_adapters.vtk.render import IMAGE


def read(raw: RawRender, program: Program, knobs: VtkKnobs) -> Reading:
    """float32 (h, w, 3). Raises RendererFailed when the script left no such image."""
    try:
        image = np.load(raw.files[IMAGE])
    except (OSError, ValueError, EOFError) as error:
        raise RendererFailed(f"{IMAGE}: {error}") from error
    largest = float(np.max(np.abs(image), initial=0.0, where=np.isfinite(image)))
    return Reading(image, budget_of(program.data, largest))
