"""Where things stand in a spec file, for annotations and failure texts: the scene's name and each expectation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

from equilux.results import ExpectationRecord
from equilux_scenes.errors import SpecErrors
from equilux_scenes.limits import Limits
from equilux_scenes.yaml_tree import ListNode, MapNode, Node, ScalarNode, parse

Position = tuple[int, int]
"""Line and column, from 1."""


@dataclass(frozen=True)
class Places:
    """name: of the scene's name. expectations: of each, by adapter, cause and when."""

    name: Position = (1, 1)
    expectations: Mapping[tuple[str, str, str | None], Position] = field(default_factory=dict)

    def of(self, expectation: ExpectationRecord) -> Position:
        """Of the expectation; of the scene's name where the file no longer holds it."""
        return self.expectations.get((expectation.adapter, expectation.cause, expectation.when), self.name)


def places_in(path: Path | None) -> Places:
    """Of a spec file; line 1 where it cannot be read any more, for a place is a courtesy and no result."""
    if path is None:
        return Places()
    try:
        return _places(path, path.read_text("utf-8"))
    except (OSError, ValueError):  # SpecErrors and UnicodeDecodeError are ValueErrors
        return Places()


@lru_cache(maxsize=64)
def _places(path: Path, text: str) -> Places:
    try:
        root = parse(text, str(path), Limits()).root
    except SpecErrors:
        return Places()
    if not isinstance(root, MapNode):
        return Places()
    name, expect = root.entries.get("name"), root.entries.get("expect")
    items = expect.items if isinstance(expect, ListNode) else ()
    return Places(
        (name.place.line, name.place.column) if name is not None else (1, 1),
        {
            (str(_word(item, "adapter")), str(_word(item, "cause")), _word(item, "when")): (item.place.line, item.place.column)
            for item in reversed(items)  # of two alike the first is meant
            if isinstance(item, MapNode)
        },
    )


def _word(item: MapNode, key: str) -> str | None:
    node: Node | None = item.entries.get(key)
    return str(node.value) if isinstance(node, ScalarNode) and node.value is not None else None
