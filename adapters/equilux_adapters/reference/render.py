"""Program → pictures, in this process. The engine has put this code into a worker: a crash costs one case."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from equilux.adapter import Case, Program, RawRender, RendererFailed
from equilux_adapters.reference.knobs import ReferenceKnobs
from equilux_adapters.reference.translate import MESH_PARTS, mesh_file
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Scene

BOUNDS = ("rounding", "quadrature")
"""The exact mode's channels that bound the error of its radiance; the other precisions have the first."""


def render(program: Program, program_dir: Path, workdir: Path, knobs: ReferenceKnobs) -> RawRender:
    """Radiance and the bounds of its error, (h, w, 3), and how far discontinuities may be displaced on the film, pixels.

    Raises RendererFailed where the tracer refuses.
    """
    started = time.perf_counter()
    from equilux_tracer import EMBREE_VERSION, Tracer, TracerError

    case = _case(program, program_dir)
    loaded = time.perf_counter()
    try:
        tracer = Tracer(case, precision=knobs.precision, error_target=knobs.error_target)
        bounds = BOUNDS if knobs.precision == "exact" else BOUNDS[:1]
        arrays = tracer.render(("radiance", *bounds), threads=knobs.threads)
        if knobs.precision != "exact":
            arrays["film_px"] = np.array(tracer.displacement_px())
    except TracerError as error:
        raise RendererFailed(str(error)) from None
    files = {}
    for name, array in arrays.items():
        files[name] = workdir / f"{name}.npy"
        np.save(files[name], array, allow_pickle=False)
    seconds = {"start": loaded - started, "render": time.perf_counter() - loaded}
    return RawRender(files=files, seconds=seconds, environment={"embree": EMBREE_VERSION})


def _case(program: Program, folder: Path) -> Case:
    scene = Scene.model_validate_json((folder / program.entry).read_bytes())
    meshes = {index: _mesh(folder, index) for index in program.data["meshes"]}
    return Case(name=scene.name, scene=scene, scene_name=scene.name, meshes=meshes)


def _mesh(folder: Path, index: int) -> TriangleMesh:
    paths = {part: folder / mesh_file(index, part) for part in MESH_PARTS}
    return TriangleMesh(**{part: np.load(path, allow_pickle=False) for part, path in paths.items() if path.exists()})
