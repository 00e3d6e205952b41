"""Run the Mitsuba adapter in this process, and hold its image against a truth within its own budget."""

from __future__ import annotations

import random
from dataclasses import dataclass
from pathlib import Path
from typing import Any

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
from support.random_scenes import Spec, random_spec

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


def without_ambient(spec: Spec) -> Spec:
    """A random spec of model `phong`, as one of the reflection equation."""
    spec = {key: value for key, value in spec.items() if key != "ambient"} | {"model": "reflection-equation"}
    for material in spec["materials"].values():
        del material["ambient"]
    return spec


def random_emitters(seed: int, *, film: tuple[int, int] = (24, 18), **options: Any) -> Spec:
    """Two to four random objects under one to three emitters, at times delta lights and an environment; every BRDF."""
    spec = without_ambient(random_spec(seed, objects=(2, 4), film=film, exponents=(1.0, 200.0), **options))
    rng = random.Random(f"emitters {seed}")
    for material in spec["materials"].values():
        material["brdf"] = rng.choice(["lambert", "phong-classic", "phong-cosine"])
    if rng.random() < 0.5:
        spec["lights"] = {}
    for k in range(rng.randint(1, 3)):
        spec["lights"][f"e{k}"] = _emitter(rng)
    if rng.random() < 0.5:
        spec["lights"]["sky"] = {"kind": "environment", "radiance": [rng.random() for _ in range(3)]}
        spec.pop("background", None)
    return spec


def _emitter(rng: random.Random) -> Spec:
    """Facing the origin, from outside of where objects are."""
    side = np.array([rng.uniform(-1, 1) for _ in range(3)])
    away = side / np.linalg.norm(side) * rng.uniform(1.2, 2.5)
    u = np.cross(away, [rng.uniform(-1, 1) for _ in range(3)])
    u /= np.linalg.norm(u)
    v = np.cross(away, u) / np.linalg.norm(away)
    size, radiance = rng.uniform(0.1, 0.6), [rng.uniform(0, 8) for _ in range(3)]
    shape: Spec = rng.choice(
        [
            {"kind": "sphere", "center": away.tolist(), "radius": size},
            {"kind": "disc", "center": away.tolist(), "radius": size, "normal": (-away).tolist()},
            {"kind": "rectangle", "corner": away.tolist(), "edge_u": (-size * u).tolist(), "edge_v": (1.3 * size * v).tolist()},
        ]
    )
    return shape | {"radiance": radiance}


def standardised(result: Run, truth: np.ndarray) -> np.ndarray:
    """(picture − truth) / σ where noise is what there is: where σ exceeds all bounds together fivefold; one per pixel.

    Bands of a pixel share their samples, so that they are one observation.
    """
    sigma = np.asarray(term_of(result, "sampling").sigma)
    bounds = Budget(tuple(term for term in result.budget.terms if isinstance(term, Bound)))
    bound = stated(bounds, result.image).bound(truth)
    band = np.argmax(sigma, axis=-1)[..., None]
    error, scale = (np.take_along_axis(array, band, axis=-1)[..., 0] for array in (result.image - truth, sigma))
    tight = scale > 5 * np.take_along_axis(bound, band, axis=-1)[..., 0]
    return np.asarray(error[tight] / scale[tight])
