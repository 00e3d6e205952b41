"""The whole mutation suite: every mutant, every unmutated case, every broken picture, on all cores.

    python -m mutation.suite [--out docs/mutation.md] [--json FILE] [--only TEXT] [--no-naming]        (in tests/)

Prints the figures, writes the document, and exits 1 where a demand is not met.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from equilux.compare import compare_pair
from equilux_scenes.case import Case
from mutation import rivals
from mutation.broken import passed
from mutation.mutant import Mutant
from mutation.paired_faults import PAIRED_FAULTS
from mutation.scenes import corpus, stages
from mutation.single_faults import SINGLE_FAULTS
from mutation.trial import Trial, staged, trials
from support import random_raytraced, random_scenes

MUTANTS: dict[str, Mutant] = {mutant.name: mutant for mutant in (*SINGLE_FAULTS, *PAIRED_FAULTS)}


@dataclass
class Results:
    """What the suite found. false_alarms: unmutated cases that diverged; rival_alarms: how many a tool refused; passed: broken
    pictures that were let through.
    """

    trials: list[Trial] = field(default_factory=list)
    unmutated: int = 0
    false_alarms: list[str] = field(default_factory=list)
    rival_alarms: dict[str, int] = field(default_factory=dict)
    broken: int = 0
    passed: list[str] = field(default_factory=list)

    def to_json(self) -> dict[str, Any]:
        return {**vars(self), "trials": [trial.to_json() for trial in self.trials]}


# --- the parts --------------------------------------------------------------------------------------------------------


def unmutated_cases() -> Iterator[Case]:
    """All of the corpus that the plain renderer can draw, stages, and random scenes."""
    yield from corpus().values()
    for variant in ("", "parallel"):
        yield from stages(("phong", "opengl", "raytraced"), variant, 4)
    yield from stages(("raytraced",), "pool", 4)
    for seed in range(20):
        yield random_scenes.case_of(random_scenes.random_spec(7000 + seed, film=(32, 24)))
        yield random_scenes.case_of(random_raytraced.random_raytraced(7000 + seed, film=(32, 24)))


def mutant_trials(name: str, *, naming: bool) -> list[Trial]:
    """All trials of one mutant, with what other tools say."""
    done = []
    for trial, on, image in trials(MUTANTS[name], name=naming):
        trial.rivals = rivals.let_through(on.side(image).image, on.truth.image.astype("float32"))
        done.append(trial)
    return done


def false_alarm(index: int) -> tuple[str | None, list[str]]:
    """One unmutated case: its name if it diverges, and which other tools refuse it."""
    case = _CASES[index]
    on = staged(case)
    side = on.side(on.right)
    verdict = compare_pair(side, on.truth, on.tracer).json["verdict"]
    refused = [tool for tool, passes in rivals.let_through(side.image, on.truth.image.astype("float32")).items() if not passes]
    return (None if verdict == "agree" else case.name), refused


def broken_passed(names: tuple[str, str]) -> tuple[int, list[str]]:
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        tried, wrong = passed(corpus()[names[0]], corpus()[names[1]], Path(folder))
    return tried, [f"{names[0]}: {name}" for name in wrong]


BROKEN_ON = ("clay-ball", "two-lights", "all-terms", "opengl-all-terms", "mirror-sphere", "glass-sphere", "diffuse-only")
_CASES: list[Case] = []


def _start() -> None:
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _CASES[:] = unmutated_cases()


def run(only: str = "", *, naming: bool = True, jobs: int | None = None) -> Results:
    """Mutants whose name holds `only`; with all of them the unmutated cases and broken pictures too."""
    names = [name for name in MUTANTS if only in name]
    results = Results()
    context = multiprocessing.get_context("forkserver")
    with ProcessPoolExecutor(jobs or os.cpu_count(), context, _start) as pool:  # not multiprocessing.Pool: FLIP needs a child
        if not only:
            _unmutated(results, pool)
            available = [name for name in BROKEN_ON if name in corpus()]
            chains = list(zip(available, available[1:] + available[:1], strict=True))
            for tried, wrong in pool.map(broken_passed, chains):
                results.broken += tried
                results.passed += wrong
        found = pool.map(partial(mutant_trials, naming=naming), names)
        for name, some in zip(names, found, strict=True):
            _tell(name, some)
            results.trials += some
    return results


def _unmutated(results: Results, pool: Executor) -> None:
    count = len(list(unmutated_cases()))
    results.rival_alarms = dict.fromkeys(rivals.NAMES, 0)
    for alarm, refused in pool.map(false_alarm, range(count)):
        results.unmutated += 1
        results.false_alarms += [alarm] if alarm else []
        for tool in refused:
            results.rival_alarms[tool] += 1
    print(f"{count} unmutated: {len(results.false_alarms)} diverge", file=sys.stderr, flush=True)


def _tell(name: str, some: list[Trial]) -> None:
    """Progress, and what went wrong."""
    detected, named = sum(trial.detected for trial in some), sum(trial.named for trial in some)
    slowest = max((trial.seconds for trial in some), default=0.0)
    lines = [f"{name}: {len(some)} scenes, {detected} detected, {named} named, slowest diagnosis {slowest:.1f} s"]
    for trial in some:
        if not trial.named and trial.found:
            lines.append(f"    {trial.case}, {trial.visible} pixels, explained {trial.explained:.3f}: {trial.found}")
    print("\n".join(lines), file=sys.stderr, flush=True)


def main(tell: Callable[[str], None] = print) -> int:
    from mutation import document

    parser = argparse.ArgumentParser(description="run the mutation suite")
    parser.add_argument("--out", type=Path, help="document to write")
    parser.add_argument("--json", type=Path, help="write every trial")
    parser.add_argument("--only", default="", help="mutants whose name holds this")
    parser.add_argument("--no-naming", action="store_true", help="detection alone")
    parser.add_argument("--jobs", type=int)
    asked = parser.parse_args()
    results = run(asked.only, naming=not asked.no_naming, jobs=asked.jobs)
    if asked.json:
        asked.json.write_text(json.dumps(results.to_json(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    tell(document.summary(results))
    if asked.out:
        asked.out.write_text(document.page(results), encoding="utf-8")
    return 1 if document.unmet(results) else 0


if __name__ == "__main__":
    sys.exit(main())
