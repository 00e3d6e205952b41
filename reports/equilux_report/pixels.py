"""Reading the float pictures of a results tree, channel by name, bit for bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio

Plane = npt.NDArray[np.float32]


class UnreadableImage(Exception):
    """An image file that is damaged, or lacks the channels it should have."""


def read_planes(path: Path) -> dict[str, Plane]:
    """Channel name → (h, w) float32, row 0 on top. Raises UnreadableImage."""
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise UnreadableImage(f"{path.name}: {oiio.geterror() or 'cannot be opened'}")
    try:
        names = list(source.spec().channelnames)
        pixels = source.read_image(oiio.FLOAT)
        if pixels is None:
            raise UnreadableImage(f"{path.name}: {source.geterror() or 'cannot be read'}")
    finally:
        source.close()
    return {name: np.ascontiguousarray(pixels[:, :, index], dtype=np.float32) for index, name in enumerate(names)}


def require(planes: dict[str, Plane], names: tuple[str, ...], path: Path) -> dict[str, Plane]:
    """Only the named channels, in that order. Raises UnreadableImage if one is absent."""
    absent = [name for name in names if name not in planes]
    if absent:
        raise UnreadableImage(f"{path.name}: no channel {', '.join(absent)}; it has {', '.join(planes)}")
    return {name: planes[name] for name in names}


BANDS = ("R", "G", "B")
PAIR_CHANNELS = ("R", "G", "B", "en.R", "en.G", "en.B", "class")
