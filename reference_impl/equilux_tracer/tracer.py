"""The tracer's Python face: a case in, arrays of radiance and of what lies behind it out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_tracer import _tracer
from equilux_tracer.channels import CHANNELS
from equilux_tracer.describe import describe

VERSION = "1"
"""Changes whenever a picture may change in its last digit: part of the key under which renders are reused."""

Arrays = dict[str, npt.NDArray[Any]]


class Tracer:
    """One case, prepared once; afterwards any number of threads may use it at the same time.

    case: what to render. precision: "exact" is double and double-double (phong.h says how many digits that leaves). Raises TracerError
    for a scene whose sizes or distances (beyond 1e60 m) or transform (singular) cannot be computed with.
    """

    def __init__(self, case: Case, *, precision: Literal["exact"] = "exact") -> None:
        if precision != "exact":
            raise _tracer.TracerError(f"precision: got {precision!r}, allowed 'exact'")
        self.case = case
        self._lights = len(case.scene.lights)
        self._world = _tracer.World(describe(case))

    def render(
        self, channels: Sequence[str] = ("radiance",), *, threads: int = 0, cancel: _tracer.Cancel | None = None
    ) -> Arrays:
        """The whole film, sampled at pixel centres, row 0 on top.

        channels: names from CHANNELS; each comes back with leading shape (height, width). threads: 0 means one per core; the result does
        not depend on it. cancel: another thread may stop the render through it. Raises TracerError for an unknown channel, Cancelled.
        """
        film = self.case.scene.film
        return self._trace(channels, (film.height, film.width), None, threads, cancel)

    def evaluate(
        self,
        film_xy: npt.ArrayLike,
        channels: Sequence[str] = ("radiance",),
        *,
        threads: int = 0,
        cancel: _tracer.Cancel | None = None,
    ) -> Arrays:
        """Like `render`, at film positions of the caller's choice.

        film_xy: (n, 2), x to the right and y down in pixels; (0.5, 0.5) is the centre of the top-left pixel. Positions off the film are
        fine. Each channel comes back with leading shape (n,).
        """
        positions = _positions(film_xy)
        return self._trace(channels, (len(positions),), positions, threads, cancel)

    def _trace(
        self,
        channels: Sequence[str],
        leading: tuple[int, ...],
        film_xy: npt.NDArray[np.float64] | None,
        threads: int,
        cancel: _tracer.Cancel | None,
    ) -> Arrays:
        unknown = [name for name in channels if name not in CHANNELS]
        if unknown:
            raise _tracer.TracerError(f"channels: got {', '.join(unknown)}, allowed {', '.join(CHANNELS)}")
        arrays: Arrays = {name: CHANNELS[name].empty(leading, self._lights) for name in channels}
        self._world.trace(film_xy=film_xy, arrays=arrays, threads=threads, cancel=cancel)
        return arrays


def _positions(film_xy: npt.ArrayLike) -> npt.NDArray[np.float64]:
    positions = np.ascontiguousarray(film_xy, dtype=np.float64)
    if positions.ndim != 2 or positions.shape[1] != 2:
        raise _tracer.TracerError(f"film_xy: got shape {positions.shape}, allowed (n, 2)")
    return positions
