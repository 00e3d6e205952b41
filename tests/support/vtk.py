"""Run the VTK adapter in this process, and hold its image against the reference within its own budget."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from equilux.adapter import Budget, Limits, Program, RawRender
from equilux.budget import Bound, Term
from equilux.compare import PairResult, RenderedImage, compare_pair
from equilux.uncertainty import stated
from equilux_adapters.vtk import ADAPTER
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_scenes.case import Case
from equilux_scenes.loader import corpus_folder, load_scene_text, load_scenes
from equilux_tracer import Tracer

EXACT = Budget((Bound("rounding", "the reference's own, in double", abs=1e-12, rel=1e-12),))


@dataclass(frozen=True)
class Run:
    """What one pass through translate, render and read gave."""

    case: Case
    program: Program
    folder: Path
    raw: RawRender
    image: np.ndarray
    budget: Budget


def case_of_text(text: str) -> Case:
    (case,) = load_scene_text(text).cases
    return case


def corpus_case(scene: str, name: str | None = None) -> Case:
    """A case of the shipped corpus; of a scene with sweeps the one of that name."""
    (path,) = corpus_folder().rglob(f"{scene}.scene.yaml")
    (file,) = load_scenes([path])
    return next(case for case in file.cases if case.name == (name or scene))


def run(case: Case, folder: Path, **knobs: object) -> Run:
    settings = VtkKnobs.model_validate(knobs)
    program = ADAPTER.translate(case, settings)
    written, work = folder / case.name / "program", folder / case.name / "work"
    for made in (written, work):
        made.mkdir(parents=True)
    for name, content in program.files.items():
        (written / name).write_bytes(content)
    raw = ADAPTER.render(program, written, work, Limits(), settings)
    reading = ADAPTER.read(raw, program, settings)
    return Run(case, program, written, raw, np.asarray(reading.image), reading.budget)


def against(truth: np.ndarray, result: Run, tracer: Tracer) -> PairResult:
    """Compare with a truth that is exact to EXACT; tracer: the reference of the model that `truth` is of."""
    side = RenderedImage("vtk", result.image, stated(result.budget, result.image, tracer))
    return compare_pair(side, RenderedImage("reference", truth, stated(EXACT, truth, tracer)), tracer)


def against_reference(result: Run) -> PairResult:
    tracer = Tracer(result.case)
    return against(tracer.render()["radiance"], result, tracer)


def verdict_line(result: Run, pair: PairResult) -> str:
    """For assertion messages: both numbers at the worst pixel."""
    json = pair.json
    counts = f"{json['diverge']} diverge, {json['invalid']} invalid"
    return f"{result.case.name}: {counts}, worst {json['worst']}, E_n {json['en_max']}"


def allowed_by(term: Term, result: Run, tracer: Tracer) -> np.ndarray:
    """(h, w, 3): what one term of the budget alone allows for."""
    alone = stated(Budget((term, Bound("storage", "left out"))), result.image, tracer)
    return np.asarray(alone.bound(result.image), dtype=np.float64)


def term_of(result: Run, name: str) -> Term:
    return next(term for term in result.budget.terms if term.name == name)
