"""What a results tree holds of a pair: its record, both renders, their diagnoses, and the pictures at one pixel."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from equilux.complaint import BadUsage, nearest
from equilux.diagnose.diagnosis import Diagnosis
from equilux.explain.pixel import CLASSES, NOT_FINITE, Bands, PixelFacts, SidePixel, pixel_facts
from equilux.explain.sentences import Told
from equilux.readrun import ReadRun
from equilux.results import CaseRecord, PairRecord
from equilux.tree import read_json
from equilux.trust import ordered_pair


@dataclass(frozen=True)
class NoPair:
    """Two renders that were not compared, and why."""

    case: CaseRecord
    a: str
    b: str
    why: tuple[str, ...]


def find_case(run: ReadRun, wanted: str) -> CaseRecord:
    """The case of this name, or the only one that matches; `*` and `?` are wild. Raises BadUsage."""
    by_name = {case.case: case for case in run.results.cases}
    if wanted in by_name:
        return by_name[wanted]
    matching = [name for name in by_name if _matches(name, wanted)]
    if len(matching) == 1:
        return by_name[matching[0]]
    if matching:
        raise BadUsage(f"CASE: '{wanted}' matches {len(matching)} cases, allowed one: {_some(matching)}")
    of_scene = [name for name, case in by_name.items() if case.scene == wanted]
    if len(of_scene) == 1:
        return by_name[of_scene[0]]
    if of_scene:
        raise BadUsage(f"CASE: '{wanted}' is a scene of {len(of_scene)} cases, allowed one of them: {_some(of_scene)}")
    hint = nearest(wanted, by_name) or _begun(wanted, by_name)
    held = (
        f"one of the {len(by_name)} cases of '{run.root}': {_some(list(by_name))}"
        if by_name
        else f"none: '{run.root}' holds no case"
    )
    raise BadUsage(f"CASE: got '{wanted}', allowed {held}{hint}")


def _matches(name: str, pattern: str) -> bool:
    """As --case-filter: only * and ? are wild, brackets are not."""
    expression = "".join({"*": ".*", "?": "."}.get(letter, re.escape(letter)) for letter in pattern)
    return ("*" in pattern or "?" in pattern) and re.fullmatch(expression, name, re.DOTALL) is not None


def _begun(wanted: str, names: Iterable[str]) -> str:
    """Names that contain what was given, or begin with the scene of it."""
    scene = wanted.partition("[")[0]
    near = [name for name in names if wanted and (wanted in name or name.partition("[")[0] == scene)]
    near = near or [name for name in names if fnmatch.fnmatch(name, f"{scene}*")] if scene else near
    return f" (did you mean {' or '.join(repr(name) for name in near[:3])}?)" if near else ""


def _some(names: Sequence[str], shown: int = 5) -> str:
    return ", ".join(names[:shown]) + (f" and {len(names) - shown} more" if len(names) > shown else "")


def find_pair(case: CaseRecord, one: str, other: str) -> PairRecord | NoPair:
    """The pair of two adapters, named in either order. Raises BadUsage for adapters that took no part in the case."""
    complaints = [
        f"{role}: got '{name}', allowed an adapter of {case.case}: {', '.join(case.renders)}{nearest(name, case.renders)}"
        for role, name in (("A", one), ("B", other))
        if name not in case.renders
    ]
    if complaints:
        raise BadUsage(*complaints)
    if one == other:
        others = ", ".join(name for name in case.renders if name != one)
        raise BadUsage(f"B: got '{other}' twice, allowed another adapter than A: {others or 'none, the case has only this one'}")
    a, b = ordered_pair(one, other)
    for pair in case.pairs:
        if {pair.a, pair.b} == {a, b}:
            return pair
    why = []
    for name in (a, b):
        render = case.renders[name]
        if render.status not in ("ok", "invalid"):
            what = f" ({', '.join(render.missing_features)})" if render.missing_features and not render.reason else ""
            signal = f" by signal {render.signal}" if render.signal else ""
            why.append(f"{name} brought no picture: {render.status}{signal}{f': {render.reason}' if render.reason else ''}{what}")
    return NoPair(case, a, b, tuple(why) or ("both delivered, and no comparison of them is in the results",))


def gather(run: ReadRun, case: CaseRecord, pair: PairRecord) -> Told:
    """Everything beside results.json that a results tree holds of a pair. What is missing or damaged is left out."""
    worst = None
    if pair.worst is not None:
        try:
            worst = read_pixel(run, case, pair, pair.worst.x, pair.worst.y)
        except (OSError, ValueError, KeyError, TypeError):
            worst = None
    return Told(
        worst=worst,
        statistics=read_json(run.pair_file(case.case, pair.a, pair.b, "json")) or {},
        diagnoses={name: found for name in (pair.a, pair.b) if (found := _diagnosis(run, case.case, name)) is not None},
        programs={name: entry for name in (pair.a, pair.b) if (entry := _program(run, case.case, name)) is not None},
        run=str(run.root),
    )


def _diagnosis(run: ReadRun, case: str, adapter: str) -> Diagnosis | None:
    content = read_json(run.render_folder(case, adapter) / "diagnosis.json")
    try:
        return Diagnosis.model_validate(content) if content is not None else None
    except ValidationError:
        return None


def _program(run: ReadRun, case: str, adapter: str) -> str | None:
    entry = (run.render_json(case, adapter).get("program") or {}).get("entry")
    path = run.render_folder(case, adapter) / "program" / str(entry)
    return str(path) if entry and path.exists() else None


# --- pictures ---------------------------------------------------------------------------------------------------------


def read_pixel(run: ReadRun, case: CaseRecord, pair: PairRecord, x: int, y: int) -> PixelFacts:
    """One pixel from the pictures of both renders, their uncertainties and the pair's planes. Raises OSError where a file is
    missing or damaged, ValueError where the pixel is not on the film."""
    statistics = read_json(run.pair_file(case.case, pair.a, pair.b, "json")) or {}
    a, b = (_side(run.render_folder(case.case, name), name, x, y) for name in (pair.a, pair.b))
    return pixel_facts(x, y, a, b, float(statistics.get("coverage_factor") or 0.0), _class(run, case.case, pair, x, y))


def _side(folder: Path, adapter: str, x: int, y: int) -> SidePixel:
    from equilux.casework import saved_picture
    from equilux.uncertainty import Uncertainty

    record = read_json(folder / "render.json")
    if record is None or record.get("uncertainty") is None:
        raise OSError(f"{folder / 'render.json'}: cannot be read")
    image = saved_picture(folder)
    if y >= image.shape[0] or x >= image.shape[1]:
        raise ValueError(f"({x}, {y}) lies outside the picture of {adapter}, {image.shape[1]}×{image.shape[0]} pixels")
    stated = record["uncertainty"]
    full = Uncertainty.from_json({"film_px": 0.0, "terms": [], **stated}, folder / "uncertainty.exr")
    zero: Bands = (0.0, 0.0, 0.0)
    per_pixel = _bands(full.per_pixel[y, x]) if full.per_pixel is not None else zero
    sigma = _bands(full.sigma[y, x]) if full.sigma is not None else zero
    return SidePixel(adapter, _bands(image[y, x]), stated, per_pixel, sigma)


def _bands(values: Any) -> Bands:
    return (float(values[0]), float(values[1]), float(values[2])) if len(values) == 3 else NOT_FINITE


def _class(run: ReadRun, case: str, pair: PairRecord, x: int, y: int) -> str | None:
    from equilux.planes import read_planes

    try:
        return CLASSES[int(read_planes(run.pair_file(case, pair.a, pair.b, "exr"))["class"][y, x])]
    except (OSError, KeyError, IndexError):
        return None
