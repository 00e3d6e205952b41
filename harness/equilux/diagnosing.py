"""Diagnosing the renders of a case: what a diagnosis is made from, and which one can be taken from an earlier run."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from equilux import uncertainty
from equilux.adapter import Budget, Case, Geometric
from equilux.compare import PairResult, RenderedImage
from equilux.diagnose.diagnosis import Diagnosis
from equilux.dialect import Declared, dialect_on
from equilux.identity import case_digest, diagnoser_identity
from equilux.planes import read_planes
from equilux.reuse import Store, key
from equilux.tree import Tree, read_json
from equilux.uncertainty import Uncertainty
from equilux.wholefile import write_json

if TYPE_CHECKING:
    from equilux_tracer.causes import Rule

DIAGNOSIS_FILE = "diagnosis.json"
TIME_LIMIT_S = 20.0
"""Default of how long one render may be diagnosed: a run must not wait for what nobody can name."""


@dataclass(frozen=True)
class Method:
    """How a run diagnoses. dialects: what each adapter declares, by its name. time_limit_s: per render."""

    dialects: Mapping[str, tuple[Declared, ...]] = field(default_factory=dict)
    time_limit_s: float = TIME_LIMIT_S


@dataclass(frozen=True)
class Subject:
    """A render that diverges from the truth. digest, truth_digest: hashes of both images with their budgets. scored: the pair's
    statistics and planes. budget: None where it is not known any more. expected: the causes that the scene expects of it."""

    side: RenderedImage
    digest: str
    truth: RenderedImage
    truth_digest: str
    scored: Callable[[], PairResult]
    budget: Callable[[], Budget | None]
    expected: tuple[str, ...] = ()


def known_rules() -> Mapping[str, Rule]:
    """Every cause that can be proven: contracts §5, and third parties'."""
    from equilux.diagnose.catalogue import all_rules

    return all_rules()


def unusable_rules() -> tuple[str, ...]:
    """One line for each third party's cause that cannot be used, and why."""
    from equilux.diagnose.catalogue import broken_rules

    return broken_rules()


def diagnosed(case: Case, subject: Subject, method: Method, store: Store | None, tree: Tree) -> Diagnosis:
    """The diagnosis of one render, from the store or made now. One that may find more in the next run is not remembered."""
    rules = known_rules()
    dialect = dialect_on(case, method.dialects.get(subject.side.adapter, ()), rules)
    its_key = key(
        what="diagnosis",
        case=case_digest(case),
        adapter=subject.side.adapter,
        image=subject.digest,
        truth=[subject.truth.adapter, subject.truth_digest],
        dialect=[str(applied) for applied in dialect],
        expected=sorted(subject.expected),
        time_limit_s=method.time_limit_s,
        code=diagnoser_identity(rules),
    )
    folder = tree.stage()
    try:
        if store is not None and store.fetch("diagnoses", its_key, folder):
            earlier = read_json(folder / DIAGNOSIS_FILE)
            if earlier is not None:
                return Diagnosis.model_validate(earlier)
        found = _diagnose(case, subject, method, dialect, rules)
        if store is not None and not may_find_more(found, method.time_limit_s):
            store.put("diagnoses", its_key, lambda entry: save(found, entry))
        return found
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def may_find_more(found: Diagnosis, time_limit_s: float) -> bool:
    """Whether it ran out of time with something unexplained: another day the machine may have more of it."""
    return found.seconds >= time_limit_s and any(cause.id == "unexplained" for cause in found.causes)


def _diagnose(case: Case, subject: Subject, method: Method, dialect: Sequence[Any], rules: Mapping[str, Rule]) -> Diagnosis:
    from equilux.diagnose import search

    return search.diagnose(
        case,
        subject.side,
        subject.truth,
        subject.scored(),
        restate=restating(subject.side, subject.budget()),
        dialect=dialect,
        expected=subject.expected,
        rules=rules,
        time_limit_s=method.time_limit_s,
    )


def restating(side: RenderedImage, budget: Budget | None) -> Callable[[Any], Uncertainty] | None:
    """What the render's uncertainty would be if the renderer were the tracer that is given; None where it would be the same.

    Only geometric terms depend on it: how far a wrong normal moves the radiance is another question under other rules.
    """
    if budget is None or not any(isinstance(term, Geometric) and (term.normal or term.position_m) for term in budget.terms):
        return None
    return lambda tracer: uncertainty.stated(budget, side.image, tracer)


def scored_pair(pair: Mapping[str, Any], pairs_folder: Path) -> PairResult:
    """A pair as `compare_pair` gave it, from its files in the tree."""
    planes: dict[str, Any] = dict(read_planes(pairs_folder / f"{pair['a']}--{pair['b']}.exr"))
    planes["class"] = planes["class"].astype(np.uint8)
    return PairResult(dict(pair), planes)


def save(diagnosis: Diagnosis | None, folder: Path) -> None:
    """Write, or where there is none remove, the diagnosis in a render's folder."""
    if diagnosis is None:
        (folder / DIAGNOSIS_FILE).unlink(missing_ok=True)
    else:
        write_json(folder / DIAGNOSIS_FILE, diagnosis.model_dump(mode="json"))


def load(folder: Path) -> Diagnosis | None:
    """The diagnosis in a render's folder, None where there is none. Raises ValueError for a file that is none."""
    content = read_json(folder / DIAGNOSIS_FILE)
    return None if content is None else Diagnosis.model_validate(content)
