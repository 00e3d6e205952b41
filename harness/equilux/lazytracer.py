"""The reference tracer of a case, built when it is first asked: most pairs agree without it."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from equilux.adapter import Case

if TYPE_CHECKING:
    from equilux_tracer import Tracer


class LazyTracer:
    """What comparison asks of the tracer, for one case; safe to use from several threads."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self._tracer: Tracer | None = None
        self._lock = threading.Lock()

    def _built(self) -> Tracer:
        with self._lock:
            if self._tracer is None:
                from equilux_tracer import Tracer

                self._tracer = Tracer(self.case)
            return self._tracer

    def render(self) -> dict[str, npt.NDArray[Any]]:
        return self._built().render()

    def evaluate(self, film_xy: npt.NDArray[np.float64], channels: Sequence[str]) -> dict[str, npt.NDArray[Any]]:
        return self._built().evaluate(film_xy, channels)

    def sensitivity(self, normal: Any, position_m: Any) -> npt.NDArray[np.float64]:
        return self._built().sensitivity(normal, position_m)

    def release(self) -> None:
        """Give back its memory; it is built again if it is asked again."""
        with self._lock:
            self._tracer = None
