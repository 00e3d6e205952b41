"""The pictures of a run, packed and shrunk, several cases at a time (compression and numpy release the interpreter)."""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from equilux_report import thumbnail
from equilux_report.pack import pack
from equilux_report.pixels import BANDS, PAIR_CHANNELS, Plane, UnreadableImage, read_planes, require
from equilux_report.tree import CaseRecord, Problem, Run

INVALID = 3
"""In the class plane."""


@dataclass
class CasePictures:
    """One case's pictures, by render or pair name: where the packed data lies, and the thumbnail's PNG."""

    stops: float = 0.0
    packed: dict[str, Path] = field(default_factory=dict)
    thumbnails: dict[str, bytes] = field(default_factory=dict)
    first_invalid: dict[str, tuple[int, int]] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)


Kept = Mapping[str, CasePictures]
"""By case name: pictures of an earlier report whose files have not changed since."""


def prepare(run: Run, folder: Path, kept: Kept | None = None) -> dict[str, CasePictures]:
    """Pack every picture of the run into scripts `folder`/<case>/<render or pair>.js; by case name."""

    def prepared(case: CaseRecord) -> CasePictures:
        earlier = (kept or {}).get(case.name)
        return _prepare_case(case, folder / case.name) if earlier is None else _taken_over(earlier, folder / case.name)

    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        return dict(zip([case.name for case in run.cases], pool.map(prepared, run.cases), strict=True))


def _taken_over(earlier: CasePictures, folder: Path) -> CasePictures:
    """The earlier report's files under another name: it is about to be replaced."""
    folder.mkdir(parents=True)
    packed = {name: folder / path.name for name, path in earlier.packed.items()}
    for name, path in packed.items():
        try:
            os.link(earlier.packed[name], path)
        except OSError:  # a file system without hard links
            path.write_bytes(earlier.packed[name].read_bytes())
    return CasePictures(earlier.stops, packed, earlier.thumbnails, earlier.first_invalid)


def _prepare_case(case: CaseRecord, folder: Path) -> CasePictures:
    found = CasePictures()
    folder.mkdir(parents=True)
    renders = {}
    for name, render in case.renders.items():
        if render.image is not None and (planes := _read(render.image, BANDS, f"cases/{case.name}/{name}/image.exr", found)):
            renders[name] = planes
            _store(case, name, planes, folder, found)
    if renders:
        found.stops = thumbnail.exposure_stops(renders.get(case.truth or "", next(iter(renders.values()))))
    found.thumbnails |= {name: thumbnail.of_render(planes, found.stops) for name, planes in renders.items()}
    for pair in case.pairs:
        if pair.planes is not None and (
            planes := _read(pair.planes, PAIR_CHANNELS, f"cases/{case.name}/pairs/{pair.name}.exr", found)
        ):
            _store(case, pair.name, planes, folder, found)
            found.thumbnails[pair.name] = thumbnail.of_normalised_error(planes)
            if (invalid := np.argwhere(planes["class"] == INVALID)).size:
                found.first_invalid[pair.name] = (int(invalid[0, 1]), int(invalid[0, 0]))
    return found


def _read(path: Path, channels: tuple[str, ...], where: str, found: CasePictures) -> dict[str, Plane]:
    try:
        return require(read_planes(path), channels, path)
    except UnreadableImage as error:
        found.problems.append(Problem(where, str(error)))
        return {}


def _store(case: CaseRecord, name: str, planes: dict[str, Plane], folder: Path, found: CasePictures) -> None:
    found.packed[name] = folder / f"{name}.js"
    found.packed[name].write_text(pack(f"{case.name}/{name}", planes).script(), encoding="ascii")
