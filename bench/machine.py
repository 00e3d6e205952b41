"""What the numbers were measured on."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

from equilux.machine import describe_machine, library_versions, version_of_equilux

INSTRUCTION_SETS = ("sse4_2", "avx", "fma", "avx2", "avx512f", "neon", "asimd")


def describe() -> dict[str, Any]:
    """Processor, cores and what it can do; versions; how busy it was, and when. No paths and no names."""
    return {
        **describe_machine(),
        "instruction_sets": [name for name in INSTRUCTION_SETS if name in _flags()],
        "load_1min": round(os.getloadavg()[0], 2),
        "equilux": version_of_equilux(),
        "libraries": library_versions(),
        "at": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }


def _flags() -> frozenset[str]:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return frozenset()
    found = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return frozenset(found.partition(":")[2].split())
