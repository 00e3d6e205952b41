"""What an axis is: one quantity of a scene, pushed outward from a benign value, with all else compensated."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from equilux.adapter import Case
from equilux_scenes.loader import load_scene_text

Spec = dict[str, Any]
"""A scene spec as plain data (contracts §1)."""


@dataclass(frozen=True)
class Axis:
    """One quantity, pushed decade by decade.

    scene: (value, lighting model) → spec without name and version. benign: the value at which every renderer must hold. down, up:
    the values outward from it, the nearest first; `down` is empty where only one direction is pushed. models: the lighting models
    that the scene can be written in, in order; a renderer is measured in the first one that it can express. ends: the largest
    value that a model knows, where it is not the axis's. unit: of the value, empty for a pure number. about: what is pushed, and
    how the rest is compensated. watch: what is expected to break, and why.
    """

    name: str
    title: str
    unit: str
    benign: float
    down: tuple[float, ...]
    up: tuple[float, ...]
    scene: Callable[[float, str], Spec]
    about: str
    watch: str
    models: tuple[str, ...] = ("phong", "opengl", "reflection-equation")
    ends: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def values(self) -> tuple[float, ...]:
        """All values, as they stand along the axis: the farthest of `down` first, the farthest of `up` last."""
        return (*reversed(self.down), self.benign, *self.up)

    def values_in(self, model: str) -> tuple[float, ...]:
        """The values that the model has a scene for."""
        return tuple(value for value in self.values if value <= self.ends.get(model, value))

    def case_name(self, value: float, model: str) -> str:
        """`scale-1e-06`; with the model where it is not the axis's first."""
        text = shown(value).replace(".", "p").replace("+", "")
        return f"{self.name}-{text}" + ("" if model == self.models[0] else f"-{model}")

    def text(self, value: float, model: str) -> str:
        """The scene file: YAML whose values are written as JSON."""
        spec = self.scene(value, model)
        unit = f" {self.unit}" if self.unit else ""
        head = {
            "equilux": 1,
            "name": self.case_name(value, model),
            "about": f"{self.title} = {shown(value)}{unit}.",
            "model": model,
        }
        return "".join(f"{key}: {json.dumps(part, ensure_ascii=False)}\n" for key, part in (head | spec).items())

    def case(self, value: float, model: str) -> Case:
        """The case to render. Raises SpecErrors if the axis writes a scene that is none (a fault of the axis)."""
        (case,) = load_scene_text(self.text(value, model), self.case_name(value, model)).cases
        return case


def decades(first: int, last: int) -> tuple[float, ...]:
    """10^first, …, 10^last, one per decade, each the double nearest to it."""
    step = 1 if last >= first else -1
    return tuple(float(f"1e{power}") for power in range(first, last + step, step))


def shown(value: float) -> str:
    """Shortest digits that give the value back: '1e-06', '179.99', '30'."""
    text = repr(float(value))
    return text.removesuffix(".0")


def by_name(axes: tuple[Axis, ...]) -> Mapping[str, Axis]:
    return {axis.name: axis for axis in axes}
