"""Run the Mitsuba adapter in this process, and hold its image against a truth within its own budget."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from equilux.adapter import Budget, Limits, Program, RawRender
from equilux.budget import Bound, Term
from equilux.compare import PairResult, RenderedImage, compare_pair
from equilux.uncertainty import stated
from equilux_adapters.mitsuba import ADAPTER
from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_scenes.case import Case
from equilux_scenes.loader import corpus_folder, load_scene_text, load_scenes
from equilux_tracer import Tracer

EXACT = Budget((Bound("rounding", "the truth's own, in double", abs=1e-12, rel=1e-12),))


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


def corpus_cases(family: str) -> list[Case]:
    """Every case of one folder of the shipped corpus."""
    return [case for file in load_scenes([corpus_folder() / family]) for case in file.cases]


def run(case: Case, folder: Path, **knobs: object) -> Run:
    settings = MitsubaKnobs.model_validate(knobs)
    program = ADAPTER.translate(case, settings)
    written, work = folder / case.name / "program", folder / case.name / "work"
    for made in (written, work):
        made.mkdir(parents=True)
    for name, content in program.files.items():
        (written / name).write_bytes(content)
    raw = ADAPTER.render(program, written, work, Limits(), settings)
    reading = ADAPTER.read(raw, program, settings)
    return Run(case, program, written, raw, np.asarray(reading.image), reading.budget)


def against(truth: np.ndarray, result: Run, tracer: Tracer | None = None) -> PairResult:
    """Compare with a truth that is exact to EXACT; tracer: decides about edges, where it is given."""
    side = RenderedImage("mitsuba", result.image, stated(result.budget, result.image, tracer))
    return compare_pair(side, RenderedImage("reference", truth, stated(EXACT, truth, tracer)), tracer)


def local_tracer(result: Run) -> Tracer:
    """The reference, of model phong: what delta lights make of a scene in which nothing is in the way of light."""
    scene = result.case.scene.model_copy(update={"model": "phong"})
    return Tracer(Case(name=scene.name, scene=scene, scene_name=scene.name, meshes=result.case.meshes))


def against_local(result: Run) -> PairResult:
    tracer = local_tracer(result)
    return against(tracer.render()["radiance"], result, tracer)


def verdict_line(result: Run, pair: PairResult) -> str:
    """For assertion messages: both numbers at the worst pixel."""
    json = pair.json
    counts = f"{json['diverge']} diverge, {json['invalid']} invalid, {json['edge']} edge"
    return f"{result.case.name}: {counts}, worst {json['worst']}, E_n {json['en_max']}"


def term_of(result: Run, name: str) -> Term:
    return next(term for term in result.budget.terms if term.name == name)
