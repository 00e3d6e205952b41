"""A budget on disk: one `.npz` holding the terms as JSON and every per-pixel field as an array. No pickle: a renderer's worker
wrote it."""

from __future__ import annotations

import hashlib
import io
import json
import math
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux.budget import Bound, Budget, Geometric, Sampled, Term

TERMS = "terms"


class MalformedBudget(Exception):
    """What an adapter states as its budget is not one. The message says what is wrong with which term."""


def save(budget: Budget, path: Path) -> None:
    """Write a checked budget."""
    path.write_bytes(to_bytes(budget))


def to_bytes(budget: Budget) -> bytes:
    """The budget as the bytes of an `.npz`, the same for the same budget."""
    arrays: dict[str, npt.NDArray[Any]] = {}
    terms = [_term_out(term, index, arrays) for index, term in enumerate(budget.terms)]
    arrays[TERMS] = np.frombuffer(json.dumps(terms, sort_keys=True, allow_nan=False).encode(), dtype=np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()


def load(path: Path) -> Budget:
    """Read a budget back. Raises MalformedBudget for anything but what `save` writes."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            terms = json.loads(arrays[TERMS].tobytes().decode())
            return Budget(tuple(_term_in(term, index, arrays) for index, term in enumerate(terms)))
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, zlib.error) as problem:
        raise MalformedBudget(f"{path.name}: {problem}") from problem


def digest(budget: Budget) -> str:
    """Content hash of a budget, reasons left out: rewording a reason changes no judgement."""
    arrays: dict[str, npt.NDArray[Any]] = {}
    terms = [_term_out(term, index, arrays) for index, term in enumerate(budget.terms)]
    for term in terms:
        term.pop("reason")
    sha = hashlib.sha256(json.dumps(terms, sort_keys=True).encode())
    for key in sorted(arrays):
        sha.update(
            key.encode() + str((arrays[key].dtype, arrays[key].shape)).encode() + np.ascontiguousarray(arrays[key]).tobytes()
        )
    return sha.hexdigest()


def check(budget: object, shape: tuple[int, int, int]) -> Budget:
    """Make sure that what `read` returned is a budget for an image of this shape. Raises MalformedBudget."""
    if not isinstance(budget, Budget):
        raise MalformedBudget(f"the budget is {type(budget).__name__}, expected equilux.adapter.Budget")
    for term in budget.terms:
        if isinstance(term, Bound):
            _check_field(term.name, "abs", term.abs, shape)
            _check_number(term.name, "rel", term.rel)
        elif isinstance(term, Geometric):
            for what, value in (("normal", term.normal), ("position_m", term.position_m)):
                for number in value.values() if hasattr(value, "values") else [value]:
                    _check_number(term.name, what, number)
            _check_number(term.name, "film_px", term.film_px)
        elif isinstance(term, Sampled):
            _check_field(term.name, "sigma", term.sigma, shape)
            if not isinstance(term.repeats, int) or term.repeats < 1:
                raise MalformedBudget(
                    f"budget term '{term.name}': repeats is {term.repeats!r}, expected an integer of at least 1"
                )
        else:
            raise MalformedBudget(f"the budget holds a {type(term).__name__}, expected Bound, Geometric or Sampled")
    return budget


def _check_number(term: str, what: str, value: Any) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float | np.floating) or not math.isfinite(value) or value < 0:
        raise MalformedBudget(f"budget term '{term}': {what} is {value!r}, expected a finite number of at least 0")


def _check_field(term: str, what: str, value: Any, shape: tuple[int, int, int]) -> None:
    """A number, or a finite non-negative floating array of the image's shape."""
    if not isinstance(value, np.ndarray):
        _check_number(term, what, value)
    elif value.shape != shape or not np.issubdtype(value.dtype, np.floating):
        raise MalformedBudget(
            f"budget term '{term}': {what} is {value.dtype} of shape {value.shape}, expected floats of shape {shape}"
        )
    elif not bool(np.isfinite(value).all()) or float(value.min(initial=0.0)) < 0:
        raise MalformedBudget(f"budget term '{term}': {what} holds values that are not finite or below 0")


def _term_out(term: Term, index: int, arrays: dict[str, npt.NDArray[Any]]) -> dict[str, Any]:
    def field(name: str, value: Any) -> Any:
        if isinstance(value, np.ndarray):
            arrays[f"{index}.{name}"] = value
            return {"array": f"{index}.{name}"}
        return float(value)

    def per_object(value: Any) -> Any:
        return {str(key): float(number) for key, number in value.items()} if hasattr(value, "items") else float(value)

    common = {"kind": term.kind, "name": term.name, "reason": term.reason}
    if isinstance(term, Bound):
        return common | {"abs": field("abs", term.abs), "rel": float(term.rel)}
    if isinstance(term, Geometric):
        return common | {
            "normal": per_object(term.normal),
            "position_m": per_object(term.position_m),
            "film_px": float(term.film_px),
        }
    return common | {"sigma": field("sigma", np.asarray(term.sigma)), "repeats": term.repeats}


def _term_in(term: dict[str, Any], index: int, arrays: Any) -> Term:
    def field(value: Any) -> Any:
        return arrays[value["array"]] if isinstance(value, dict) else float(value)

    def per_object(value: Any) -> Any:
        return {int(key): float(number) for key, number in value.items()} if isinstance(value, dict) else float(value)

    kind, name, reason = term["kind"], str(term["name"]), str(term["reason"])
    if kind == "bound":
        return Bound(name, reason, abs=field(term["abs"]), rel=float(term["rel"]))
    if kind == "geometric":
        return Geometric(name, reason, per_object(term["normal"]), per_object(term["position_m"]), float(term["film_px"]))
    if kind == "sampled":
        return Sampled(name, reason, field(term["sigma"]), int(term["repeats"]))
    raise ValueError(f"term {index} is of the unknown kind {kind!r}")
