"""Read the 16-bit codes of a PNG that POV-Ray wrote, untouched."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from equilux.adapter import RendererFailed
from equilux_adapters.povray.exposures import Codes


def read_codes(path: Path, width: int, height: int) -> Codes:
    """(h, w, 3) uint16. Raises RendererFailed when the file is missing, unreadable, of another size or not 16-bit RGB."""
    if not path.exists():
        raise RendererFailed(f"POV-Ray wrote no {path.name}")
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise RendererFailed(f"{path.name} is no image: {oiio.geterror()}")
    try:
        spec = image.spec()
        if (spec.width, spec.height, spec.nchannels) != (width, height, 3) or str(spec.format) != "uint16":
            got = f"{spec.width}×{spec.height}, {spec.nchannels} × {spec.format}"
            raise RendererFailed(f"{path.name} is {got}, expected {width}×{height}, 3 × uint16")
        codes = image.read_image(0, 0, 0, 3, "uint16")
        if codes is None:
            raise RendererFailed(f"{path.name} is truncated or damaged: {image.geterror()}")
    finally:
        image.close()
    return np.asarray(codes, dtype=np.uint16).reshape(height, width, 3)
