"""How error messages name a part of the spec and show a value of it."""

from __future__ import annotations

from collections.abc import Iterator

from equilux_scenes.errors import shortened
from equilux_scenes.yaml_tree import ListNode, Node, ScalarNode

_NAMED = {"lights": "light", "materials": "material", "sweep": "sweep axis"}
_NUMBERED = {"objects": "object", "expect": "expectation", "transform": "transform step"}
_ENOUGH = 80  # characters, more than `shortened` keeps


def owner(path: tuple[str | int, ...], kind: str | None = None) -> str:
    """The part at `path` in words: `light 'key'`, `object 0 (sphere)`, `attenuation of light 'key'`. Objects count from 0."""
    if not path:
        return "the scene"
    if len(path) == 1:
        return str(path[0])
    *outer, group, key = path
    if group in _NAMED and not outer:
        return f"{_NAMED[str(group)]} '{shortened(str(key))}'"
    if group in _NUMBERED and isinstance(key, int):
        number = f"{_NUMBERED[str(group)]} {key}" + (f" ({kind})" if kind else "")
        return f"{number} of {owner(tuple(outer))}" if outer else number
    return f"{label((key,))} of {owner((*outer, group))}"


def scene_of(model: str | None) -> str:
    """`a 'phong' scene`."""
    return f"{'an' if model and model[0] in 'aeiou' else 'a'} '{model}' scene"


def label(path: tuple[str | int, ...]) -> str:
    """A place inside a part: `position[1]`."""
    head, *rest = path or ("value",)
    return shortened(str(head)) + "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in rest)


def shown(node: Node) -> str:
    """A value as a message shows it: numbers as written, text in quotes, lists and mappings on one line, all of it shortened."""
    text = ""
    for piece in _pieces(node):
        text += piece
        if len(text) > _ENOUGH:
            break
    return shortened(text)


def _pieces(node: Node) -> Iterator[str]:
    if isinstance(node, ScalarNode):
        yield _scalar(node)
    elif isinstance(node, ListNode):
        yield "["
        for index, item in enumerate(node.items):
            yield ", " if index else ""
            yield from _pieces(item)
        yield "]"
    else:
        yield "{"
        for index, (key, value) in enumerate(node.entries.items()):
            yield f", {key}: " if index else f"{key}: "
            yield from _pieces(value)
        yield "}"


def _scalar(node: ScalarNode) -> str:
    if node.value is None:
        return "nothing"
    return f"'{node.value}'" if isinstance(node.value, str) else node.text
