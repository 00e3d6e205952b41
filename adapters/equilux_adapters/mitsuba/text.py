"""Numbers as the script shows them."""

from __future__ import annotations

from collections.abc import Iterable


def number(value: float) -> str:
    """Shortest text that reads back as the same number; zero without a sign."""
    return repr(float(value) + 0.0).removesuffix(".0")


def triple(values: Iterable[float]) -> str:
    """`(1, 2, 3)`"""
    return f"({', '.join(number(value) for value in values)})"


def comment(text: str) -> str:
    """One line, whatever the spec's author wrote."""
    return "".join(c if c.isprintable() else " " for c in text)
