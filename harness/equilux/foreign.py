"""An image that someone else rendered: reading it, and what its file format alone leaves uncertain."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from equilux.adapter import Bound, Budget, Image
from equilux.complaint import BadUsage

FORMATS = {
    "half": Bound("half", "half a unit in the last place of a half float, 2^-25 below 6.1e-5", abs=2.0**-25, rel=2.0**-11),
    "uint8": Bound("quantisation", "half a step of 8 bits", abs=0.5 / 255),
    "uint16": Bound("quantisation", "half a step of 16 bits", abs=0.5 / 65535),
}
"""Type of the channels → what storing in it may have cost. float and double cost no more than storing in float32, which is
always counted."""


def read_image(path: Path) -> tuple[Image, Budget]:
    """Linear radiance (h, w, 3), row 0 on top, and the budget of the file format alone. Integers are taken as linear, the
    largest as 1.

    Raises BadUsage for what cannot be read, has fewer than three channels or is no picture.
    """
    if not path.is_file():
        raise BadUsage(f"no such file: '{path}'")
    return _read_array(path) if path.suffix == ".npy" else _read_picture(path)


def _read_array(path: Path) -> tuple[Image, Budget]:
    try:
        image = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as problem:
        raise BadUsage(f"'{path}' cannot be read: {problem}") from problem
    if image.ndim != 3 or image.shape[2] != 3 or image.size == 0 or image.dtype not in (np.float32, np.float64):
        raise BadUsage(
            f"'{path}' holds {image.dtype} of shape {image.shape}, expected float32 or float64 of shape (height, width, 3)"
        )
    return np.ascontiguousarray(image), Budget()


def _read_picture(path: Path) -> tuple[Image, Budget]:
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise BadUsage(f"'{path}' cannot be read: {' '.join(oiio.geterror().split())}")
    try:
        spec = source.spec()
        pixels = source.read_image(oiio.FLOAT)
        error = " ".join(source.geterror().split())
    finally:
        source.close()
    if pixels is None or error:
        raise BadUsage(f"'{path}' cannot be read: {error or 'it ends too early'}")
    names = [str(name) for name in spec.channelnames]
    if len(names) < 3:
        raise BadUsage(f"'{path}' has the channels {', '.join(names)}, expected R, G, B")
    bands = [names.index(band) for band in "RGB"] if {"R", "G", "B"} <= set(names) else [0, 1, 2]
    image = np.ascontiguousarray(pixels[..., bands], dtype=np.float32)
    stored = FORMATS.get(str(spec.format))
    return image, Budget((stored,) if stored is not None else ())
