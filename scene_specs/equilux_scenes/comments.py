"""The comment that stands beside a list item: where a spec gives the reason for an expectation."""

from __future__ import annotations

import bisect
from collections.abc import Iterator

from equilux_scenes.yaml_tree import ListNode, MapNode, Node, ScalarNode, YamlText


def comments_beside(source: YamlText, items: ListNode) -> tuple[str | None, ...]:
    """Per item, the comment lines directly above it and the comments on its own lines, joined; None where there are none."""
    lines = source.lines()
    found: list[str | None] = []
    for number, item in enumerate(items.items):
        first = item.place.line
        last = source.place(max(_last_character(item), item.place.start)).line
        above = list(_above(lines, first))
        # the items of a flow list share a line: what stands after the last of them belongs to that one
        later = [other.place.line for other in items.items[number + 1 :]]
        own = [_own(source, line, item) for line in range(first, last + 1) if line not in later]
        words = [*above, *(comment for comment in own if comment)]
        found.append(" ".join(words) or None)
    return tuple(found)


def _above(lines: list[str], first: int) -> Iterator[str]:
    start = first - 1
    while start > 0 and lines[start - 1].lstrip().startswith("#"):
        start -= 1
    for line in lines[start : first - 1]:
        if words := line.strip().lstrip("#").strip():
            yield words


def _own(source: YamlText, line: int, item: Node) -> str:
    """The comment at the end of one line of the item."""
    start = source.line_starts[line - 1]
    text = source.lines()[line - 1]
    scalars = list(_scalars(item))
    starts = [begin for begin, _ in scalars]
    for column, character in enumerate(text):
        if character != "#" or (column > 0 and text[column - 1] not in " \t"):
            continue
        at = bisect.bisect_right(starts, start + column) - 1
        if at < 0 or not scalars[at][0] <= start + column < scalars[at][1]:
            return text[column:].lstrip("#").strip()
    return ""


def _scalars(node: Node) -> Iterator[tuple[int, int]]:
    """Offsets of the keys and values inside a node, in order."""
    spans = [(node.place.start, node.place.end)] if isinstance(node, ScalarNode) else []
    if isinstance(node, ListNode):
        spans = [span for item in node.items for span in _scalars(item)]
    if isinstance(node, MapNode):
        spans = [(place.start, place.end) for place in node.keys.values()]
        spans += [span for item in node.entries.values() for span in _scalars(item)]
    yield from sorted(spans)


def _last_character(node: Node) -> int:
    """Offset of the last character that belongs to a node (a block collection's own end is where the next token begins)."""
    if isinstance(node, ScalarNode):
        return node.place.end - 1
    children = list(node.items if isinstance(node, ListNode) else node.entries.values())
    return max([_last_character(child) for child in children], default=node.place.end - 1)
