"""Ballcaster's PFM → linear radiance with its uncertainty."""

from __future__ import annotations

import numpy as np

from equilux.adapter import Bound, Budget, RawRender, Reading, RendererFailed

BUDGET = Budget(
    terms=(
        Bound("float32 storage", "PFM holds float32: half a unit in the last place, 2^-24 of the value", rel=2.0**-24),
        # The longest chain is some thirty roundings of 2^-53. The hit point of a ball that fills a thousandth of the distance
        # to it loses up to 1e3 of that by cancellation, and E = I / r² twice as much.
        Bound("arithmetic", "thirty roundings in double, times 1e3 lost by cancellation in the hit point", rel=1e-11, abs=1e-13),
    )
)



def read(raw: RawRender) -> Reading:
    """(h, w, 3) float32, row 0 on top: a PFM starts with the bottom row."""
    data = raw.files["picture"].read_bytes()
    try:
        kind, size, scale, pixels = data.split(b"\n", 3)
        width, height = map(int, size.split())
        order = "<" if float(scale) < 0 else ">"
        image = np.frombuffer(pixels, dtype=f"{order}f4").reshape(height, width, 3)[::-1].astype(np.float32)
    except ValueError as error:
        raise RendererFailed(f"picture.pfm is not a whole PFM: {error}") from None
    if kind != b"PF":
        raise RendererFailed(f"picture.pfm starts with {kind[:8]!r}, expected b'PF', the colour kind of PFM")
    return Reading(image, BUDGET)
