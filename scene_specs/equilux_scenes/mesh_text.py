"""What the readers of mesh files share: strict numbers, located errors, and polygons split into triangles."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from equilux_scenes.errors import SpecError, SpecErrors, shortened
from equilux_scenes.limits import exceeded

_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\Z")
_INTEGER = re.compile(r"[-+]?[0-9]{1,18}\Z")


class MeshText:
    """Raises located errors of one mesh file."""

    def __init__(self, file: str) -> None:
        self.file = file

    def stop(self, line: int, message: str, column: int = 1) -> SpecErrors:
        """The error to raise."""
        return SpecErrors([SpecError(self.file, line, column, message)])

    def number(self, text: str, line: int, what: str) -> float:
        """A finite decimal number."""
        value = float(text) if _NUMBER.match(text) else math.nan
        if not math.isfinite(value):
            raise self.stop(line, f"{what}: got '{shortened(text)}', allowed a finite number")
        return value

    def integer(self, text: str, line: int, what: str) -> int:
        """A decimal integer."""
        if not _INTEGER.match(text):
            raise self.stop(line, f"{what}: got '{shortened(text)}', allowed an integer")
        return int(text)

    def bounded(self, name: str, count: int, limit: int, line: int) -> None:
        """The limit `name`."""
        if count > limit:
            raise self.stop(line, exceeded(name, count, limit, f"{name} of the mesh"))


def fan(corners: Sequence[int]) -> list[tuple[int, int, int]]:
    """A convex polygon as the triangles that share its first corner."""
    return [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
