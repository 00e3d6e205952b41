"""Changing the `expect:` of a spec's text and nothing else: comments, order and layout stay.

The text is edited at the places of its nodes, one change at a time, and read again after each. What the result means is checked
by whoever asked for it (`propose.py`): a layout that is not understood here must end in a refusal, never in another scene.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from equilux_scenes.errors import one_line
from equilux_scenes.limits import Limits
from equilux_scenes.yaml_scalars import resolve
from equilux_scenes.yaml_tree import ListNode, MapNode, Node, ScalarNode, parse

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*( [A-Za-z0-9_.<>=!+-]+)*\Z")
COMMENT_WIDTH = 130


class CannotEdit(Exception):
    """The text is laid out in a way that is not edited here; the message says which."""


@dataclass(frozen=True)
class Pin:
    """An expectation to be written. comment: its reason, one line, without the #."""

    adapter: str
    cause: str
    when: str | None = None
    comment: str = ""


@dataclass(frozen=True)
class Changes:
    """What to do with the expectations of a scene. whens: position → the new `when` (None: none). removed: positions."""

    added: tuple[Pin, ...] = ()
    whens: Mapping[int, str | None] = field(default_factory=dict)
    removed: tuple[int, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.added or self.whens or self.removed)


def edited(text: str, changes: Changes, limits: Limits | None = None) -> str:
    """The spec's text with these changes. Raises CannotEdit."""
    body = text.removeprefix("\ufeff")
    mark = text[: len(text) - len(body)]
    limits = limits or Limits()
    for position, when in sorted(changes.whens.items()):
        body = _Spec(body, limits).with_when(position, when)
    for pin in changes.added:
        body = _Spec(body, limits).with_pin(pin)
    for position in sorted(changes.removed, reverse=True):
        body = _Spec(body, limits).without(position)
    return mark + body


