"""Run the program: evaluate the closed form in this very process, which the engine has made for it."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from equilux.adapter import Program, RawRender
from equilux_oracle import radiance_with_bound
from equilux_oracle.__main__ import case_from_json

RADIANCE, BOUND = "radiance.npy", "bound.npy"


def evaluate(program: Program, program_dir: Path, workdir: Path) -> RawRender:
    """Write the picture and its bound as float64 arrays."""
    case = case_from_json((program_dir / program.entry).read_bytes())
    began = time.perf_counter()
    picture, bound = radiance_with_bound(case)
    seconds = time.perf_counter() - began
    np.save(workdir / RADIANCE, picture)
    np.save(workdir / BOUND, bound)
    return RawRender({name: workdir / name for name in (RADIANCE, BOUND)}, {"start": 0.0, "render": seconds})
