"""How long the shipped corpus takes through every renderer, beside what it cannot take less than; and once more with nothing
changed."""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from bench.measured import Measured
from bench.processes import Cost, run
from equilux.machine import available_cores

DELIVERED_EXITS = (0, 1)
"""A run that did its work, whatever came of it."""


def measure() -> Measured:
    """Cold: an empty store, no results tree. Warm: the same command again. Stored: once more without the tree, from the store.
    All with the report, as a user types it.

    `suite_vs_bound`: the cold run's wall over the larger of Σ CPU / cores (of the engine, its workers and their renderers) and
    the longest chain of one case: its slowest render, then its diagnoses. `warm_vs_cold`: wall over wall.
    """
    cores = available_cores()
    with tempfile.TemporaryDirectory(prefix="equilux-bench-") as scratch:
        tree = Path(scratch) / "run"
        command = [sys.executable, "-m", "equilux", "run", "--out", str(tree)]
        environment = {"EQUILUX_CACHE": str(Path(scratch) / "cache"), "PYTHONDONTWRITEBYTECODE": ""}  # as a user's Python
        cold = _checked(run(command, environment, cores=cores))
        chain, whose = longest_chain(tree)
        warm = _checked(run(command, environment, cores=cores))
        reused = _reused(tree)
        shutil.rmtree(tree)
        stored = _checked(run(command, environment, cores=cores))
    bound = max(cold.cpu_s / cores, chain)
    ratios = {"suite_vs_bound": cold.wall_s / bound, "warm_vs_cold": warm.wall_s / cold.wall_s}
    numbers = {
        "cores": cores, "longest_chain_s": chain, "longest_chain": whose, "bound_s": bound, "warm_reused": reused,
        "warm_vs_cold_cpu": warm.cpu_s / cold.cpu_s, "cold": _json(cold), "warm": _json(warm),
        "stored": _json(stored),
    }  # fmt: skip
    return Measured("suite", ratios, numbers, [
        f"cold: wall {cold.wall_s:.1f} s, Σ CPU {cold.cpu_s:.1f} s on {cores} cores, longest chain {chain:.1f} s ({whose}), "
        f"bound {bound:.1f} s; fewer than {cores} threads ready {100 * cold.starved:.0f} % of the time",
        f"warm: wall {warm.wall_s:.2f} s, CPU {warm.cpu_s:.2f} s ({100 * warm.cpu_s / cold.cpu_s:.1f} % of the cold run's), "
        f"{reused}",
        f"without the tree, from the store: wall {stored.wall_s:.1f} s, CPU {stored.cpu_s:.1f} s",
    ])  # fmt: skip


def longest_chain(tree: Path) -> tuple[float, str]:
    """Seconds that one case must take whatever the number of cores, and its name: the slowest of its renders, then the diagnoses
    of those that diverge, one after the other. By the run's own clocks."""
    chains = []
    for case in sorted((tree / "cases").iterdir()):
        renders = [sum(_read(path)["seconds"].values()) for path in case.glob("*/render.json")]
        diagnoses = [_read(path)["seconds"] for path in case.glob("*/diagnosis.json")]
        chains.append((max(renders, default=0.0) + sum(diagnoses), case.name))
    return max(chains, default=(0.0, "no case"))


def _checked(cost: Cost) -> Cost:
    if cost.status not in DELIVERED_EXITS:
        raise RuntimeError(f"equilux run ended with {cost.status}: {cost.output[-2000:]}")
    return cost


def _reused(tree: Path) -> str:
    """What the run says of itself, in words."""
    renders = [render for case in _read(tree / "results.json")["cases"] for render in case["renders"].values()]
    delivered = [render for render in renders if render["seconds"]]
    return f"{sum(render['reused'] for render in delivered)} of {len(delivered)} renders reused"


def _json(cost: Cost) -> dict[str, Any]:
    return {"wall_s": cost.wall_s, "cpu_s": cost.cpu_s, "peak_bytes": cost.peak_bytes, "starved": cost.starved}


def _read(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))
