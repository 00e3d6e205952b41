"""How time and memory grow: with pixels, triangles, lights and scenes. Fitted, and plotted beside build/bench.json."""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bench.fit import PowerLaw, tail
from bench.growth_point import matt_sphere, write_ground, write_scene
from bench.growthplot import growth_plot
from bench.measured import Measured
from bench.processes import Cost, run

PLOTS = Path("build/bench")
TRIANGLES = (1_000, 10_000, 100_000, 1_000_000, 10_000_000)
PIXELS = (10_000, 100_000, 500_000, 2_000_000, 8_000_000)
LARGE_PAIR = 8192 * 4096
DELIVERED = (0, 4)
"""Exit codes of a run that did its work; 4: nothing to compare, as a mesh has no closed form."""
PAIR_BYTES = 2 * (24 + 12) + 2 * 12 + 1
POINT_LIMIT_S = 300.0
"""A size that takes longer ends its series."""
LIGHTS = (1, 10, 100, 300, 1_000)
SCENES = (1, 10, 100, 300, 1_000)


@dataclass
class Series:
    """What was measured of one quantity: sizes, and seconds (and bytes) by what was measured."""

    of: str
    sizes: list[int] = field(default_factory=list)
    seconds: dict[str, list[float]] = field(default_factory=dict)
    peak_bytes: list[int] = field(default_factory=list)
    held_bytes: list[int] = field(default_factory=list)
    ended: str = ""
    """Why larger sizes were not measured."""

    def add(self, size: int, point: dict[str, Any]) -> None:
        self.sizes.append(size)
        for name, value in point["seconds"].items():
            self.seconds.setdefault(name, []).append(value)
        self.peak_bytes.append(point.get("peak_bytes", 0))
        self.held_bytes.append(point.get("held_bytes", 0))

    def laws(self) -> dict[str, PowerLaw]:
        if len(self.sizes) < 3:
            return {}
        return {name: tail(self.sizes, values) for name, values in self.seconds.items()}


def measure() -> Measured:
    """Every point in a process of its own, so that none inherits another's memory. Exponents are of the four largest sizes."""
    series = {
        "pixels, comparison": _grown("pixels", (*PIXELS, LARGE_PAIR), _point("comparison")),
        "pixels, tracer": _grown("pixels", PIXELS, _point("tracer pixels")),
        "pixels, whole case": _grown("pixels", PIXELS, _whole_film),
        "triangles, tracer": _grown("triangles", TRIANGLES, _point("triangles")),
        "triangles, whole case": _grown("triangles", TRIANGLES, _whole_mesh),
        "lights, tracer": _grown("lights", LIGHTS, _point("lights")),
        "scenes, whole run": _grown("scenes", SCENES, _many_scenes),
    }
    numbers, lines = {}, []
    PLOTS.mkdir(parents=True, exist_ok=True)
    for name, one in series.items():
        laws = one.laws()
        numbers[name] = {
            "sizes": one.sizes, "seconds": one.seconds, "peak_bytes": one.peak_bytes, "held_bytes": one.held_bytes,
            "ended": one.ended, "exponents": {what: [law.exponent, law.low, law.high] for what, law in laws.items()},
        }  # fmt: skip
        lines += [
            f"{name}: {what}: {one.seconds[what][-1]:.3g} s at {one.sizes[-1]:.3g}, exponent {law.exponent:.2f} "
            f"[{law.low:.2f}, {law.high:.2f}]{_memory(one)}"
            for what, law in laws.items()
        ]
        lines += [f"{name}: {one.ended}"] if one.ended else []
        if not laws:
            continue
        curves = {what: (one.sizes, one.seconds[what], law) for what, law in laws.items()}
        plot = PLOTS / f"growth-{name.replace(', ', '-').replace(' ', '-')}.svg"
        plot.write_text(growth_plot(f"Time over {name}", one.of, "seconds", curves), encoding="utf-8")
    return Measured("growth", _ratios(series), numbers, [*lines, f"plots: {PLOTS}/growth-*.svg"])


