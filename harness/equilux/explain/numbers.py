"""Numbers as they are read: radiances, shares, parameters of causes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

UNIT = "W/(m²·sr)"
BANDS = "RGB"


def number(value: float | None, digits: int = 6) -> str:
    """Up to `digits` significant digits; what is no finite number is said to be none."""
    if value is None or not math.isfinite(value):
        return "not finite"
    return f"{value:.{digits}g}"


def short(value: float | None) -> str:
    """Three digits, for bounds, differences and residuals."""
    return number(value, 3)


def bands(values: Sequence[float | None]) -> str:
    """Three bands; only one where they are equal."""
    return number(values[0], 7) if len(set(values)) == 1 else " ".join(number(value, 7) for value in values)


def share(part: float) -> str:
    """0.998 → "99.8 %". Neither 0 % nor 100 % is said of what is not exactly that."""
    if part in (0, 1):
        return f"{part * 100:.0f} %"
    percent = part * 100
    if percent < 0.001:
        return "< 0.001 %"
    if percent > 99.999:
        return "> 99.999 %"
    digits = 1
    while digits < 3 and f"{percent:.{digits}f}" in ("100." + "0" * digits, "0." + "0" * digits):
        digits += 1
    return f"{percent:.{digits}f} %"


def parameter(value: Any) -> str:
    """A cause's parameter: "128", "0.5, 0.25", "key"; "" for none."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float | int):
        return number(float(value))
    if isinstance(value, list | tuple):
        return ", ".join(parameter(part) for part in value)
    return str(value)


def counted(count: int, one: str, many: str | None = None) -> str:
    """ "1 pixel", "2 pixels"."""
    return f"{count} {one if count == 1 else many or one + 's'}"


def listed(words: Sequence[str], last: str = "and") -> str:
    """ "a, b and c"."""
    return f"{', '.join(words[:-1])} {last} {words[-1]}" if len(words) > 1 else "".join(words)


def some(words: Sequence[str], shown: int = 3) -> str:
    """The first few of a list, and how many more there are."""
    rest = len(words) - shown
    return ", ".join(words[:shown]) + (f" and {rest} more" if rest > 0 else "")
