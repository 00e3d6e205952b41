"""Where pixels lie, in numbers and in the scene's own words."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from equilux.diagnose.diagnosis import Region
from equilux.diagnose.evidence import centres
from equilux.diagnose.trials import Bench

MOST_PIXELS = 2000


class Regions:
    """Regions of one case's film."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    def region(self, mask: npt.NDArray[np.bool_]) -> Region | None:
        """None of no pixels."""
        if not mask.any():
            return None
        rows, columns = np.nonzero(mask)
        return Region(
            pixels=len(rows), x0=int(columns.min()), y0=int(rows.min()), x1=int(columns.max()), y1=int(rows.max()),
            words=self._words(mask),
        )  # fmt: skip

    def _words(self, mask: npt.NDArray[np.bool_]) -> str:
        pixels = np.flatnonzero(mask)
        pixels = pixels[:: len(pixels) // MOST_PIXELS + 1]
        seen = self._bench.model.evaluate(centres(pixels, mask.shape[1]), ("object_id",))["object_id"]
        objects = self._bench.case.scene.objects
        parts = []
        found, counts = np.unique(seen, return_counts=True)
        for index in found[np.argsort(-counts, kind="stable")]:
            if 0 <= index < len(objects):
                parts.append(f"on objects[{index}] ({objects[index].kind}, {objects[index].material})")
            else:
                parts.append("on the background" if index < 0 else "on an emitter")
        return ", ".join(parts[:3]) + (f" and {len(parts) - 3} more" if len(parts) > 3 else "")
