"""python -m bench [NAME …] [--out FILE]: measure, print the ratios, write build/bench.json."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from bench.measured import Measured
from bench.record import DEMANDED, holds, write

MEASUREMENTS = ("rays", "features", "raytraced", "compare", "suite", "growth")
"""Modules of this package, each with `measure() -> Measured`, in the order in which they are made."""


def main(arguments: list[str] | None = None) -> int:
    """Make the measurements that are named, or all. Exit 1: one could not be made. How a ratio came out fails nothing."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", choices=[*MEASUREMENTS, []], help=", ".join(MEASUREMENTS))
    parser.add_argument("--out", type=Path, default=Path("build/bench.json"), help="default: %(default)s")
    given = parser.parse_args(arguments)
    failed = 0
    for name in given.names or MEASUREMENTS:
        print(f"{name} …", flush=True)
        try:
            measured: Measured = importlib.import_module(f"bench.{name}").measure()
        except Exception as problem:  # the others are measured all the same
            print(f"  not measured: {type(problem).__name__}: {problem}", flush=True)
            failed += 1
            continue
        for line in measured.lines:
            print(f"  {line}", flush=True)
        for key, value in measured.ratios.items():
            print(f"  {key} = {value:.3g}{_demand(key, value)}", flush=True)
        write(given.out, [measured])  # one by one: what was measured outlives what comes after
    print(f"written: {given.out}")
    return 1 if failed else 0


def _demand(name: str, value: float) -> str:
    if name not in DEMANDED:
        return ""
    sense, limit = DEMANDED[name]
    return f" ({'met' if holds(name, value) else 'NOT MET'}: {sense} {limit:g})"


if __name__ == "__main__":
    sys.exit(main())