def _ratios(series: dict[str, Series]) -> dict[str, float]:
    pair = series["pixels, comparison"]
    film = series["pixels, whole case"]
    triangles = series["triangles, tracer"].laws()
    return {
        "pixels_exponent_comparison": pair.laws()["compare_pair"].exponent,
        "pixels_exponent_tracer": series["pixels, tracer"].laws()["render"].exponent,
        "triangles_exponent_exact": triangles["render exact"].exponent,
        "triangles_exponent_float": triangles["render float"].exponent,
        "comparison_memory_over_held": pair.peak_bytes[-1] / pair.held_bytes[-1],
        "run_memory_over_held": film.peak_bytes[-1] / film.held_bytes[-1],
    }


def _memory(series: Series) -> str:
    if not series.peak_bytes[-1]:
        return ""
    held = f", {series.peak_bytes[-1] / series.held_bytes[-1]:.2f} × what is held" if series.held_bytes[-1] else ""
    return f"; peak {series.peak_bytes[-1] / 2**20:.0f} MiB{held}"


def _grown(of: str, sizes: Sequence[int], point: Callable[[int], dict[str, Any]]) -> Series:
    """Size by size, until one cannot be measured."""
    series = Series(of)
    for size in sizes:
        try:
            series.add(size, point(size))
        except (RuntimeError, TimeoutError) as problem:
            series.ended = f"{size:.3g} could not be measured: {problem}"
            break
    return series


def _point(name: str) -> Callable[[int], dict[str, Any]]:
    def measured(size: int) -> dict[str, Any]:
        cost = run([sys.executable, "-m", "bench.growth_point", name, str(size)], {"PYTHONPATH": os.pathsep.join(sys.path)},
                   limit_s=POINT_LIMIT_S)  # fmt: skip
        if cost.status != 0:
            raise RuntimeError(f"{name}, {size}: {cost.output[-1000:]}")
        point: dict[str, Any] = json.loads(cost.output.splitlines()[-1])
        return point

    return measured


def _run_harness(scenes: Path, scratch: Path, *options: str) -> Cost:
    """`equilux run` by the reference and the oracle, without a report and with a store of its own."""
    command = [sys.executable, "-m", "equilux", "run", str(scenes), "--out", str(scratch / "run"), "--no-html", *options]
    cost = run(command, {"EQUILUX_CACHE": str(scratch / "cache")}, limit_s=POINT_LIMIT_S)
    if cost.status not in DELIVERED:
        raise RuntimeError(f"equilux run ended with {cost.status}: {cost.output[-1000:]}")
    return cost


def _whole_film(pixels: int) -> dict[str, Any]:
    """One case by two laboratories. Held, 97 bytes a pixel: two float64 pictures with their uncertainty in float32, and of their
    pair a − b and E_n in float32 and the class."""
    with tempfile.TemporaryDirectory(prefix="equilux-bench-") as scratch:
        folder = Path(scratch)
        scene = write_scene(folder, matt_sphere("film", pixels))
        idle = _run_harness(write_scene(folder, matt_sphere("least", 64)), folder / "least", "--adapters", "reference,oracle")
        cost = _run_harness(scene, folder, "--adapters", "reference,oracle")
    peak = max(cost.peak_bytes - idle.peak_bytes, 0)
    return {"seconds": {"run": cost.wall_s, "cpu": cost.cpu_s}, "peak_bytes": peak, "held_bytes": PAIR_BYTES * pixels}


def _whole_mesh(triangles: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="equilux-bench-") as scratch:
        folder = Path(scratch)
        cost = _run_harness(write_ground(folder, triangles), folder, "--adapters", "reference")
    return {"seconds": {"run": cost.wall_s, "cpu": cost.cpu_s}, "peak_bytes": cost.peak_bytes}


def _many_scenes(scenes: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="equilux-bench-") as scratch:
        folder = Path(scratch) / "scenes"
        folder.mkdir()
        for number in range(scenes):
            write_scene(folder, matt_sphere(f"scene-{number}", 64))
        cost = _run_harness(folder, Path(scratch), "--adapters", "reference,oracle")
    return {"seconds": {"run": cost.wall_s, "cpu": cost.cpu_s}, "peak_bytes": cost.peak_bytes}
