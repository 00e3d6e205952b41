"""Sweep axes: where they point, the product of their values, and the names of the cases."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from equilux_scenes.checks import is_number
from equilux_scenes.errors import hint, number_text, shortened
from equilux_scenes.model import Part, Scene
from equilux_scenes.reading import Path
from equilux_scenes.shown import owner, shown
from equilux_scenes.yaml_tree import ListNode, MapNode, Node, Place, ScalarNode

CASE_NAME_LENGTH = 200
"""Bytes that a case's name may have: it names a folder, and file systems allow 255."""

NOT_SWEPT = ("equilux", "name", "about", "sweep", "expect")
"""Keys that do not determine a picture."""


class SweepError(ValueError):
    """An axis that cannot be swept; `place` is what is wrong."""

    def __init__(self, place: Place, message: str) -> None:
        super().__init__(message)
        self.place = place
        self.message = message


@dataclass(frozen=True)
class Axis:
    """One axis: its name, the path of the value that it replaces, and the values as nodes."""

    name: str
    path: Path
    values: tuple[Node, ...]


@dataclass(frozen=True)
class Pick:
    """One value of one axis."""

    axis: Axis
    index: int

    @property
    def value(self) -> Node:
        """The node that takes the swept value's place."""
        return self.axis.values[self.index]

    @property
    def label(self) -> str:
        """`exponent=1000`; values that are no numbers by their index: `material=#0`."""
        node = self.value
        shows_number = isinstance(node, ScalarNode) and is_number(node)
        return f"{self.axis.name}={number_text(node.value) if shows_number else f'#{self.index}'}"  # type: ignore[union-attr,arg-type]


def case_name(scene: str, picks: tuple[Pick, ...]) -> str:
    """`name`, or `name[a=1,b=2]`."""
    return f"{scene}[{','.join(pick.label for pick in picks)}]" if picks else scene


def axes_of(root: MapNode, part_at: Mapping[Path, type[Part]]) -> tuple[list[Axis], list[SweepError]]:
    """The axes whose path leads somewhere, in file order, and what is wrong with the others.

    part_at: path → kind of part, so that a key that is not written can be told from one that does not exist.
    """
    axes: list[Axis] = []
    errors: list[SweepError] = []
    for name, path_node, values in _well_formed(root):
        try:
            path = _resolved(root, path_node, part_at)
            for other in axes:
                if _overlap(path, other.path):
                    raise _no_such(path_node, f"a value that axis '{shortened(other.name)}' does not sweep")
            axes.append(Axis(name, path, values))
            errors.extend(_repeated(axes[-1]))
        except SweepError as failed:
            errors.append(failed)
    return axes, errors


def combinations(axes: list[Axis]) -> Iterator[tuple[Pick, ...]]:
    """One value of each axis, the last axis varying fastest."""
    return itertools.product(*([Pick(axis, index) for index in range(len(axis.values))] for axis in axes))


def count(axes: list[Axis]) -> int:
    """How many combinations there are."""
    return math.prod(len(axis.values) for axis in axes)


def swept(root: MapNode, picks: tuple[Pick, ...]) -> MapNode:
    """The spec with the picked values in place; everything else is shared with `root`."""
    for pick in picks:
        replaced = _replaced(root, pick.axis.path, pick.value)
        assert isinstance(replaced, MapNode)
        root = replaced
    return root


def _well_formed(root: MapNode) -> Iterator[tuple[str, ScalarNode, tuple[Node, ...]]]:
    sweep = root.entries.get("sweep")
    for name, axis in sweep.entries.items() if isinstance(sweep, MapNode) else ():
        path = axis.entries.get("path") if isinstance(axis, MapNode) else None
        values = axis.entries.get("values") if isinstance(axis, MapNode) else None
        if isinstance(path, ScalarNode) and isinstance(path.value, str):
            yield name, path, values.items if isinstance(values, ListNode) else ()


def _overlap(a: Path, b: Path) -> bool:
    length = min(len(a), len(b))
    return a[:length] == b[:length]


def _repeated(axis: Axis) -> Iterator[SweepError]:
    labels: dict[str, Place] = {}
    for index, node in enumerate(axis.values):
        label = Pick(axis, index).label
        if label in labels:
            first = labels[label]
            what = f"value of sweep axis '{shortened(axis.name)}': got {shown(node)}"
            yield SweepError(node.place, f"{what}, allowed each value once (first given at {first.line}:{first.column})")
        labels.setdefault(label, node.place)


def _resolved(root: MapNode, path_node: ScalarNode, part_at: Mapping[Path, type[Part]]) -> Path:
    """The written path as keys and positions. The last key may be one that its part has and the spec leaves at its default."""
    keys = path_node.text.split(".")
    if keys[0] in NOT_SWEPT:
        raise _no_such(path_node, f"a path to something that determines the picture ('{keys[0]}' does not)")
    node: Node = root
    path: Path = ()
    for number, key in enumerate(keys):
        last = number == len(keys) - 1
        if isinstance(node, MapNode) and key in node.entries:
            node, path = node.entries[key], (*path, key)
        elif isinstance(node, MapNode) and key in _fields(path, part_at):
            if not last:
                raise _no_such(path_node, f"the path of a value that is written out ('{key}' of {owner(path)} is not)")
            path = (*path, key)
        elif isinstance(node, ListNode) and key.isascii() and key.isdigit() and len(key) <= 9 and int(key) < len(node.items):
            node, path = node.items[int(key)], (*path, int(key))
        else:
            raise _no_such(path_node, _next_keys(node, key, path, part_at))
    return path


def _fields(path: Path, part_at: Mapping[Path, type[Part]]) -> Mapping[str, object]:
    cls = part_at.get(path, Scene if not path else None)
    return cls.model_fields if cls is not None else {}


def _no_such(path_node: ScalarNode, allowed: str) -> SweepError:
    return SweepError(path_node.place, f"path of a sweep axis: got {shown(path_node)}, allowed {allowed}")


def _next_keys(node: Node, key: str, path: Path, part_at: Mapping[Path, type[Part]]) -> str:
    where = f"after '{'.'.join(map(str, path))}'" if path else "at the start"
    if isinstance(node, ListNode):
        last = len(node.items) - 1
        return f"a position 0 to {last} {where}, not '{shortened(key)}'" if node.items else f"nothing {where}, an empty list"
    if isinstance(node, ScalarNode):
        return f"nothing {where}, which is {shown(node)}"
    known = dict.fromkeys([*node.entries, *_fields(path, part_at)])
    return f"one of {', '.join(known)} {where}, not '{shortened(key)}'{hint(key, known)}"


def _replaced(node: Node, path: Path, value: Node) -> Node:
    if not path:
        return value
    key, *rest = path
    if isinstance(node, ListNode) and isinstance(key, int):
        items = (*node.items[:key], _replaced(node.items[key], tuple(rest), value), *node.items[key + 1 :])
        return ListNode(node.place, items, node.size)
    assert isinstance(node, MapNode)
    assert isinstance(key, str)
    child = _replaced(node.entries[key], tuple(rest), value) if key in node.entries else value
    return MapNode(node.place, {**node.entries, key: child}, {key: value.place, **node.keys}, node.size)
