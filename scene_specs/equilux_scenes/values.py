"""The kinds of value that a spec is made of, each with the words that an error message and the JSON Schema use for it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema


@dataclass(frozen=True)
class Allowed:
    """What a field takes, in words; `inside` says it for what lies one, two … levels deeper."""

    text: str
    inside: tuple[str, ...] = ()

    def at_depth(self, depth: int) -> str:
        """The words for a value `depth` levels inside the field's own."""
        return (self.text, *self.inside)[min(depth, len(self.inside))]


class OnlyIn:
    """Marks a term that only some lighting models have; in a scene of any other model it must keep its default."""

    def __init__(self, *models: str) -> None:
        self.models = models

    def __str__(self) -> str:
        return " or ".join(f"'{model}'" for model in self.models)


class OrFrom:
    """Marks bands that a light may leave out, because one of these keys determines them instead."""

    def __init__(self, *keys: str) -> None:
        self.keys = keys


def _as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _three_bands(value: Any) -> Any:
    """One number stands for three equal bands."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return (value, value, value)
    return _as_tuple(value)


def _not_zero(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(vector):
        raise ValueError("zero")
    return vector


def _all_not_zero(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    if not all(vector):
        raise ValueError("zero")
    return vector


def _exactly(count: int, item: dict[str, Any]) -> dict[str, Any]:
    """JSON Schema of a list of so many items."""
    return {"type": "array", "items": item, "minItems": count, "maxItems": count}


def _number_or_three(**number: Any) -> WithJsonSchema:
    one = {"type": "number", **number}
    return WithJsonSchema({"anyOf": [one, _exactly(3, one)]})


_NUMBER = {"type": "number"}
_THREE_NUMBERS = WithJsonSchema(_exactly(3, _NUMBER))


Number = Annotated[float, Allowed("a finite number")]
NonNegative = Annotated[float, Field(ge=0), Allowed("a number ≥ 0")]
Positive = Annotated[float, Field(gt=0), Allowed("a number > 0")]
Fraction = Annotated[float, Field(ge=0, le=1), Allowed("a number in [0, 1]")]
Count = Annotated[int, Field(ge=1), Allowed("an integer ≥ 1")]
Text = Annotated[str, Allowed("text")]

Words = Annotated[tuple[str, ...], BeforeValidator(_as_tuple), Allowed("a list of words", ("a word",))]
"""Several words."""

Vector3 = Annotated[
    tuple[float, float, float], BeforeValidator(_as_tuple), Allowed("three numbers", ("a finite number",)), _THREE_NUMBERS
]
"""Three world coordinates, metres."""

Direction = Annotated[
    tuple[float, float, float],
    BeforeValidator(_as_tuple),
    AfterValidator(_not_zero),
    Allowed("three numbers, not all 0", ("a finite number",)),
    _THREE_NUMBERS,
]
"""A direction of any length but 0."""

Factors = Annotated[
    tuple[float, float, float],
    BeforeValidator(_three_bands),
    AfterValidator(_all_not_zero),
    Allowed("one number or three, none of them 0", ("a finite number other than 0",)),
    _number_or_three(),
]
"""Scale factors along x, y and z; one number stands for three equal ones."""

Band = Annotated[float, Field(ge=0)]
Bands = Annotated[
    tuple[Band, Band, Band],
    BeforeValidator(_three_bands),
    Allowed("one number ≥ 0 or three", ("a number ≥ 0",)),
    _number_or_three(minimum=0),
]
"""One radiometric quantity in three linear bands; one number stands for three equal ones."""


def _one_of_two(value: float) -> float:
    if value not in (683.002, 684.0):
        raise ValueError("neither")
    return value


LuminousEfficacy = Annotated[
    float,
    AfterValidator(_one_of_two),
    Allowed("683.002 (the SI's) or 684 (the lecture's)"),
    WithJsonSchema({"type": "number", "enum": [683.002, 684]}),
]
"""K_m, lm/W."""


Wavelength = Annotated[float, Field(ge=1e-3, le=1e9), Allowed("a wavelength of 0.001 to 1e9 nm")]
Temperature = Annotated[float, Field(ge=1, le=1e9), Allowed("a temperature of 1 to 1e9 K")]


def _ascending(samples: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(a[0] >= b[0] for a, b in pairwise(samples)):
        raise ValueError("not ascending")
    return samples


Samples = Annotated[
    tuple[Annotated[tuple[Wavelength, Band], BeforeValidator(_as_tuple)], ...],
    BeforeValidator(_as_tuple),
    Field(min_length=2),
    AfterValidator(_ascending),
    Allowed(
        "a list of at least two pairs [nm, value ≥ 0], the wavelengths ascending",
        ("a pair [nm, value ≥ 0]", "a wavelength of 0.001 to 1e9 nm, then a value ≥ 0"),
    ),
    WithJsonSchema({"type": "array", "items": _exactly(2, {"type": "number", "minimum": 0}), "minItems": 2}),
]
"""A sampled spectrum: wavelength in nm, value per nm."""

Interval = Annotated[tuple[Wavelength, Wavelength], BeforeValidator(_as_tuple)]
Intervals = Annotated[
    tuple[Interval, Interval, Interval],
    BeforeValidator(_as_tuple),
    Allowed("three intervals [from, to] in nm", ("two wavelengths [from, to] in nm", "a wavelength of 0.001 to 1e9 nm")),
    WithJsonSchema(_exactly(3, _exactly(2, {"type": "number", "minimum": 1e-3, "maximum": 1e9}))),
]
"""Three intervals of wavelengths, nm."""

Points = Annotated[
    tuple[Vector3, ...],
    BeforeValidator(_as_tuple),
    Allowed("a list of points, three numbers each", ("three numbers", "a finite number")),
]
Directions = Annotated[
    tuple[Direction, ...],
    BeforeValidator(_as_tuple),
    Allowed("a list of directions, three numbers each", ("three numbers, not all 0", "a finite number")),
]
Index = Annotated[int, Field(ge=0)]
Triangles = Annotated[
    tuple[Annotated[tuple[Index, Index, Index], BeforeValidator(_as_tuple)], ...],
    BeforeValidator(_as_tuple),
    Field(min_length=1),
    Allowed("a list of at least one triangle, three vertex numbers each", ("three vertex numbers", "an integer ≥ 0")),
    WithJsonSchema({"type": "array", "items": _exactly(3, {"type": "integer", "minimum": 0}), "minItems": 1}),
]
Row4 = Annotated[tuple[float, float, float, float], BeforeValidator(_as_tuple)]
Matrix4 = Annotated[
    tuple[Row4, Row4, Row4, Row4],
    BeforeValidator(_as_tuple),
    Allowed("four rows of four numbers", ("four numbers", "a finite number")),
    WithJsonSchema(_exactly(4, _exactly(4, _NUMBER))),
]
"""4×4, row by row; acts on column vectors."""
