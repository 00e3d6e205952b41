"""YAML text → tree of located nodes.

Built from the parser's events instead of its composer, because only the events tell where an alias stands, and because nesting,
aliases and the size of what they expand to can be bounded while reading, before anything is built.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    CollectionStartEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
)

from equilux_scenes.errors import SpecError, SpecErrors, shortened
from equilux_scenes.limits import Limits, exceeded
from equilux_scenes.yaml_scalars import Scalar, resolve

# YAML 1.2 §5.1, c-printable, without the byte order mark inside the text
_NOT_PRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")
# no tag is allowed anyway, and the parser takes quadratic time over a long one
_LONG_TAG = re.compile(r"!\S{1000}")
_LINE_END = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True)
class Place:
    """Where something stands: line and column from 1, and the character offsets [start, end) in the text."""

    line: int
    column: int
    start: int = 0
    end: int = 0


@dataclass(frozen=True)
class ScalarNode:
    """One value; `text` is how it was written."""

    place: Place
    value: Scalar
    text: str
    quoted: bool = False
    size: int = 1


@dataclass(frozen=True)
class ListNode:
    place: Place
    items: tuple[Node, ...]
    size: int = 1


@dataclass(frozen=True)
class MapNode:
    """`keys` gives the place of each key. Of a duplicate key the first is kept (the second is an error already)."""

    place: Place
    entries: dict[str, Node]
    keys: dict[str, Place]
    size: int = 1


Node = ScalarNode | ListNode | MapNode


@dataclass
class YamlText:
    """One text and where its lines begin."""

    file: str
    text: str
    line_starts: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.line_starts = [0, *(match.end() for match in _LINE_END.finditer(self.text))]

    def place(self, start: int, end: int | None = None) -> Place:
        """The place of the character at offset `start`."""
        line = bisect_right(self.line_starts, start)
        return Place(line, start - self.line_starts[line - 1] + 1, start, start if end is None else end)

    def lines(self) -> list[str]:
        """The text line by line, without line ends."""
        return _LINE_END.split(self.text)

    def error(self, start: int, message: str) -> SpecError:
        """An error at the character at offset `start`."""
        place = self.place(min(max(start, 0), len(self.text)))
        return SpecError(self.file, place.line, place.column, message)


@dataclass(frozen=True)
class YamlTree:
    """A parsed text: its root, and the errors that did not keep it from being read."""

    source: YamlText
    root: Node
    errors: tuple[SpecError, ...]


def parse(text: str, file: str, limits: Limits) -> YamlTree:
    """Read one YAML 1.2 document.

    Raises SpecErrors when the text is not YAML, is empty, holds several documents, or meets the limit `nesting`, `nodes` or
    `aliases`.
    """
    source = YamlText(file, text.removeprefix("\ufeff"))
    if bad := _NOT_PRINTABLE.search(source.text):
        message = f"character U+{ord(bad.group()):04X}, allowed printable text (is this a YAML file?)"
        raise SpecErrors([source.error(bad.start(), message)])
    if tag := _LONG_TAG.search(source.text):
        raise SpecErrors([source.error(tag.start(), f"YAML tag '{shortened(tag.group())}', allowed no tags")])
    builder = _Builder(source, limits)
    try:
        builder.read(_events(source))
    except SpecErrors as stopped:
        raise SpecErrors([*builder.errors, *stopped.errors]) from None
    if builder.root is None:
        raise SpecErrors([SpecError(file, 1, 1, "empty file, allowed a scene spec (it begins with 'equilux: 1')")])
    return YamlTree(source, builder.root, tuple(builder.errors))


def _events(source: YamlText) -> Iterator[Event]:
    """The parser's events; whatever the parser raises becomes a located error."""
    try:
        yield from YAML(typ="safe", pure=True).parse(source.text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        what = ", ".join(part.strip() for part in (error.context, error.problem) if part)
        raise SpecErrors([source.error(mark.index if mark else 0, f"not YAML: {shortened_problem(what)}")]) from None
    except YAMLError as error:
        raise SpecErrors([source.error(0, f"not YAML: {shortened_problem(str(error))}")]) from None
    except (ValueError, IndexError, AssertionError, AttributeError, TypeError, KeyError, OverflowError) as error:
        # ruamel's scanner lets a few of these out on malformed directives and escapes (\UFFFFFFFF)
        raise SpecErrors([source.error(0, f"not YAML: {shortened_problem(f'{type(error).__name__}: {error}')}")]) from None


def shortened_problem(text: str) -> str:
    """A parser's own words on one line, its multi-line advice dropped."""
    return " ".join(text.split())[:160]


@dataclass
class _Open:
    """A collection that is being read."""

    event: CollectionStartEvent
    items: list[Node] = field(default_factory=list)  # a mapping's keys and values alternate
    size: int = 1


class _Builder:
    """Events → nodes, with an explicit stack: no recursion, so no depth can exhaust Python's."""

    def __init__(self, source: YamlText, limits: Limits) -> None:
        self.source = source
        self.limits = limits
        self.root: Node | None = None
        self.errors: list[SpecError] = []
        self._stack: list[_Open] = []
        self._anchors: dict[str, Node | None] = {}  # None: still being read
        self._aliases = 0
        self._nodes = 0
        self._documents = 0

    def read(self, events: Iterator[Event]) -> None:
        for event in events:
            if isinstance(event, DocumentStartEvent):
                self._start_document(event)
            elif isinstance(event, AliasEvent):
                self._alias(event)
            elif isinstance(event, ScalarEvent):
                self._scalar(event)
            elif isinstance(event, CollectionStartEvent):
                self._open(event)
            elif isinstance(event, SequenceEndEvent | MappingEndEvent):
                self._close(event)

    def _stop(self, start: int, message: str) -> None:
        raise SpecErrors([self.source.error(start, message)])

    def _error(self, start: int, message: str) -> None:
        self.errors.append(self.source.error(start, message))

    def _start_document(self, event: DocumentStartEvent) -> None:
        self._documents += 1
        if self._documents > 1:
            self._stop(event.start_mark.index, "second YAML document, allowed one scene per file")
        if event.version is not None and tuple(event.version) != (1, 2):
            version = ".".join(str(part) for part in event.version)
            self._error(event.start_mark.index, f"YAML version, got {version}, allowed 1.2")

    def _count(self, start: int, size: int) -> None:
        self._nodes += size
        if self._nodes > self.limits.nodes:
            self._stop(start, exceeded("nodes", self._nodes, self.limits.nodes, "values in the file, aliases expanded"))

    def _begin(self, event: Any) -> None:
        """Checks shared by scalars and collections."""
        start = event.start_mark.index
        if event.tag is not None:
            self._error(start, f"YAML tag '{shortened(str(event.tag))}', allowed no tags (values are typed by the spec)")
        if event.anchor is not None:
            self._anchors[event.anchor] = None
        self._count(start, 1)

    def _alias(self, event: AliasEvent) -> None:
        start = event.start_mark.index
        self._aliases += 1
        if self._aliases > self.limits.aliases:
            self._stop(start, exceeded("aliases", self._aliases, self.limits.aliases, "aliases in the file"))
        if event.anchor not in self._anchors:
            self._stop(start, f"alias '*{shortened(event.anchor)}' to an anchor that is not defined before it")
        target = self._anchors[event.anchor]
        if target is None:
            self._stop(start, f"alias '*{shortened(event.anchor)}' inside the value that it names, allowed no recursion")
            return
        self._count(start, target.size)
        self._add(moved(target, self.source.place(start, event.end_mark.index)))

    def _scalar(self, event: ScalarEvent) -> None:
        self._begin(event)
        start, end = event.start_mark.index, event.end_mark.index
        quoted = event.style is not None
        node = ScalarNode(self.source.place(start, end), event.value if quoted else resolve(event.value), event.value, quoted)
        self._finish(event, node)

    def _open(self, event: CollectionStartEvent) -> None:
        self._begin(event)
        self._stack.append(_Open(event))
        if len(self._stack) > self.limits.nesting:
            what = "lists and mappings nested in each other"
            self._stop(event.start_mark.index, exceeded("nesting", len(self._stack), self.limits.nesting, what))

    def _close(self, event: SequenceEndEvent | MappingEndEvent) -> None:
        opened = self._stack.pop()
        place = self.source.place(opened.event.start_mark.index, event.end_mark.index)
        if isinstance(opened.event, MappingStartEvent):
            node: Node = self._mapping(opened, place)
        else:
            node = ListNode(place, tuple(opened.items), opened.size)
        self._finish(opened.event, node)

    def _mapping(self, opened: _Open, place: Place) -> MapNode:
        entries: dict[str, Node] = {}
        keys: dict[str, Place] = {}
        for key, value in zip(opened.items[::2], opened.items[1::2], strict=True):
            start = key.place.start
            if not isinstance(key, ScalarNode) or not isinstance(key.value, str):
                got = key.text if isinstance(key, ScalarNode) else "a collection"
                advice = " (write it in quotes)" if isinstance(key, ScalarNode) else ""
                self._error(start, f"key, got {shortened(got) or 'nothing'}, allowed text{advice}")
            elif key.value == "<<" and not key.quoted:
                self._error(start, "merge key '<<', allowed plain keys only (YAML 1.2 has no merge keys; repeat the values)")
            elif key.value in entries:
                first = keys[key.value]
                self._error(start, f"duplicate key '{shortened(key.value)}', first given at {first.line}:{first.column}")
            else:
                entries[key.value] = value
                keys[key.value] = key.place
        return MapNode(place, entries, keys, opened.size)

    def _finish(self, event: Any, node: Node) -> None:
        if event.anchor is not None:
            self._anchors[event.anchor] = node
        self._add(node)

    def _add(self, node: Node) -> None:
        if self._stack:
            self._stack[-1].items.append(node)
            self._stack[-1].size += node.size
        else:
            self.root = node


def moved(node: Node, place: Place) -> Node:
    """The same value standing at another place; what is inside it keeps its own places."""
    if isinstance(node, ScalarNode):
        return ScalarNode(place, node.value, node.text, node.quoted)
    if isinstance(node, ListNode):
        return ListNode(place, node.items, node.size)
    return MapNode(place, node.entries, node.keys, node.size)


def plain(node: Node) -> Any:
    """The node as Python values: dict, tuple, str, int, float, bool, None."""
    if isinstance(node, ScalarNode):
        return node.value
    if isinstance(node, ListNode):
        return tuple(plain(item) for item in node.items)
    return {key: plain(value) for key, value in node.entries.items()}


def walk(node: Node, path: Sequence[str | int]) -> tuple[Node, tuple[str | int, ...]]:
    """As far along `path` as there are nodes: the last one, and the part of the path that led there."""
    for done, key in enumerate(path):
        if isinstance(node, MapNode) and key in node.entries:
            node = node.entries[str(key)]
        elif isinstance(node, ListNode) and isinstance(key, int) and key < len(node.items):
            node = node.items[key]
        else:
            return node, tuple(path[:done])
    return node, tuple(path)
