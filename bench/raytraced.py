"""How long the tracer takes over a scene with everything in it: shadows, mirrors, glass, eight bounces."""

from __future__ import annotations

from bench.measured import Measured, Seconds, timed
from bench.scenes import CORNELL, case_of
from equilux_tracer import Tracer

REPEATS = 3


def measure() -> Measured:
    """The Cornell box, 256 × 192, radiance and its rounding, on two threads."""
    tracer = Tracer(case_of(CORNELL))
    times: list[Seconds] = [timed(lambda: tracer.render(["radiance", "rounding"], threads=2)) for _ in range(REPEATS)]
    best = min(one.wall for one in times)
    return Measured(
        "raytraced",
        numbers={"wall_s": [one.wall for one in times], "cpu_s": [one.cpu for one in times]},
        lines=[f"Cornell box, 256 × 192, eight bounces, two threads: {best:.2f} s (best of {REPEATS})"],
    )
