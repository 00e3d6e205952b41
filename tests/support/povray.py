"""Run the POV-Ray adapter outside the engine, and hold its image against its own budget."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from equilux.adapter import Bound, Budget, Limits, Program, RawRender
from equilux_adapters.povray import ADAPTER
from equilux_adapters.povray.knobs import PovrayKnobs
from equilux_scenes.case import Case
from equilux_scenes.loader import load_scene_text

AT_ONCE = 8
"""POV-Ray sleeps most of its time: this many renders fit on one core."""


@dataclass(frozen=True)
class Run:
    """What one pass through translate, render and read gave."""

    case: Case
    program: Program
    raw: RawRender
    image: np.ndarray
    budget: Budget


def case_of_text(text: str) -> Case:
    (case,) = load_scene_text(text).cases
    return case


def expressible(spec: dict[str, Any]) -> dict[str, Any]:
    """Attenuations that POV-Ray has a sum for: a linear term large enough that c + l r + q r² has two real roots."""
    for light in spec["lights"].values():
        terms = light.get("attenuation")
        if terms and terms["linear"] ** 2 < 4.5 * terms["constant"] * terms["quadratic"]:
            terms["linear"] = 2.5 * (terms["constant"] * terms["quadratic"]) ** 0.5
    return spec


def run(case: Case, folder: Path, **knobs: object) -> Run:
    settings = PovrayKnobs.model_validate(knobs)
    program = ADAPTER.translate(case, settings)
    program_folder, workdir = folder / "program", folder / "work"
    workdir.mkdir(parents=True)
    program_folder.mkdir()
    for name, content in program.files.items():
        (program_folder / name).write_bytes(content)
    raw = ADAPTER.render(program, program_folder, workdir, Limits(timeout_s=100.0), settings)
    reading = ADAPTER.read(raw, program, settings)
    return Run(case, program, raw, np.asarray(reading.image, dtype=np.float64), reading.budget)


def run_all(cases: Iterable[Case], folder: Path, **knobs: object) -> Iterator[Run]:
    """Several at once, in order."""
    with ThreadPoolExecutor(AT_ONCE) as pool:
        yield from pool.map(lambda item: run(item[1], folder / str(item[0]), **knobs), enumerate(cases))


def bound(budget: Budget, truth: np.ndarray, leave_out: Iterable[str] = ()) -> np.ndarray:
    """Σ of the budget's hard bounds at every value; geometric terms are not in it."""
    total = np.zeros(truth.shape)
    for term in budget.terms:
        if isinstance(term, Bound) and term.name not in leave_out:
            total = total + term.abs + term.rel * np.abs(truth)
    return total


def term(budget: Budget, name: str):
    (found,) = [term for term in budget.terms if term.name == name]
    return found


def pixel_centres(case: Case) -> np.ndarray:
    """(h·w, 2) film positions, row by row."""
    film = case.scene.film
    x, y = np.meshgrid(np.arange(film.width) + 0.5, np.arange(film.height) + 0.5)
    return np.stack([x.ravel(), y.ravel()], axis=1)
