"""`equilux score`: judge an image that someone else rendered from a scene."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from equilux.cli import inputs
from equilux.complaint import BadUsage

if TYPE_CHECKING:
    from equilux.adapter import Case

EXIT_BY_VERDICT = {"agree": 0, "diverge": 1, "not-comparable": 4}


def score(
    scene: Path,
    image: Path,
    /,
    *,
    case_filter: str | None = None,
    abs_: Annotated[float, Parameter(name="--abs")] = 0.0,
    rel: float = 0.0,
    diagnose: bool = True,
    diagnosis_timeout: float = 20.0,
    limit: Annotated[tuple[str, ...], Parameter(name="--limit", negative="")] = (),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Judge an image that someone else rendered from a scene: linear radiance, row 0 on top, against the oracle or the reference.

    What the file format leaves uncertain is counted; what the renderer leaves uncertain is stated with --abs and --rel. Exit
    code: 0 it agrees, 1 it diverges, 2 bad usage or a bad spec, 4 it cannot be compared.

    Parameters
    ----------
    scene
        The scene file.
    image
        The image: anything that OpenImageIO reads (EXR, HDR, TIFF, PNG …), or a NumPy array .npy of shape (height, width, 3).
        Integers are taken as linear, the largest as 1.
    case_filter
        Which case of a sweep; * and ? are wild; exactly one must match.
    abs_
        What the renderer leaves uncertain, W/(m² sr).
    rel
        The same, relative to the radiance.
    diagnose
        Say why the image diverges.
    diagnosis_timeout
        Seconds that the diagnosis may take.
    limit
        Raise a limit on specs, NAME=VALUE.
    json
        Print the pair's statistics as JSON.
    """
    for option, value in (("--abs", abs_), ("--rel", rel)):
        inputs.not_below_zero(option, value)
    inputs.above_zero("--diagnosis-timeout", diagnosis_timeout, "seconds")
    case = _one_case(inputs.load([scene], limit, as_json=json), case_filter)
    from equilux.score import score_image

    result = score_image(case, image, abs_=abs_, rel=rel, diagnose_within_s=diagnosis_timeout if diagnose else None).json
    for note in result["notes"]:
        sys.stderr.write(f"{image}: {note}\n")
    if json:
        inputs.print_json(result)
    else:
        sys.stdout.write(_told(case, result))
    return EXIT_BY_VERDICT[result["verdict"]]


def _one_case(loaded: Sequence[Any], case_filter: str | None) -> Case:
    from equilux.plan import filter_cases

    cases = filter_cases((case for found in loaded for case in found.cases), case_filter)
    if len(cases) > 1:
        names = ", ".join(case.name for case in cases[:5]) + (f" and {len(cases) - 5} more" if len(cases) > 5 else "")
        raise BadUsage(f"an image is of one case, got {len(cases)}: {names}; choose one with --case-filter")
    return cases[0]


def _told(case: Case, result: dict[str, Any]) -> str:
    """The verdict in words and numbers."""
    lines = [
        f"{case.name}: the image {_verdict(result['verdict'])} {result['b']}"
        + (f": {result['reason']}" if result["reason"] else "")
    ]
    lines.append(
        f"pixels: {result['agree']} agree, {result['diverge']} diverge, {result['edge']} edge, {result['invalid']} invalid, "
        f"of {result['pixels']}"
    )
    if result["max_abs"] is not None:
        lines.append(
            "difference: " + ", ".join(f"{name} {result[name]:.4g}" for name in ("max_abs", "rms", "bias", "p50", "p95", "p99"))
        )
    if (worst := result["worst"]) is not None:
        lines.append(f"worst at ({worst['x']}, {worst['y']}): image {_bands(worst['a'])}, {result['b']} {_bands(worst['b'])}")
    return "".join(f"{line}\n" for line in [*lines, *_why(result)])


def _why(result: dict[str, Any]) -> list[str]:
    """The causes in words, one line each."""
    from equilux.diagnose.diagnosis import Found
    from equilux.explain.causes import name_of
    from equilux.explain.numbers import listed, share

    lines = []
    for found in (Found.model_validate(cause) for cause in result["causes"]):
        part = f", {share(found.explained)} of the diverging pixels" if found.explained is not None else ""
        others = f"; this scene cannot tell it from {listed([name_of(other) for other in found.alternatives], 'or')}"
        words = f": {found.words}" if found.words else ""
        lines.append(f"cause: {name_of(found)}{part}{words}{others if found.alternatives else ''}")
    return lines


def _verdict(verdict: str) -> str:
    return {"agree": "agrees with the", "diverge": "diverges from the"}.get(verdict, "cannot be compared with the")


def _bands(values: Sequence[float | None]) -> str:
    return " ".join("not finite" if value is None else f"{value:.6g}" for value in values)
