"""The tracer in each of its modes beside the bare traversal of the same rays, beside POV-Ray and beside Mitsuba.

Two scenes at 1080p, shadows and Phong: 131 072 triangles with smooth normals, and analytic spheres. A ratio over the raw
traversal is of CPU times, all threads together, which other work on the machine disturbs least; of the two scenes the worse
counts. POV-Ray is compared by CPU time, Mitsuba by wall time, on the triangles; what each takes for the same scene on a film of
8 × 8 pixels (start-up, reading or loading the scene) is taken off. Contenders take turns, round by round.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bench import peers
from bench.measured import Measured, Seconds, interleaved, ratio, timed
from bench.scenes import FILM_1080P, spheres, triangles, triangles_for_mitsuba
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from equilux_tracer.tracer import Precision

MODES: tuple[Precision, ...] = ("exact", "refined", "float")
ROUNDS = 7
PEER_ROUNDS = 3
TINY = (8, 8)

Run = Callable[[], Seconds]


def measure() -> Measured:
    """Ratios float_vs_raw, exact_vs_raw, povray_vs_float, mitsuba_vs_float; refined_vs_raw besides."""
    numbers: dict[str, Any] = {"film": list(FILM_1080P)}
    lines: list[str] = []
    over_raw: dict[str, list[float]] = {mode: [] for mode in MODES}
    for case in (triangles(), spheres()):
        found, times, rays = _against_raw(case)
        numbers[case.name] = {"seconds": _plain(times), "over_raw": found, "rays": rays}
        for mode in MODES:
            over_raw[mode].append(found[mode]["median"])
        lines += _lines_over_raw(case.name, times, found)
    ratios = {f"{mode}_vs_raw": max(over_raw[mode]) for mode in MODES}

    times = _peers()
    numbers["peers"] = {"seconds": _plain(times)}
    for name, unit in (("povray", "cpu"), ("mitsuba", "wall")):
        why_not = peers.absent(name)
        if why_not:
            lines.append(f"{name}: not measured, {why_not}")
            continue
        theirs = _per_image(times[name], times[f"{name}, tiny film"], unit)
        ours = [getattr(one, unit) for one in times["float"]]
        found_ratio = ratio(theirs, ours)
        ratios[f"{name}_vs_float"] = found_ratio["median"]
        numbers["peers"][f"{name}_vs_float"] = {"unit": unit, **found_ratio}
        lines.append(
            f"{name}: {min(theirs):.3f} s {unit} per image over float {min(ours):.4f} s: median {found_ratio['median']:.1f}, "
            f"best {found_ratio['best']:.1f}, {found_ratio['low']:.1f} to {found_ratio['high']:.1f}"
        )
    return Measured("rays", ratios, numbers, lines)


def _against_raw(case: Case) -> tuple[dict[str, dict[str, float]], Mapping[str, list[Seconds]], dict[str, int]]:
    tracer = Tracer(case)
    runs: dict[str, Run] = {"raw": lambda: timed(lambda: tracer.raw_traversal())}
    runs |= {mode: _tracing(tracer, mode) for mode in MODES}
    for run in runs.values():  # what is made at the first call is no part of any picture
        run()
    times = interleaved(runs, ROUNDS)
    raw = [one.cpu for one in times["raw"]]
    traversal = tracer.raw_traversal()
    rays = {"eye": traversal.eye_rays, "shadow": traversal.shadow_rays}
    return {mode: ratio([one.cpu for one in times[mode]], raw) for mode in MODES}, times, rays


def _tracing(tracer: Tracer, mode: Precision) -> Run:
    if mode != "float":
        return lambda: timed(lambda: tracer.render(precision=mode))
    film = tracer.case.scene.film
    out = np.empty((film.height, film.width, 3), np.float32)
    return lambda: timed(lambda: tracer.render(precision="float", out=out))


def _peers() -> Mapping[str, list[Seconds]]:
    """POV-Ray, Mitsuba and float mode in turn, on the triangles."""
    with peers.folder() as folder:
        runs: dict[str, Run] = {"float": _tracing(Tracer(triangles()), "float")}
        runs["float"]()
        if not peers.absent("povray"):
            runs |= _pictures("povray", peers.PovrayPicture, triangles, folder)
        if not peers.absent("mitsuba"):
            runs |= _pictures("mitsuba", peers.MitsubaPicture, triangles_for_mitsuba, folder)
            runs["mitsuba"]()  # compiles
            runs["mitsuba, tiny film"]()
        return interleaved(runs, PEER_ROUNDS)


def _pictures(
    name: str, kind: type[peers.PovrayPicture | peers.MitsubaPicture], scene: Callable[[tuple[int, int]], Case], folder: Path
) -> dict[str, Run]:
    films = {name: FILM_1080P, f"{name}, tiny film": TINY}
    return {key: kind(folder / key, scene(film)).draw for key, film in films.items()}


def _per_image(whole: list[Seconds], tiny: list[Seconds], unit: str) -> list[float]:
    start_up = statistics.median(getattr(one, unit) for one in tiny)
    return [getattr(one, unit) - start_up for one in whole]


def _plain(times: Mapping[str, list[Seconds]]) -> dict[str, Any]:
    return {name: {"wall": [one.wall for one in found], "cpu": [one.cpu for one in found]} for name, found in times.items()}


def _lines_over_raw(name: str, times: Mapping[str, list[Seconds]], found: Mapping[str, Mapping[str, float]]) -> list[str]:
    best = partial(_best, times)
    lines = [f"{name}: raw traversal {best('raw', 'cpu'):.4f} s CPU, {best('raw', 'wall'):.4f} s wall (best of {ROUNDS})"]
    for mode in MODES:
        r = found[mode]
        lines.append(
            f"{name}: {mode:7} {best(mode, 'cpu'):.4f} s CPU, {best(mode, 'wall'):.4f} s wall; "
            f"over raw: median {r['median']:.2f}, best {r['best']:.2f}, {r['low']:.2f} to {r['high']:.2f}"
        )
    return lines


def _best(times: Mapping[str, list[Seconds]], name: str, unit: str) -> float:
    return min(float(getattr(one, unit)) for one in times[name])
