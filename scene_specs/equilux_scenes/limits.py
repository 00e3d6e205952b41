"""Bounds that keep a wrong or hostile spec from exhausting the machine. Each names itself when it is met."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields

from equilux_scenes.errors import hint, shortened

_DEEPEST = 200
"""Nodes are read without recursion but turned into values with it, and Python's own stack has room for some 1000 calls."""


@dataclass(frozen=True)
class Limits:
    """Defaults a normal user never meets; `--limit NAME=V` raises one.

    file_bytes: size of one spec. nesting: depth of lists and mappings in it, at most 200. nodes: values in it, aliases counted as
    often as they are used. aliases: uses of YAML anchors. pixels: film width × height. objects, lights, materials: of one scene.
    cases: of one scene's sweep. mesh_bytes: size of one mesh file. triangles, vertices: of one mesh. errors: reported per file
    before the rest is only counted.
    """

    file_bytes: int = 4 << 20
    nesting: int = 32
    nodes: int = 250_000
    aliases: int = 1_000
    pixels: int = 100_000_000
    objects: int = 20_000
    lights: int = 4_096
    materials: int = 20_000
    cases: int = 10_000
    mesh_bytes: int = 1 << 30
    triangles: int = 20_000_000
    vertices: int = 20_000_000
    errors: int = 1_000

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Every limit's name, as `--limit` takes it."""
        return tuple(field.name for field in fields(cls))

    @classmethod
    def from_options(cls, options: Iterable[str]) -> Limits:
        """Limits from `NAME=V` texts. Raises ValueError that names the option, what it got and what is allowed."""
        values: dict[str, int] = {}
        for option in options:
            name, _, text = option.partition("=")
            if name not in cls.names():
                raise ValueError(
                    f"--limit {shortened(option)}: unknown limit '{shortened(name)}', allowed {', '.join(cls.names())}"
                    + hint(name, cls.names())
                )
            most = _DEEPEST if name == "nesting" else 10**18
            if not (text.isascii() and text.isdigit() and len(text) <= 18 and 1 <= int(text) <= most):
                allowed = f"an integer from 1 to {most}"
                raise ValueError(f"--limit {shortened(option)}: got '{shortened(text)}', allowed {allowed} (as in {name}=100)")
            values[name] = int(text)
        return cls(**values)


def exceeded(name: str, got: int, allowed: int, what: str) -> str:
    """The message of a limit that is met."""
    return f"{what}, got {got}, allowed at most {allowed} (limit '{name}': raise it with --limit {name}={got})"
