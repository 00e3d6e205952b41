"""Numbers that have a name: the factors by which renderers are usually off."""

from __future__ import annotations

import math
from collections.abc import Iterator

NAMED: dict[str, float] = {
    "π": math.pi, "1/π": 1 / math.pi, "2π": 2 * math.pi, "1/2π": 1 / (2 * math.pi), "4π": 4 * math.pi, "1/4π": 1 / (4 * math.pi),
    "π/2": math.pi / 2, "2/π": 2 / math.pi, "π/4": math.pi / 4, "4/π": 4 / math.pi, "π²": math.pi**2, "1/π²": 1 / math.pi**2,
    "683": 683.0, "1/683": 1 / 683, "683.002": 683.002, "1/683.002": 1 / 683.002, "684": 684.0, "1/684": 1 / 684,
    "684/683.002": 684 / 683.002, "683.002/684": 683.002 / 684, "179": 179.0, "1/179": 1 / 179,
    "255": 255.0, "1/255": 1 / 255, "255/256": 255 / 256, "256/255": 256 / 255, "1/256": 1 / 256, "65535": 65535.0,
    "1/65535": 1 / 65535, "65535/65536": 65535 / 65536, "65536/65535": 65536 / 65535,
    "√2": math.sqrt(2), "1/√2": 1 / math.sqrt(2), "√π": math.sqrt(math.pi), "1/√π": 1 / math.sqrt(math.pi),
    "1/3": 1 / 3, "2/3": 2 / 3, "1/6": 1 / 6, "1/12": 1 / 12,
    "luminance weight of R": 0.2126, "luminance weight of G": 0.7152, "luminance weight of B": 0.0722,
    "π/180": math.pi / 180, "180/π": 180 / math.pi,
    **{f"1/{2**n}": 2.0**-n for n in range(1, 9)}, **{str(2**n): 2.0**n for n in range(1, 9)}, "3": 3.0, "6": 6.0, "12": 12.0,
    **{f"1/10{_}" if _ else "1/10": 10.0**-n for n, _ in enumerate(["", "0", "00", "000", "0000", "00000"], start=1)},
    **{str(10**n): 10.0**n for n in range(1, 7)},
}  # fmt: skip
"""Name → value. Two names of nearly one value (683, 683.002) are told apart only as far as the fit can."""


def recognised(value: float) -> str | None:
    """The name of exactly this number, where it has one that says more than its digits."""
    return next((name for name, known in NAMED.items() if math.isclose(known, value, rel_tol=1e-12)), None)


def candidates(value: float, low: float, high: float) -> Iterator[tuple[float, str | None]]:
    """Numbers in [low, high] that are simpler than the fitted value, nearest names first, then from few digits to more; each
    with its name.
    """
    if not (math.isfinite(value) and low <= high):
        return
    named = sorted((abs(known - value), name) for name, known in NAMED.items() if low <= known <= high)
    yield from ((NAMED[name], name) for _, name in named)
    if value == 0:
        return
    magnitude = math.floor(math.log10(abs(value)))
    seen: set[float] = set()
    for digits in range(1, 7):
        rounded = round(value, digits - 1 - magnitude)
        if low <= rounded <= high and rounded not in seen:
            seen.add(rounded)
            yield rounded, None
    if low <= 0 <= high:
        yield 0.0, None
