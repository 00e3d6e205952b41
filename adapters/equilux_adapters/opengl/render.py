"""Runs a script in the engine's long-lived worker: the context is made once, everything else afresh for every picture."""

from __future__ import annotations

import runpy
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from equilux.adapter import Limits, Program, RawRender, RendererFailed
from equilux_adapters.opengl.kit.context import keeper, started
from equilux_adapters.opengl.knobs import OpenGLKnobs

IMAGE = "image.npy"
DRAWN = "drawn.npz"
"""What was drawn, in double: `read` works out from it what interpolation leaves open."""


def render(program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: OpenGLKnobs) -> RawRender:
    """Execute the saved script itself. Raises RendererFailed with what it said."""
    try:
        seconds = {"start": _start()}
        before = time.perf_counter()
        script = runpy.run_path(str(program_dir / program.entry), run_name="scene")
        scene = script["scene"]()
        image = script["render"](scene)
    except Exception as error:
        raise RendererFailed(f"{program.entry}: {type(error).__name__}: {error}") from error
    seconds["render"] = time.perf_counter() - before
    np.save(workdir / IMAGE, image)
    arrays = {
        f"{name}-{index}": getattr(mesh, name)
        for index, (mesh, _) in enumerate(scene.objects)
        for name in ("points", "normals", "triangles")
    }
    np.savez(workdir / DRAWN, **arrays)
    return RawRender({name: workdir / name for name in (IMAGE, DRAWN)}, seconds, environment=started())


def _start() -> float:
    """Make the context, once per worker; seconds. The script's own `started` finds it: it belongs to the process."""
    before = time.perf_counter()
    _keep_current(started()["window"])()
    return time.perf_counter() - before


@cache
def _keep_current(window: str) -> Callable[[], None]:
    return keeper(window)
