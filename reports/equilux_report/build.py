"""Builds the HTML report of a results tree: a folder of pages, or one file with all in it. Old reports are replaced whole."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from equilux_report import png
from equilux_report.calibration import calibrations
from equilux_report.casepage import CasePage, case_page
from equilux_report.dialects import dialects
from equilux_report.keeping import kept_pictures, remember
from equilux_report.links import Links
from equilux_report.overview import overview
from equilux_report.pages import Pages
from equilux_report.pictures import CasePictures, prepare
from equilux_report.tree import Run, read_run

MARKER = "equilux-report.json"
"""Lies in every report folder: only a folder with it (or an empty one) is ever replaced."""

SCRATCH = ".scratch-report-"
"""Start of the names of folders in the making: a run that continues the tree clears away what a killed build left."""


def build(run: Path, *, out: Path | None = None, single_file: bool = False, case_filter: str | None = None) -> Path:
    """Build the report of the results tree `run` and return its index.html.

    out: the report's folder, RUN/report by default; replaced whole once the new report is complete. single_file: all in one page.
    case_filter: only the cases that match (`*` and `?`). What is missing in the tree is named in the report. Raises
    FileNotFoundError if `run` is not a folder, FileExistsError if `out` holds something that is not a report.
    """
    out = (run / "report" if out is None else out).absolute()
    if not replaceable(out):
        raise FileExistsError(f"{out}: is not empty and not a report of ours: not replaced")
    tree = read_run(run, case_filter)
    with replacing(out) as folder:
        data = folder / "data"
        pictures = prepare(tree, data, kept_pictures(tree, out))
        tree = _enriched(tree, pictures)
        (folder / MARKER).write_text(
            json.dumps({"schema": "equilux/report/1", "cases": len(tree.cases), "single_file": single_file}) + "\n"
        )
        if single_file:
            _write_single(tree, pictures, folder)
            shutil.rmtree(data)
        else:
            _write_folder(tree, pictures, folder)
            remember(tree, pictures, data)
    return out / "index.html"


def _enriched(tree: Run, pictures: dict[str, CasePictures]) -> Run:
    """The run with what only the pictures could tell."""
    problems = [problem for case in pictures.values() for problem in case.problems]
    cases = []
    for case in tree.cases:
        places = pictures[case.name].first_invalid
        cases.append(replace(case, pairs=tuple(replace(pair, first_invalid=places.get(pair.name)) for pair in case.pairs)))
    return replace(tree, cases=tuple(cases), problems=(*tree.problems, *problems))


def _write_folder(tree: Run, pictures: dict[str, CasePictures], folder: Path) -> None:
    pages = Pages(single_file=False)
    pages.write_static(folder / "static")
    for case, found in pictures.items():
        (folder / "thumbnails" / case).mkdir(parents=True)
        for name, data in found.thumbnails.items():
            (folder / "thumbnails" / case / f"{name}.png").write_bytes(data)
    links = Links(single_file=False)

    def thumbnail(case: str, name: str) -> str | None:
        return links.thumbnail(case, name) if name in pictures[case].thumbnails else None

    view = overview(tree, links, thumbnail)
    (folder / "dialects.html").write_text(pages.dialects_page(tree, dialects(tree, links, thumbnail), links), encoding="utf-8")
    (folder / "index.html").write_text(pages.overview_page(tree, view, calibrations(tree), links), encoding="utf-8")
    (folder / "cases").mkdir()
    inner = Links(single_file=False, root="../")
    for page in _case_pages(tree, pictures, inner, [row.case.name for row in view.rows]):
        (folder / "cases" / f"{page.case.name}.html").write_text(pages.case_page(tree, page, inner), encoding="utf-8")


def _write_single(tree: Run, pictures: dict[str, CasePictures], folder: Path) -> None:
    pages, links = Pages(single_file=True), Links(single_file=True)

    def thumbnail(case: str, name: str) -> str | None:
        return png.data_uri(pictures[case].thumbnails[name]) if name in pictures[case].thumbnails else None

    view = overview(tree, links, thumbnail)
    cases = _case_pages(tree, pictures, links, [row.case.name for row in view.rows])
    with (folder / "index.html").open("w", encoding="utf-8") as stream:
        stream.writelines(
            pages.single_page(
                tree, view, calibrations(tree), dialects(tree, links, lambda *_: None), cases, links, _payloads(pictures)
            )
        )


def _payloads(pictures: dict[str, CasePictures]) -> Iterator[tuple[str, str]]:
    """Key and script of every packed picture."""
    for case, found in pictures.items():
        for name, path in found.packed.items():
            yield f"{case}/{name}", path.read_text(encoding="ascii")


def _case_pages(tree: Run, pictures: dict[str, CasePictures], links: Links, order: list[str]) -> Iterator[CasePage]:
    """The pages in the overview's order, so that "next" goes where the eye would."""
    by_name = {case.name: case for case in tree.cases}
    cases = [by_name[name] for name in order]
    for index, case in enumerate(cases):
        neighbours = (cases[index - 1] if index else None, cases[index + 1] if index + 1 < len(cases) else None)
        yield case_page(case, neighbours, links, pictures[case.name].packed, pictures[case.name].stops)


def replaceable(out: Path) -> bool:
    return not out.exists() or (out.is_dir() and ((out / MARKER).is_file() or not any(out.iterdir())))


@contextmanager
def replacing(out: Path) -> Iterator[Path]:
    """A new folder beside `out` that takes its place when the block ends well, and vanishes when it does not."""
    out.parent.mkdir(parents=True, exist_ok=True)
    new = Path(tempfile.mkdtemp(prefix=f"{SCRATCH}new-", dir=out.parent))
    os.chmod(new, 0o777 & ~_umask())
    try:
        yield new
        old = Path(tempfile.mkdtemp(prefix=f"{SCRATCH}old-", dir=out.parent))
        if out.exists():
            out.rename(old / "report")
        new.rename(out)
        shutil.rmtree(old)
    except BaseException:
        shutil.rmtree(new, ignore_errors=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