class _Spec:
    """One state of the text."""

    def __init__(self, text: str, limits: Limits) -> None:
        tree = parse(text, "spec", limits)
        if tree.errors or not isinstance(tree.root, MapNode):
            raise CannotEdit("the spec is not read without errors")
        self.text, self.source, self.root = text, tree.source, tree.root
        self.newline = "\r\n" if "\r\n" in text else "\n"
        self.flow_root = text[self.root.place.start] == "{"
        expect = self.root.entries.get("expect")
        if expect is not None and not (isinstance(expect, ListNode) and text[expect.place.start] in "[-"):
            raise CannotEdit("`expect` is written as an alias or with an anchor")
        self.expect = expect

    # --- adding -------------------------------------------------------------------------------------------------------

    def with_pin(self, pin: Pin) -> str:
        if self.expect is None:
            return self._with_first(pin)
        items = self.expect.items
        if self._is_flow(self.expect):
            return self._in_flow_list(pin)
        column = self.expect.place.column - 1
        _, end = self._lines(self._line_of(self._last(items[-1])))
        return self._inserted_lines(end, [*_comment(pin, column), f"{' ' * column}- {_flow_map(pin)}"])

    def _with_first(self, pin: Pin) -> str:
        if self.flow_root:
            quoted = '"' if self._is_json() else ""
            last = max(self._last(node) for node in self.root.entries.values()) + 1
            item = _json_map(pin) if quoted else _flow_map(pin)
            return f"{self.text[:last]}, {quoted}expect{quoted}: [{item}]{self.text[last:]}"
        column = self.root.place.column - 1
        lines = [f"{' ' * column}expect:", *_comment(pin, column + 2), f"{' ' * column}  - {_flow_map(pin)}"]
        return self._inserted_lines(self._end_of_document(), lines)

    def _in_flow_list(self, pin: Pin) -> str:
        assert self.expect is not None
        item = _json_map(pin) if self._is_json() else _flow_map(pin)
        if self.expect.items:
            at = self._last(self.expect.items[-1]) + 1
            text = f"{self.text[:at]}, {item}{self.text[at:]}"
        else:
            at = self.expect.place.start + 1
            text = f"{self.text[:at]}{item}{self.text[at:]}"
        if self.flow_root or not pin.comment:
            return text
        key = self.root.keys["expect"]
        above, _ = self._lines(key.line)
        return text[:above] + "".join(line + self.newline for line in _comment(pin, key.column - 1)) + text[above:]

    def _inserted_lines(self, at: int, lines: Sequence[str]) -> str:
        """Whole lines at the offset of a line's beginning, or at the end of a text whose last line may not be ended."""
        ended = at == 0 or self.text[at - 1] in "\r\n"
        new = self.newline.join(lines)
        return self.text[:at] + (new + self.newline if ended else self.newline + new) + self.text[at:]

    def _end_of_document(self) -> int:
        """Where a new key of the root goes: at the end, before an explicit document end."""
        after = self.source.place(max(self._last(node) for node in self.root.entries.values())).line
        for number, line in enumerate(self.source.lines()[after:], after + 1):
            if re.match(r"\.\.\.(\s|\Z)", line):
                return self.source.line_starts[number - 1]
        return len(self.text)

    # --- a new when ---------------------------------------------------------------------------------------------------

    def with_when(self, position: int, when: str | None) -> str:
        item = self._item(position)
        node = item.entries.get("when")
        if node is not None and when is not None:
            return self._replaced(node.place.start, self._last(node) + 1, _scalar(when, quoted=self._is_json()))
        if node is not None:
            return self._without_when(item, node)
        if when is None:
            return self.text
        end = max(self._last(value) for value in item.entries.values()) + 1
        if self._is_flow(item):
            name = '"when"' if self._is_json() else "when"
            return self._replaced(end, end, f", {name}: {_scalar(when, quoted=self._is_json())}")
        _, line_end = self._lines(self._line_of(end - 1))
        column = item.place.column - 1
        return self._inserted_lines(line_end, [f"{' ' * column}when: {_scalar(when)}"])

    def _without_when(self, item: MapNode, node: Node) -> str:
        key = item.keys["when"]
        if self._is_flow(item):
            return self._without_span(key.start, self._last(node) + 1)
        start, _ = self._lines(key.line)
        if self.text[start : key.start].strip():
            raise CannotEdit("`when` stands on the line of the item's dash")
        return self._without_lines(key.line, self._line_of(self._last(node)))

    # --- removing -----------------------------------------------------------------------------------------------------

    def without(self, position: int) -> str:
        item = self._item(position)
        assert self.expect is not None
        if len(self.expect.items) == 1:
            return self._without_expect()
        first, last = item.place.line, self._line_of(self._last(item))
        if not self._is_flow(self.expect):
            first = self.source.place(self._dash(item)).line
        elif not self._alone(item, first, last):
            return self._without_span(item.place.start, self._last(item) + 1)
        return self._without_lines(first - self._own_comment(position, first), last)

    def _own_comment(self, position: int, first: int) -> int:
        """How many comment lines above an item are about it alone: none where the next item has no comment of its own and so may
        rely on them."""
        assert self.expect is not None
        lines, above = self.source.lines(), 0
        while first - above > 1 and lines[first - above - 2].lstrip().startswith("#"):
            above += 1
        if position + 1 < len(self.expect.items):
            following = self.expect.items[position + 1].place.line
            if not lines[following - 2].lstrip().startswith("#") and "#" not in lines[following - 1]:
                return 0
        return above

    def _without_expect(self) -> str:
        assert self.expect is not None
        key, last = self.root.keys["expect"], max([self._last(item) for item in self.expect.items])
        if self._is_flow(self.expect):
            last = self.expect.place.end - 1
        if self.flow_root:
            return self._without_span(key.start, last + 1)
        return self._without_lines(key.line, self._line_of(last))

    def _alone(self, item: Node, first: int, last: int) -> bool:
        """Whether nothing but its comma and a comment share the lines of an item."""
        start, _ = self._lines(first)
        _, end = self._lines(last)
        rest = self.text[self._last(item) + 1 : end]
        return not self.text[start : item.place.start].strip() and bool(re.fullmatch(r"\s*,?\s*(#[^\r\n]*)?\s*", rest))

    def _without_span(self, start: int, end: int) -> str:
        """One member of a flow collection, with the comma that it leaves behind."""
        if after := re.match(r"\s*,[ \t]*", self.text[end:]):
            return self._replaced(start, end + after.end(), "")
        if before := re.search(r",\s*\Z", self.text[:start]):
            return self._replaced(before.start(), end, "")
        return self._replaced(start, end, "")

    def _without_lines(self, first: int, last: int) -> str:
        start, _ = self._lines(first)
        _, end = self._lines(last)
        if end >= len(self.text):  # no blank lines at the end of the file
            kept = self.text[:start].rstrip("\r\n \t")
            return kept + (self.newline if kept and self.text.endswith(("\r", "\n")) else "")
        return self._replaced(start, end, "")

    # --- places -------------------------------------------------------------------------------------------------------

    def _item(self, position: int) -> MapNode:
        item = self.expect.items[position] if self.expect is not None and position < len(self.expect.items) else None
        if not isinstance(item, MapNode) or self.text[item.place.start] in "*&":
            raise CannotEdit(f"expectation {position} is written with an alias or an anchor")
        return item

    def _is_flow(self, node: Node) -> bool:
        return self.text[node.place.start] in "[{"

    def _is_json(self) -> bool:
        first = min((place.start for place in self.root.keys.values()), default=0)
        return self.flow_root and self.text[first] == '"'

    def _dash(self, item: Node) -> int:
        before = re.search(r"-\s*\Z", self.text[: item.place.start])
        if before is None:
            raise CannotEdit("something stands between an item and its dash")
        return before.start()

    def _last(self, node: Node) -> int:
        """Offset of the last character of a node; a block collection's own end is where the next token begins."""
        place = node.place
        children = () if isinstance(node, ScalarNode) else node.items if isinstance(node, ListNode) else node.entries.values()
        if self.text[place.start] in "[{*" or not children:
            return place.start + max(len(self.text[place.start : place.end].rstrip()), 1) - 1
        return max(self._last(child) for child in children)

    def _line_of(self, offset: int) -> int:
        return self.source.place(offset).line

    def _lines(self, number: int) -> tuple[int, int]:
        """Offsets of a line's beginning and of the next one's."""
        starts = self.source.line_starts
        return starts[number - 1], starts[number] if number < len(starts) else len(self.text)

    def _replaced(self, start: int, end: int, new: str) -> str:
        return self.text[:start] + new + self.text[end:]


def _comment(pin: Pin, column: int) -> list[str]:
    words = one_line(pin.comment).strip()
    room = COMMENT_WIDTH - column - 2
    words = words if len(words) <= room else words[: room - 1] + "…"
    return [f"{' ' * column}# {words}"] if words else []


def _flow_map(pin: Pin) -> str:
    when = f", when: {_scalar(pin.when)}" if pin.when is not None else ""
    return f"{{adapter: {_scalar(pin.adapter)}, cause: {_scalar(pin.cause)}{when}}}"


def _json_map(pin: Pin) -> str:
    when = {"when": pin.when} if pin.when is not None else {}
    return json.dumps({"adapter": pin.adapter, "cause": pin.cause, **when}, ensure_ascii=False)


def _scalar(text: str, *, quoted: bool = False) -> str:
    """A string as YAML: plain where that reads back as the same string, else in double quotes."""
    plain = not quoted and _PLAIN.match(text) is not None and resolve(text) == text
    return text if plain else json.dumps(text, ensure_ascii=False)
