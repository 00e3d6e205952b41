"""Runs a script in the engine's long-lived worker: VTK is imported once, everything else is made afresh for every picture."""

from __future__ import annotations

import runpy
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from equilux.adapter import Limits, Program, RawRender, RendererFailed
from equilux_adapters.vtk.knobs import VtkKnobs
from equilux_adapters.vtk.translate import is_limited

IMAGE = "image.npy"
CENTRES = "centres.npy"
"""Radiance at the pixels' centres, where the image's pixels are means of samples."""


def render(program: Program, program_dir: Path, workdir: Path, limits: Limits, knobs: VtkKnobs) -> RawRender:
    """Execute the saved script itself. Raises RendererFailed with what VTK said."""
    try:
        seconds = {"start": _start()}
        before = time.perf_counter()
        made = runpy.run_path(str(program_dir / program.entry), run_name="scene")["picture"]()
    except Exception as error:
        raise RendererFailed(f"{program.entry}: {type(error).__name__}: {error}") from error
    seconds["render"] = time.perf_counter() - before
    if not is_limited(knobs):
        image, capabilities = made
        np.save(workdir / IMAGE, image)
        return RawRender({IMAGE: workdir / IMAGE}, seconds, environment=_environment(capabilities))
    pictures = {IMAGE: made.pixels} if made.centres is None else {IMAGE: made.pixels, CENTRES: made.centres}
    for name, pixels in pictures.items():
        np.save(workdir / name, pixels)
    files = {name: workdir / name for name in pictures}
    return RawRender(files, seconds, data={"full_scale": made.full_scale}, environment=_environment(made.capabilities))


def _start() -> float:
    """Import VTK and make a first context, once per worker; seconds."""
    if "vtkmodules.vtkRenderingOpenGL2" in sys.modules:
        return 0.0
    before = time.perf_counter()
    from vtkmodules.vtkCommonCore import vtkOutputWindow

    from equilux_adapters.vtk.kit import stage

    output = vtkOutputWindow.GetInstance()
    output.SetDisplayModeToAlwaysStdErr()
    stage.offscreen_window(8, 8).Finalize()
    return time.perf_counter() - before


def _environment(capabilities: str) -> Mapping[str, str]:
    """What OpenGL says of itself, and which window VTK drew into."""
    found = dict(line.split(" string:", 1) for line in capabilities.splitlines() if " string:" in line)
    result = {key.lower().replace(" ", "_"): value.strip() for key, value in found.items() if key.startswith("OpenGL")}
    return result | {"window": "EGL" if any(key.startswith("EGL") for key in found) else "OSMesa"}
