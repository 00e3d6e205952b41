"""Runs a script in the engine's long-lived worker: Mitsuba is imported once, compiled kernels are kept."""

from __future__ import annotations

import os
import runpy
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from equilux.adapter import Limits, Program, RawRender, RendererFailed
from equilux_adapters.mitsuba.knobs import MitsubaKnobs
from equilux_adapters.mitsuba.library import ENVIRONMENT, find_llvm

PICTURE = "picture.npz"


def render(program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: MitsubaKnobs) -> RawRender:
    """Execute the saved script itself. Raises RendererFailed with what Mitsuba said."""
    try:
        started = _start()
        before = time.perf_counter()
        picture, compiling = _run(program_dir / program.entry)
    except Exception as error:
        raise RendererFailed(f"{program.entry}: {type(error).__name__}: {error}") from error
    seconds = {"start": started + compiling, "render": max(time.perf_counter() - before - compiling, 0.0)}
    np.savez(workdir / PICTURE, **picture)
    return RawRender({PICTURE: workdir / PICTURE}, seconds, environment=_environment())


def _start() -> float:
    """Import Mitsuba, once per worker and never before it was forked; seconds."""
    if "mitsuba" in sys.modules:
        return 0.0
    before = time.perf_counter()
    if llvm := find_llvm():
        os.environ.setdefault(ENVIRONMENT, llvm)
    import mitsuba

    mitsuba.set_variant("llvm_ad_rgb")
    return time.perf_counter() - before


def _run(script: Path) -> tuple[dict[str, Any], float]:
    """What the script's `picture` returns, and how many seconds of it LLVM spent on kernels not in DrJit's cache."""
    import drjit

    with drjit.scoped_set_flag(drjit.JitFlag.KernelHistory, True):
        drjit.kernel_history_clear()
        picture = runpy.run_path(str(script), run_name="scene")["picture"]()
        history = drjit.kernel_history()
    return picture, sum(kernel["backend_time"] for kernel in history if not kernel.get("cache_hit", True)) / 1e3


def _environment() -> dict[str, str]:
    """What compiled the kernels, and on how many threads they ran."""
    import drjit
    import mitsuba

    llvm = ".".join(map(str, drjit.detail.llvm_version()))
    return {"variant": str(mitsuba.variant()), "llvm": llvm, "threads": str(drjit.thread_count())}
