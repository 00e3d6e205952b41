"""How numbers, vectors and matrices are written in POV-Ray's scene language."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt


def number(value: float) -> str:
    """The shortest text that POV-Ray's parser reads back to the same double."""
    text = repr(float(value) + 0.0)
    return text[:-2] if text.endswith(".0") else text


def vector(values: Iterable[float]) -> str:
    return "<" + ", ".join(number(value) for value in values) + ">"


def bands(values: Sequence[float]) -> str:
    """A colour: three bands, or one number when they are equal (`rgb 0.6`)."""
    return number(values[0]) if len(set(values)) == 1 else vector(values)


def matrix_modifier(matrix: npt.NDArray[np.float64]) -> str:
    """`matrix <…>` of a (4, 4) matrix acting on column vectors: POV-Ray acts on row vectors and leaves out the last column."""
    return "matrix " + vector(matrix[:3, :].T.ravel())


def float32_rows(values: npt.NDArray[Any]) -> str:
    """Rows of vectors in the nine digits that identify a float32: meshes hold no more (Q20)."""
    return ",\n    ".join(f"<{x:.9g}, {y:.9g}, {z:.9g}>" for x, y, z in values.tolist())


def integer_rows(values: npt.NDArray[Any]) -> str:
    return ",\n    ".join(f"<{a}, {b}, {c}>" for a, b, c in values.tolist())


def grey(bands: Sequence[float]) -> float:
    """POV-Ray's grey value of a colour (`RGBColour::greyscale`)."""
    return 0.297 * bands[0] + 0.589 * bands[1] + 0.114 * bands[2]
