"""Where LLVM is, with which Mitsuba compiles its kernels."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from glob import glob

ENVIRONMENT = "DRJIT_LIBLLVM_PATH"

OLDEST = 17
"""Older ones know no fmaximum on x86, and end the process (Q14)."""

FOLDERS = ("/usr/lib/*-linux-gnu", "/usr/lib64", "/usr/lib", "/usr/local/lib", "/usr/lib/llvm-*/lib")


def find_llvm() -> str | None:
    """What the environment names, else the newest that will do; None where there is none. Loads nothing."""
    if named := os.environ.get(ENVIRONMENT):
        return named if os.path.exists(named) else None
    return newest(path for folder in FOLDERS for path in glob(f"{folder}/libLLVM*"))


def newest(paths: Iterable[str]) -> str | None:
    """By the version in the file's name, as distributions write it: libLLVM.so.19.1, libLLVM-17.so.1, libLLVM-19.so."""
    known = {path: int(found[1]) for path in paths if (found := re.search(r"libLLVM(?:\.so\.|-)(\d+)", path))}
    best = max(known.values(), default=0)
    return min((path for path in known if known[path] == best), key=lambda path: (len(path), path)) if best >= OLDEST else None
