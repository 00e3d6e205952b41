"""Named float32 planes in one OpenEXR file: written atomically, read back exactly."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio

from equilux.wholefile import whole_file


def write_planes(path: Path, planes: Mapping[str, npt.NDArray[Any]]) -> None:
    """Write (h, w) planes as float32 channels, in order. The file appears whole or not at all. Raises OSError."""
    pixels = np.ascontiguousarray(np.stack([np.asarray(plane, np.float32) for plane in planes.values()], axis=-1))
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, oiio.FLOAT)
    spec.channelnames = tuple(planes)
    spec.attribute("compression", "zip")
    with whole_file(path, suffix=".exr") as temporary:
        output = oiio.ImageOutput.create(str(temporary))
        if output is None or not output.open(str(temporary), spec) or not output.write_image(pixels) or not output.close():
            raise OSError(f"{path}: cannot be written ({(output.geterror() if output else oiio.geterror()).strip()})")


def read_planes(path: Path) -> dict[str, npt.NDArray[np.float32]]:
    """Channels by name, (h, w) float32 each. Raises OSError where the file is missing or damaged."""
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise OSError(f"{path}: cannot be read ({oiio.geterror().strip()})")
    try:
        pixels = source.read_image(oiio.FLOAT)
        if pixels is None:
            raise OSError(f"{path}: cannot be read ({source.geterror().strip()})")
        return {name: np.ascontiguousarray(pixels[..., i]) for i, name in enumerate(source.spec().channelnames)}
    finally:
        source.close()
