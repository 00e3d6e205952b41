"""Picks from a kit of modules the functions that a script needs, as text."""

from __future__ import annotations

import ast
import sys
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from importlib import resources

GEOMETRY = tuple(f"equilux_adapters._triangles.{name}" for name in ("view", "facing", "clip", "depth", "round", "shapes"))
"""The modules of this package that scripts are made from."""

_OURS = "equilux_adapters"


@dataclass
class _Kit:
    """Top-level definitions by name, with their text and the names they use; and where every other name is imported from."""

    text: dict[str, str] = field(default_factory=dict)
    uses: dict[str, set[str]] = field(default_factory=dict)
    imports: dict[str, str] = field(default_factory=dict)


@cache
def _kit(modules: tuple[str, ...]) -> _Kit:
    kit = _Kit()
    for module in modules:
        package, _, name = module.rpartition(".")
        source = (resources.files(package) / f"{name}.py").read_text(encoding="utf-8")
        lines = source.splitlines()
        tree = ast.parse(source)
        for node, following in zip(tree.body, [*tree.body[1:], None], strict=True):
            if isinstance(node, ast.Import | ast.ImportFrom):
                _note_imports(kit, node)
            elif defined := _defined(node):
                # up to the next definition: with decorators, and with the docstring that follows a constant
                start = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
                end = node.end_lineno or start
                if isinstance(following, ast.Expr):
                    end = following.end_lineno or end
                kit.text[defined] = "\n".join(lines[start - 1 : end])
                kit.uses[defined] = names_in(kit.text[defined])
    return kit


def _note_imports(kit: _Kit, node: ast.Import | ast.ImportFrom) -> None:
    for alias in node.names:
        if isinstance(node, ast.Import):
            kit.imports[alias.asname or alias.name] = f"import {alias.name}" + (f" as {alias.asname}" if alias.asname else "")
        elif node.module and not node.module.startswith(_OURS) and node.module != "__future__":
            kit.imports[alias.name] = node.module


def _defined(node: ast.stmt) -> str | None:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return node.name
    if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
        return node.targets[0].id
    return None


def names_in(text: str) -> set[str]:
    """Every name that a piece of Python mentions."""
    return {node.id for node in ast.walk(ast.parse(textwrap.dedent(text))) if isinstance(node, ast.Name)}


def kit_source(names: Iterable[str], modules: tuple[str, ...]) -> tuple[str, str]:
    """(imports, definitions) that `names` need, they themselves and whatever they use; in the order of the modules."""
    kit = _kit(modules)
    needed, external, queue = set[str](), set[str](), list(names)
    while queue:
        name = queue.pop()
        if name in kit.text and name not in needed:
            needed.add(name)
            queue += kit.uses[name]
        elif name in kit.imports:
            external.add(name)
    definitions = [text for name, text in kit.text.items() if name in needed]
    return _import_lines({name: kit.imports[name] for name in external}), "\n\n\n".join(definitions)


def _import_lines(imports: dict[str, str]) -> str:
    """Import statements for name → module (or whole statement): the standard library first."""
    by_module: dict[str, list[str]] = {}
    lines = {where for where in imports.values() if where.startswith("import ")}
    for name, module in imports.items():
        if module not in lines:
            by_module.setdefault(module, []).append(name)
    lines |= {_from_import(module, sorted(names)) for module, names in by_module.items()}
    standard: list[str] = []
    others: list[str] = []
    for line in sorted(lines, key=lambda line: (line.startswith("from "), line.split()[1])):
        (standard if line.split()[1].partition(".")[0] in sys.stdlib_module_names else others).append(line)
    return "\n".join([*standard, "", *others])


def _from_import(module: str, names: list[str]) -> str:
    line = f"from {module} import {', '.join(names)}"
    return line if len(line) <= 120 else "\n".join([f"from {module} import (", *(f"    {name}," for name in names), ")"])
