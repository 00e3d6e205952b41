"""The script's picture, with its budget."""

from __future__ import annotations

import zipfile

import numpy as np

from equilux.adapter import Program, RawRender, Reading, RendererFailed
from equilux_adapters.mitsuba.budget import budget_of
from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_adapters.mitsuba.render import PICTURE


def read(raw: RawRender, program: Program, knobs: MitsubaKnobs) -> Reading:
    """float64 (h, w, 3): the mean of float32 pictures. Raises RendererFailed when the script left no such picture."""
    try:
        with np.load(raw.files[PICTURE], allow_pickle=False) as file:
            picture = {name: file[name] for name in file.files}
            image = picture["image"]
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as error:
        raise RendererFailed(f"{PICTURE}: {error}") from error
    return Reading(image, budget_of(program.data, picture, knobs.repeats))
