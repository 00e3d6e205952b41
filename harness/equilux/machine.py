"""What a run was made with: versions and machine, for run.json. No paths and no names of people or hosts."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from typing import Any

LIBRARIES = ("numpy", "pydantic", "OpenImageIO", "ruamel.yaml", "psutil", "mpmath", "flip-evaluator")


def version_of_equilux() -> str:
    return importlib.metadata.version("equilux")


def library_versions() -> dict[str, str]:
    """Installed versions of what takes part in the numbers, and of what the tracer is built on."""
    found = {}
    for name in LIBRARIES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    try:
        import equilux_tracer

        found |= {"equilux_tracer": str(equilux_tracer.VERSION), "Embree": str(equilux_tracer.EMBREE_VERSION)}
    except (ImportError, AttributeError):
        found["equilux_tracer"] = "not built"
    return found


def available_cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)


def usable_memory() -> int:
    """Bytes that one render may hold by default: 8 GiB, or four fifths of the machine's where that is less."""
    import psutil

    return int(min(8 << 30, 0.8 * psutil.virtual_memory().total))


def describe_machine() -> dict[str, Any]:
    import psutil

    return {
        "system": platform.system(),
        "release": platform.release(),
        "architecture": platform.machine(),
        "processor": _processor(),
        "cores": available_cores(),
        "memory_bytes": psutil.virtual_memory().total,
        "python": platform.python_version(),
    }


def _processor() -> str:
    """The processor's model, as Linux tells it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as lines:
            return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.processor())
    except OSError:
        return platform.processor()
