"""What a report may take over from the one that it replaces: the packed pictures and thumbnails of files that have not changed.

A report says beside its pictures what they were made from: `data/pictures.json` holds, case by case, every picture file with its
inode, size and time of change, and a hash of the code that packs. Anything else than exact equality means packing again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from equilux_report import colour, pack, pictures, pixels, png, thumbnail
from equilux_report.pictures import CasePictures
from equilux_report.tree import CaseRecord, Run

KEPT_FILE = "pictures.json"

Signature = dict[str, list[int]]


def remember(run: Run, found: Mapping[str, CasePictures], data: Path) -> None:
    """Write what the pictures in a report's `data` folder were made from. Cases with problems are not remembered."""
    cases = {
        case.name: {
            "files": _signature(case),
            "stops": found[case.name].stops,
            "first_invalid": {name: list(place) for name, place in found[case.name].first_invalid.items()},
            "packed": sorted(found[case.name].packed),
            "thumbnails": sorted(found[case.name].thumbnails),
        }
        for case in run.cases
        if not found[case.name].problems
    }
    data.mkdir(parents=True, exist_ok=True)  # of a report without cases there is nothing in it
    (data / KEPT_FILE).write_text(json.dumps({"code": _code(), "cases": cases}), encoding="utf-8")


def kept_pictures(run: Run, report: Path) -> dict[str, CasePictures]:
    """Of an earlier report's folder, the cases whose pictures are the same files still; none where there is no such report."""
    try:
        remembered = json.loads((report / "data" / KEPT_FILE).read_text(encoding="utf-8"))
        if remembered["code"] != _code():
            return {}
        told = remembered["cases"]
        return {
            case.name: found
            for case in run.cases
            if case.name in told and (found := _kept_case(case, told[case.name], report)) is not None
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}  # no report, one of another version, a damaged one: as good as none


def _kept_case(case: CaseRecord, told: Mapping[str, Any], report: Path) -> CasePictures | None:
    if told["files"] != _signature(case):
        return None
    packed = {name: report / "data" / case.name / f"{name}.js" for name in told["packed"]}
    thumbnails = {name: report / "thumbnails" / case.name / f"{name}.png" for name in told["thumbnails"]}
    if not all(path.is_file() for path in (*packed.values(), *thumbnails.values())):
        return None
    places = {name: (int(x), int(y)) for name, (x, y) in told["first_invalid"].items()}
    return CasePictures(float(told["stops"]), packed, {name: path.read_bytes() for name, path in thumbnails.items()}, places)


def _signature(case: CaseRecord) -> Signature:
    """Which files the case's pictures are, and whose picture sets the exposure."""
    files = {name: render.image for name, render in case.renders.items()} | {pair.name: pair.planes for pair in case.pairs}
    out = {f"truth {case.truth}": [0]}
    for name, path in sorted(files.items()):
        if path is not None:
            state = path.stat()
            out[name] = [state.st_ino, state.st_size, state.st_mtime_ns]
    return out


@cache
def _code() -> str:
    """Hash of everything that has a part in what is kept."""
    sha = hashlib.sha256()
    for module in (colour, pack, pictures, pixels, png, thumbnail):
        sha.update(Path(str(module.__file__)).read_bytes())
    sha.update(Path(__file__).read_bytes())
    return sha.hexdigest()
