"""A budget survives the way from a worker to the engine, and nothing else passes for one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from equilux import budget_file
from equilux.adapter import Bound, Budget, Geometric, Sampled

SHAPE = (2, 3, 3)
FIELD = np.arange(18, dtype=np.float64).reshape(SHAPE)
FULL = Budget((
    Bound("storage", "float32", abs=1e-9, rel=2.0**-24),
    Bound("arithmetic", "per pixel", abs=FIELD),
    Geometric("tessellation", "sagitta", normal={0: 1e-3, 2: 2e-3}, position_m=1e-4, film_px=0.01),
    Sampled("noise", "32 repeats", sigma=FIELD.astype(np.float32), repeats=32),
))  # fmt: skip


def test_a_budget_comes_back_as_it_was(tmp_path: Path):
    budget_file.save(FULL, tmp_path / "budget.npz")
    back = budget_file.load(tmp_path / "budget.npz")
    assert budget_file.digest(back) == budget_file.digest(FULL)
    assert back.terms[0] == FULL.terms[0]
    assert back.terms[2] == FULL.terms[2]
    assert np.array_equal(back.terms[1].abs, FIELD)  # type: ignore[union-attr]
    assert back.terms[3].sigma.dtype == np.float32  # type: ignore[union-attr]


@pytest.mark.parametrize("content", [b"", b"not a zip", b"PK\x03\x04 half a zip"])
def test_bytes_that_are_no_budget_are_refused(tmp_path: Path, content: bytes):
    (tmp_path / "budget.npz").write_bytes(content)
    with pytest.raises(budget_file.MalformedBudget):
        budget_file.load(tmp_path / "budget.npz")


def test_a_pickle_is_never_opened(tmp_path: Path):
    np.savez(tmp_path / "budget.npz", terms=np.array([{"evil": print}], dtype=object))
    with pytest.raises(budget_file.MalformedBudget):
        budget_file.load(tmp_path / "budget.npz")


@pytest.mark.parametrize(
    ("budget", "says"),
    [
        (None, "the budget is NoneType"),
        (Budget(("abs",)), "the budget holds a str"),  # type: ignore[arg-type]
        (Budget((Bound("b", "", abs=-1.0),)), "'b': abs is -1.0, expected a finite number of at least 0"),
        (Budget((Bound("b", "", rel=float("nan")),)), "'b': rel is nan"),
        (Budget((Bound("b", "", abs=np.zeros((2, 3))),)), "abs is float64 of shape (2, 3), expected floats of shape (2, 3, 3)"),
        (Budget((Bound("b", "", abs=np.full(SHAPE, np.inf)),)), "'b': abs holds values that are not finite or below 0"),
        (Budget((Bound("b", "", abs=np.zeros(SHAPE, int)),)), "'b': abs is int64"),
        (Budget((Geometric("g", "", normal={0: -1.0}),)), "'g': normal is -1.0"),
        (Budget((Geometric("g", "", film_px=float("inf")),)), "'g': film_px is inf"),
        (Budget((Sampled("s", "", sigma=FIELD, repeats=0),)), "'s': repeats is 0"),
    ],
)  # fmt: skip
def test_a_malformed_budget_says_which_term_and_what_is_expected(budget: Any, says: str):
    with np.errstate(invalid="ignore"), pytest.raises(budget_file.MalformedBudget) as problem:
        budget_file.check(budget, SHAPE)
    assert says in str(problem.value)
