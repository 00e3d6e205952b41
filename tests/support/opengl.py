"""Run the OpenGL adapter in this process, and hold its image against a truth within its own budget."""

from __future__ import annotations

import copy
import random
from pathlib import Path

import numpy as np

from equilux.adapter import Budget, Limits
from equilux.budget import Bound
from equilux.compare import PairResult, RenderedImage, compare_pair
from equilux.uncertainty import stated
from equilux_adapters.opengl import ADAPTER
from equilux_adapters.opengl.knobs import OpenGLKnobs
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from support.random_scenes import Spec
from support.vtk import EXACT, Run


def run(case: Case, folder: Path, **knobs: object) -> Run:
    """translate, render and read."""
    settings = OpenGLKnobs.model_validate(knobs)
    program = ADAPTER.translate(case, settings)
    name = "-".join([case.name, *(f"{key}{value}" for key, value in knobs.items())])
    written, work = folder / name / "program", folder / name / "work"
    for made in (written, work):
        made.mkdir(parents=True)
    for file, content in program.files.items():
        (written / file).write_bytes(content)
    raw = ADAPTER.render(program, written, work, Limits(), settings)
    reading = ADAPTER.read(raw, program, settings)
    return Run(case, program, written, raw, np.asarray(reading.image), reading.budget)


def against(truth: np.ndarray, result: Run, tracer: Tracer) -> PairResult:
    """Compare with a truth that is exact to EXACT; tracer: the reference of the model that `truth` is of."""
    side = RenderedImage("opengl", result.image, stated(result.budget, result.image, tracer))
    return compare_pair(side, RenderedImage("reference", truth, stated(EXACT, truth, tracer)), tracer)


def against_reference(result: Run) -> PairResult:
    """The verdict against the tracer."""
    tracer = Tracer(result.case)
    return against(tracer.render()["radiance"], result, tracer)


def without_interpolation(result: Run) -> Budget:
    """The budget less the term for lighting at corners."""
    return Budget(tuple(term for term in result.budget.terms if not (isinstance(term, Bound) and term.name == "vertex lighting")))


def as_opengl(spec: Spec, seed: int) -> Spec:
    """A random `phong` scene as an `opengl` one: exponents within the API's range, shares of their own for some lights."""
    rng, spec = random.Random(f"opengl {seed}"), copy.deepcopy(spec)
    spec["model"] = "opengl"
    spec["viewer"] = rng.choice(["local", "infinite"])
    for material in spec["materials"].values():
        material["exponent"] = min(material["exponent"], 128.0)
    for light in spec["lights"].values():
        light["exponent"] = min(light.get("exponent", 0.0), 128.0)
        if light["kind"] != "spot":
            del light["exponent"]
        for share in ("ambient", "diffuse", "specular"):
            if rng.random() < 0.5:
                light[share] = [rng.uniform(0.0, 1.5) for _ in range(3)]
    return spec
