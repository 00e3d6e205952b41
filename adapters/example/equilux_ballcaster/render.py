"""Runs ballcaster on a translated scene. The engine has put this code into a worker process: a hang or a crash costs one case."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

from equilux.adapter import Limits, Program, RawRender, RendererCrashed, RendererFailed, RendererTimedOut


def render(program: Program, program_dir: Path, workdir: Path, limits: Limits) -> RawRender:
    """Raises RendererTimedOut, RendererCrashed with the signal, or RendererFailed with what ballcaster said."""
    picture = workdir / "picture.pfm"
    command = [sys.executable, "-m", "equilux_ballcaster.ballcaster", str(program_dir / program.entry), str(picture)]
    started = time.perf_counter()
    try:
        done = subprocess.run(command, cwd=workdir, capture_output=True, text=True, timeout=limits.timeout_s, check=False)
    except subprocess.TimeoutExpired:
        raise RendererTimedOut(f"ballcaster ran for more than {limits.timeout_s:g} s") from None
    if done.returncode < 0:
        raise RendererCrashed(f"ballcaster was ended by signal {-done.returncode}", signal=-done.returncode)
    if done.returncode or not picture.exists():
        raise RendererFailed(f"ballcaster exited with {done.returncode}: {done.stderr.strip()[-500:]}")
    return RawRender(files={"picture": picture}, seconds={"render": time.perf_counter() - started})
