"""POV-Ray's float pictures, OpenEXR and Radiance: one exposure holds almost any range, to the precision that the format has.

OpenEXR is half float: 11 significant bits, to the nearest; below 2^-14 steps of 2^-24; above 65504 infinite. Radiance has 8
bits per band under the exponent of the largest band, cut off, not rounded (Q22).
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio

from equilux.adapter import RendererFailed
from equilux_adapters.povray.exposures import expressible

Floats = npt.NDArray[np.float64]
Channel = Literal["exr", "hdr"]

LARGEST_HALF = float(np.finfo(np.float16).max)
LEAST_NORMAL_HALF = 2.0**-14
LEAST_RGBE = 1e-32  # what is darker is written as black
ROOM = 16.0  # below the largest half: a second look at a picture too bright for it starts here
LOOKS = 8


class FloatPlan:
    """The exposure of one picture: 1, unless half floats cannot hold it."""

    def __init__(self, channel: Channel) -> None:
        self.channel = channel
        self.looked: dict[float, Floats] = {}

    def next_wave(self) -> list[float]:
        """The full scale to render now: what is stored is radiance over it. Empty when the picture is good."""
        if not self.looked:
            return [1.0]
        scale, stored = list(self.looked.items())[-1]
        if self.channel == "hdr" or len(self.looked) >= LOOKS:
            return []
        if not np.isfinite(stored).all():
            return [expressible(scale * LARGEST_HALF / ROOM)]
        brightest = float(stored.max())
        if 0 < brightest < LEAST_NORMAL_HALF and len(self.looked) == 1:
            return [expressible(scale * brightest)]
        return []

    def chosen(self) -> list[float]:
        """The last one."""
        return [list(self.looked)[-1]]


def half_step(channel: Channel, stored: Floats) -> Floats:
    """By how much the numbers in a file may be off what POV-Ray computed, (h, w, 3)."""
    if channel == "exr":
        spacing: Floats = np.spacing(np.minimum(stored, LARGEST_HALF).astype(np.float16)).astype(np.float64)
        return np.where(np.isfinite(stored), spacing / 2, np.inf)
    _, exponent = np.frexp(stored.max(axis=2, keepdims=True))
    return np.broadcast_to(np.where(stored.max(axis=2, keepdims=True) > 0, np.ldexp(1.0, exponent - 8), LEAST_RGBE), stored.shape)


def read_floats(path: Path, width: int, height: int) -> Floats:
    """(h, w, 3) as stored. Raises RendererFailed when the file is missing, unreadable, of another size or has no three bands."""
    if not path.exists():
        raise RendererFailed(f"POV-Ray wrote no {path.name}")
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise RendererFailed(f"{path.name} is no image: {oiio.geterror()}")
    try:
        spec = image.spec()
        if (spec.width, spec.height, spec.nchannels) != (width, height, 3):
            got = f"{spec.width}×{spec.height}, {spec.nchannels} bands"
            raise RendererFailed(f"{path.name} is {got}, expected {width}×{height}, 3 bands")
        numbers = image.read_image(0, 0, 0, 3, "float")
        if numbers is None:
            raise RendererFailed(f"{path.name} is truncated or damaged: {image.geterror()}")
    finally:
        image.close()
    return np.asarray(numbers, dtype=np.float64).reshape(height, width, 3)
