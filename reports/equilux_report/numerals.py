"""How numbers are written: counts grouped by thin spaces, measures in three significant digits that a script can read back, and
never a percentage that hides a pixel.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

NARROW = "\u202f"
"""Narrow no-break space: between groups of digits, and between a number and its unit."""
NONE = "–"
LONG = 1e6
"""From here on numbers are written with an exponent."""


def count(value: int) -> str:
    """49152 → "49 152"."""
    return f"{value:,}".replace(",", NARROW)


def magnitude(value: float | None, digits: int = 3) -> str:
    """Three significant digits: 0.812, 420, 7.63e-6."""
    if value is None or math.isnan(value):
        return NONE
    if value == 0:
        return "0"
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    size = abs(value)
    sign = "-" if value < 0 else ""
    rounded = float(f"{size:.{digits - 1}e}")
    exponent = math.floor(math.log10(rounded))
    if -4 < exponent < 6:
        places = max(0, digits - 1 - exponent)
        return f"{sign}{rounded:.{places}f}"
    mantissa, _, power = f"{rounded:.{digits - 1}e}".partition("e")
    return f"{sign}{mantissa}e{int(power)}"


def shortest(value: float) -> str:
    """All the digits that a number was given with, and no more: 1000, 0.1, 1e-9, 1e10."""
    if abs(value) >= LONG:
        return np.format_float_scientific(value, trim="-", exp_digits=1).replace("e+", "e")
    return str(int(value)) if float(value).is_integer() else repr(value)


def percent(part: int, whole: int) -> str:
    """A share of pixels: 0 only if it is none, 100 only if it is all."""
    if whole <= 0:
        return NONE
    if part == 0 or part == whole:
        return f"{0 if part == 0 else 100}{NARROW}%"
    share = 100 * part / whole
    if share < 0.01:
        return f"<0.01{NARROW}%"
    if share > 99.99:
        return f">99.99{NARROW}%"
    return f"{share:.2f}{NARROW}%" if share < 99 else f"{share:.3g}{NARROW}%"


def share(part: float | None) -> str:
    """A share: 0 % and 100 % only where it is exactly that."""
    if part is None:
        return NONE
    if part in (0, 1):
        return f"{part * 100:.0f}{NARROW}%"
    if not 1e-5 <= part <= 1 - 1e-5:
        return f"{'<' if part < 0.5 else '>'}{'0.001' if part < 0.5 else '99.999'}{NARROW}%"
    digits = 1
    while digits < 3 and f"{part * 100:.{digits}f}" in ("100." + "0" * digits, "0." + "0" * digits):
        digits += 1
    return f"{part * 100:.{digits}f}{NARROW}%"


def parameter(value: object) -> str:
    """A cause's parameter: 128, "0.5, 0.25", key; nothing for none."""
    if value is None or isinstance(value, Mapping):
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return ", ".join(parameter(part) for part in value)
    return str(value)


def term(value: object) -> str:
    """A value of a budget's term: a number, or numbers by object as their range."""
    if isinstance(value, Mapping):
        several = [float(number) for number in value.values() if isinstance(number, int | float)]
        if several:
            low, high = magnitude(min(several)), magnitude(max(several))
            return f"{low if low == high else f'{low} to {high}'} on {plural(len(several), 'object')}"
    return magnitude(float(value)) if isinstance(value, int | float) else str(value)


def seconds(value: float | None) -> str:
    """Wall time: 0.31 s, 2.4 ms, 3 min 20 s."""
    if value is None:
        return NONE
    if value < 0.1:
        return f"{magnitude(value * 1e3, 2)}{NARROW}ms"
    if value < 99.5:
        return f"{magnitude(value, 3)}{NARROW}s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes}{NARROW}min {rest}{NARROW}s"


def size(value: int) -> str:
    """Bytes: 512 B, 12.3 kB."""
    for unit, scale in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if value >= scale:
            return f"{magnitude(value / scale)}{NARROW}{unit}"
    return f"{value}{NARROW}B"


def plural(number: int, one: str, many: str | None = None) -> str:
    """1 → "1 pair", 2 → "2 pairs"."""
    return f"{count(number)} {one if number == 1 else many or one + 's'}"
