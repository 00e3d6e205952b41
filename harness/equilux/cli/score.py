"""`equilux score`: judge an image that someone else rendered from a scene."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from equilux.cli import inputs
from equilux.complaint import BadUsage

if TYPE_CHECKING:
    from equilux.adapter import Case
    from equilux.compare import RenderedImage

NAME = "image"
EXIT_BY_VERDICT = {"agree": 0, "diverge": 1, "not-comparable": 4}


def score(
    scene: Path,
    image: Path,
    *,
    case_filter: str | None = None,
    abs_: Annotated[float, Parameter(name="--abs")] = 0.0,
    rel: float = 0.0,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="")] = (),
    timeout: float = 120.0,
    limit: Annotated[tuple[str, ...], Parameter(name="--limit", negative="")] = (),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Judge an image that someone else rendered from a scene: linear radiance, row 0 on top, against the oracle or the reference.

    What the file format leaves uncertain is counted; what the renderer leaves uncertain is stated with --abs and --rel. Exit
    code: 0 it agrees, 1 it diverges, 2 bad usage or a bad spec, 3 there is no truth to judge against, 4 it cannot be compared.

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
    set_
        A knob of the oracle or the reference, [ADAPTER.]KNOB=VALUE.
    timeout
        Seconds that rendering the truth may take.
    limit
        Raise a limit on specs, NAME=VALUE.
    json
        Print the pair's statistics as JSON.
    """
    inputs.above_zero("--timeout", timeout, "seconds")
    for option, value in (("--abs", abs_), ("--rel", rel)):
        inputs.not_below_zero(option, value)
    case = _one_case(inputs.load([scene], limit, as_json=json), case_filter)
    judged = _read(image, abs_, rel)
    with tempfile.TemporaryDirectory(prefix="equilux-score-") as folder:
        truth = _truth(case, set_, timeout, Path(folder) / "run")
    if truth is None:
        return 3
    from equilux.compare import compare_pair
    from equilux.lazytracer import LazyTracer

    result = compare_pair(judged, truth, LazyTracer(case)).json
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


def _read(image: Path, abs_: float, rel: float) -> RenderedImage:
    from equilux.adapter import Bound, Budget
    from equilux.compare import RenderedImage
    from equilux.score import read_image
    from equilux.uncertainty import stated

    found = read_image(image)
    for note in found.notes:
        sys.stderr.write(f"{image}: {note}\n")
    own = Bound("stated", "given on the command line", abs=abs_, rel=rel)
    return RenderedImage(NAME, found.image, stated(Budget((*found.budget.terms, own)), found.image))


def _truth(case: Case, settings: tuple[str, ...], timeout: float, out: Path) -> RenderedImage | None:
    """The most trusted render of the case; None, having said why, when there is none."""
    from equilux import knobs, plan
    from equilux.adapter import Limits
    from equilux.casework import MAPS_FILE, saved_picture
    from equilux.compare import RenderedImage
    from equilux.registry import Registry
    from equilux.reuse import Store, default_root
    from equilux.run import Options, execute
    from equilux.tree import read_json
    from equilux.trust import TRUTHS, truth_among
    from equilux.uncertainty import Uncertainty

    registry = Registry.discover()
    selection = plan.select_adapters(registry, [name for name in TRUTHS if name in registry.entries])
    planned = plan.make_plan([case], selection, knobs.resolve(settings, selection.entries))
    (record,) = execute(planned, Options(out=out, limits=Limits(timeout), store=Store(default_root()))).results.cases
    best = truth_among(name for name, render in record.renders.items() if render.status == "ok")
    if best is None:
        for name, render in record.renders.items():
            sys.stderr.write(f"{case.name}: {name} {render.status}: {render.reason}\n")
        return None
    folder = out / "cases" / case.directory_name / best
    rendered = read_json(folder / "render.json") or {}
    return RenderedImage(best, saved_picture(folder), Uncertainty.from_json(rendered["uncertainty"], folder / MAPS_FILE))


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
    return "".join(f"{line}\n" for line in lines)


def _verdict(verdict: str) -> str:
    return {"agree": "agrees with the", "diverge": "diverges from the"}.get(verdict, "cannot be compared with the")


def _bands(values: Sequence[float | None]) -> str:
    return " ".join("not finite" if value is None else f"{value:.6g}" for value in values)
