"""Picks from the kit the modules that a script needs, as text."""

from __future__ import annotations

import ast
import textwrap
from dataclasses import dataclass, field
from functools import cache
from importlib import resources

_MODULES = ("materials", "phong", "lamp", "shapes", "film")
_KIT = "equilux_adapters.mitsuba.kit"


@dataclass
class _Module:
    """Import statements, and top-level definitions by name."""

    imports: set[str] = field(default_factory=set)
    definitions: dict[str, str] = field(default_factory=dict)


@cache
def _module(name: str) -> _Module:
    text = (resources.files(_KIT) / f"{name}.py").read_text(encoding="utf-8")
    lines, found, last = text.splitlines(), _Module(), ""
    for node in ast.parse(text).body:
        piece = "\n".join(lines[_first_line(node) - 1 : node.end_lineno])
        if isinstance(node, ast.Import | ast.ImportFrom):
            found.imports.add(piece)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            last = node.name
            found.definitions[last] = piece
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            last = node.targets[0].id
            found.definitions[last] = piece
        elif last:  # the docstring of a constant
            found.definitions[last] += "\n" + piece
    return found


def _first_line(node: ast.stmt) -> int:
    """Of its decorators, if it has any."""
    decorators: list[ast.expr] = getattr(node, "decorator_list", [])
    return min([node.lineno, *(decorator.lineno for decorator in decorators)])


def names_in(text: str) -> set[str]:
    """Every name that a piece of Python mentions."""
    return {node.id for node in ast.walk(ast.parse(textwrap.dedent(text))) if isinstance(node, ast.Name)}


def kit_source(body: str) -> tuple[str, str, str]:
    """(imports, constants, definitions) of every module from which `body` uses something, in the kit's order."""
    used = names_in(body)
    modules = [module for module in map(_module, _MODULES) if used & set(module.definitions)]
    definitions = {name: text for module in modules for name, text in module.definitions.items()}
    is_code = {name: text.startswith(("def ", "class ", "@")) for name, text in definitions.items()}
    constants = "\n".join(text for name, text in definitions.items() if not is_code[name])
    code = "\n\n\n".join(text for name, text in definitions.items() if is_code[name])
    imports = set().union(*(module.imports for module in modules)) - {"from __future__ import annotations"}
    return _sorted_imports(imports), constants, code


def _sorted_imports(imports: set[str]) -> str:
    """The standard library first."""
    ours = ("drjit", "mitsuba", "numpy")
    third = {line for line in imports if line.split()[1].split(".")[0] in ours}
    groups = [sorted(imports - third, key=lambda line: (line.startswith("from "), line)), sorted(third)]
    return "\n\n".join("\n".join(group) for group in groups if group)
