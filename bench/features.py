"""What each feature of a scene costs: the same ring with a shadow, a highlight and a second light, and without.

Kernels are compiled for what a scene needs (that the code of what it does not need is absent:
tests/unit/tracer/test_specialised.py), so a scene without a feature must be faster by more than the feature's arithmetic.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from bench.measured import Measured, Seconds, interleaved, timed
from bench.scenes import case_of, triangles
from equilux_scenes.case import Case
from equilux_tracer import Tracer

FILM = (960, 540)
ROUNDS = 5
SECOND_LIGHT = {"kind": "point", "position": [-2.5, -1.0, 3.0], "intensity": 10}
VARIANTS = {
    "all": ("shadow", "highlight", "second light"),
    "no shadow": ("highlight", "second light"),
    "no highlight": ("shadow", "second light"),
    "no second light": ("shadow", "highlight"),
    "none": (),
}


def measure() -> Measured:
    """CPU seconds per picture and variant, exact and float."""
    cases = {name: with_features(features) for name, features in VARIANTS.items()}
    numbers: dict[str, Any] = {"film": list(FILM)}
    lines = []
    for mode in ("exact", "float"):
        times = interleaved({name: _run(case, mode) for name, case in cases.items()}, ROUNDS)
        best = {name: min(one.cpu for one in found) for name, found in times.items()}
        numbers[mode] = {"cpu_s": {name: [one.cpu for one in found] for name, found in times.items()}, "best_cpu_s": best}
        told = ", ".join(f"{name} {1e3 * seconds:.1f} ms" for name, seconds in best.items())
        lines.append(f"{mode}: {told} CPU (best of {ROUNDS})")
    return Measured("features", numbers=numbers, lines=lines)


def with_features(features: tuple[str, ...]) -> Case:
    """The ring with these and no others of: shadow, highlight, second light."""
    case = triangles(FILM)
    spec: dict[str, Any] = json.loads(case.scene.model_dump_json(exclude_unset=True))
    if "shadow" not in features:
        spec["model"] = "phong"
        del spec["recursion_limit"]
    if "highlight" not in features:
        for material in spec["materials"].values():
            material["specular"] = 0
    if "second light" in features:
        spec["lights"]["second"] = SECOND_LIGHT
    return case_of(spec, case.meshes)


def _run(case: Case, mode: str) -> Callable[[], Seconds]:
    tracer = Tracer(case)
    out = np.empty((FILM[1], FILM[0], 3), np.float32)

    def exact() -> Seconds:
        return timed(lambda: tracer.render())

    def single() -> Seconds:
        return timed(lambda: tracer.render(precision="float", out=out))

    run = exact if mode == "exact" else single
    run()  # what is made at the first call is no part of any picture
    return run
