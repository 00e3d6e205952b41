"""How checks are declared: each names the parts it is about and the fields that it needs, and yields what is wrong.

A check runs as soon as the fields that it needs are valid, whatever else is wrong with the part.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from types import SimpleNamespace

from equilux_scenes.limits import Limits
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.meshes import MeshStore
from equilux_scenes.model import Part
from equilux_scenes.units import Units
from equilux_scenes.yaml_tree import MapNode, Place


@dataclass
class Context:
    """What checks may look at besides the part itself."""

    limits: Limits
    meshes: MeshStore
    model: str | None = None
    units: Units = field(default_factory=Units)
    mesh_at: dict[int, tuple[MapNode, TriangleMesh]] = field(default_factory=dict)
    """id of an object's node → the node, kept so that the id stays its own, and its mesh."""


@dataclass(frozen=True)
class Problem:
    """Something wrong at `path` inside the part: what is allowed there, or a whole `message`. A warning is no error."""

    path: tuple[str | int, ...]
    allowed: str = ""
    note: str = ""
    message: str | None = None
    place: Place | None = None
    warning: bool = False


Run = Callable[[SimpleNamespace, MapNode, Context], Iterator[Problem]]


@dataclass(frozen=True)
class Check:
    """A check of one or several kinds of part."""

    parts: tuple[type[Part], ...]
    needs: tuple[str, ...]
    run: Run


_CHECKS: list[Check] = []


def check(*parts: type[Part], needs: tuple[str, ...] = ()) -> Callable[[Run], Run]:
    """Registers a check of these kinds of part, to be run as soon as the fields it needs are valid."""

    def register(run: Run) -> Run:
        _CHECKS.append(Check(parts, needs, run))
        return run

    return register


def checks_of(cls: type[Part]) -> Iterator[Check]:
    """The checks that apply to a kind of part."""
    return (check for check in _CHECKS if issubclass(cls, check.parts))
