"""Building a report: from whole trees, damaged trees and empty ones; replacing only what is its own."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from urllib.parse import unquote

import pytest

import equilux_report.pages
import equilux_report.pictures
from browser.fake_tree import write_tree
from equilux_report import build
from equilux_report.tree import read_run

NAMESPACE = b"http://www.w3.org"
"""Of SVG: a name, never asked for."""


@pytest.fixture
def copy(tree: Path, tmp_path: Path) -> Path:
    """A tree to be damaged."""
    return Path(shutil.copytree(tree, tmp_path / "run"))


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_every_link_leads_to_a_file(tree: Path, tmp_path: Path) -> None:
    index = build(tree, out=tmp_path / "report")
    pages = [index, *(index.parent / "cases").glob("*.html")]
    assert len(pages) == 11
    for page in pages:
        targets = re.findall(r'(?:href|src)="([^"#]+)', page.read_text(encoding="utf-8"))
        targets += re.findall(r'"src": "([^"]+)"', page.read_text(encoding="utf-8"))
        for target in targets:
            assert (page.parent / unquote(target)).is_file(), f"{page.name} links to {target}"


def test_no_page_names_an_address_outside(tree: Path, tmp_path: Path) -> None:
    build(tree, out=tmp_path / "report")
    for name, content in files(tmp_path / "report").items():
        if name.endswith((".html", ".css", ".js")) and not name.startswith("data/"):
            found = [url for url in re.findall(rb"(?:https?:)?//[a-z0-9.-]+\.[a-z]+", content) if url != NAMESPACE]
            assert found == [], f"{name}: {found}"


def test_the_same_tree_gives_the_same_report(tree: Path, tmp_path: Path) -> None:
    build(tree, out=tmp_path / "one")
    build(tree, out=tmp_path / "two")
    assert files(tmp_path / "one") == files(tmp_path / "two")


def test_rebuilding_leaves_nothing_of_the_old_report(copy: Path) -> None:
    build(copy)
    build(copy, case_filter="clay-ball[*")
    cases = sorted(path.stem for path in (copy / "report" / "cases").iterdir())
    assert cases == sorted(f"clay-ball[exponent={exponent}]" for exponent in (1, 10, 100, 1000))
    assert sorted(path.name for path in copy.iterdir()) == ["cases", "report", "results.json", "run.json"]


def test_a_report_takes_over_the_pictures_of_files_that_have_not_changed(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build(copy)
    before = files(copy / "report")
    packed: list[str] = []
    real = equilux_report.pictures.pack
    monkeypatch.setattr(equilux_report.pictures, "pack", lambda key, planes: packed.append(key) or real(key, planes))
    build(copy)
    assert (packed, files(copy / "report")) == ([], before)
    changed = next((copy / "cases").glob("*/*/image.exr"))
    shutil.copyfile(changed, changed.with_suffix(".new"))
    changed.with_suffix(".new").replace(changed)
    build(copy)
    assert {key.partition("/")[0] for key in packed} == {changed.parent.parent.name}


@pytest.mark.parametrize("damage", ["half", "other code", "a thumbnail is gone"])
def test_what_cannot_be_taken_over_is_made_anew(copy: Path, damage: str) -> None:
    build(copy)
    before = files(copy / "report")
    kept = copy / "report" / "data" / "pictures.json"
    if damage == "half":
        kept.write_text(kept.read_text()[:100])
    elif damage == "other code":
        kept.write_text(json.dumps(json.loads(kept.read_text()) | {"code": "another"}))
    else:
        next((copy / "report" / "thumbnails").glob("*/*.png")).unlink()
    build(copy)
    assert files(copy / "report") == before


def test_brackets_in_a_filter_mean_themselves(tree: Path) -> None:
    assert [case.name for case in read_run(tree, "clay-ball[exponent=1]").cases] == ["clay-ball[exponent=1]"]
    assert len(read_run(tree, "clay-ball?exponent=10*").cases) == 3


def test_a_filter_that_matches_nothing_still_gives_a_page(tree: Path, tmp_path: Path) -> None:
    page = build(tree, out=tmp_path / "report", case_filter="nothing").read_text()
    assert "holds no case that matches" in page


def test_a_foreign_folder_is_never_replaced(tree: Path, tmp_path: Path) -> None:
    out = tmp_path / "precious"
    out.mkdir()
    (out / "thesis.tex").write_text("years of work")
    with pytest.raises(FileExistsError, match="not a report of ours"):
        build(tree, out=out)
    assert files(out) == {"thesis.tex": b"years of work"}


def test_a_build_that_fails_leaves_the_old_report_and_no_rubbish(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build(copy)
    before = files(copy / "report")

    def fail(*_: object) -> str:
        raise RuntimeError("disk full")

    monkeypatch.setattr(equilux_report.pages.Pages, "case_page", fail)
    with pytest.raises(RuntimeError, match="disk full"):
        build(copy)
    assert files(copy / "report") == before
    assert sorted(path.name for path in copy.iterdir()) == ["cases", "report", "results.json", "run.json"]


def test_a_folder_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="not a results tree"):
        build(tmp_path / "nowhere")


def test_an_empty_folder_gives_a_page_that_says_so(tmp_path: Path) -> None:
    page = build(tmp_path).read_text()
    assert "Nothing was compared" in page
    assert "results.json</code> is missing" in page


def test_a_run_without_cases_gives_a_page(tmp_path: Path) -> None:
    page = build(write_tree(tmp_path / "run", [])).read_text()
    assert "holds no case" in page


def test_an_interrupted_run_shows_the_cases_that_were_finished(copy: Path) -> None:
    (copy / "results.json").unlink()
    shutil.rmtree(copy / "cases" / "spot-cone")
    page = build(copy).read_text()
    assert "results.json</code> is missing" in page
    assert 'data-case="three-bands"' in page
    assert "spot-cone" not in page


@pytest.mark.parametrize(
    "damage", ["", "{", "[]", "null", '{"status": 7, "seconds": [], "uncertainty": 3, "program": "x"}', "\xff\xfe"]
)
def test_damaged_sidecars_are_named_and_do_not_stop_the_report(copy: Path, damage: str) -> None:
    for name in ("cases/three-bands/vtk/render.json", "cases/three-bands/pairs/vtk--oracle.json", "run.json"):
        (copy / name).write_text(damage, encoding="latin-1")
    page = build(copy, case_filter="three-bands").read_text()
    assert 'data-case="three-bands"' in page
    if not damage.startswith('{"'):
        assert "cases/three-bands/vtk/render.json" in page


def test_missing_and_truncated_images_are_named(copy: Path) -> None:
    case = copy / "cases" / "three-bands"
    (case / "vtk" / "image.exr").unlink()
    whole = (case / "povray" / "image.exr").read_bytes()
    (case / "povray" / "image.exr").write_bytes(whole[: len(whole) // 2])
    (case / "pairs" / "vtk--oracle.exr").write_bytes(b"not an image")
    page = build(copy, case_filter="three-bands").read_text()
    for name in ("vtk/image.exr", "povray/image.exr", "pairs/vtk--oracle.exr"):
        assert f"cases/three-bands/{name}" in page


def test_case_names_never_lead_out_of_the_tree(copy: Path, tmp_path: Path) -> None:
    results = json.loads((copy / "results.json").read_text())
    results["cases"][0]["case"] = "../../outside"
    results["cases"][1]["case"] = "a/b"
    (copy / "results.json").write_text(json.dumps(results))
    page = build(copy).read_text()
    assert "cannot be a folder" in page
    assert not (tmp_path / "outside.html").exists()


def test_words_of_renderers_are_escaped_everywhere(tree: Path, tmp_path: Path) -> None:
    for single in (False, True):
        out = tmp_path / f"report-{single}"
        build(tree, out=out, single_file=single)
        for page in out.rglob("*.html"):
            assert "<script>window.hacked" not in page.read_text(encoding="utf-8"), page.name


def test_one_file_holds_everything(tree: Path, tmp_path: Path) -> None:
    index = build(tree, out=tmp_path / "report", single_file=True)
    assert sorted(path.name for path in index.parent.iterdir()) == ["equilux-report.json", "index.html"]
    text = index.read_text(encoding="utf-8")
    assert re.findall(r'(?:src|href)="(?!#|data:)[^"]', text) == []
    assert text.count("<template data-case=") == 10
    assert text.count('<script type="text/plain" data-picture="') == len(list((tree / "cases").glob("*/*/*.exr")))


def test_statistics_come_from_the_pair_and_judgement_from_the_run(copy: Path) -> None:
    path = copy / "cases" / "three-bands" / "pairs" / "vtk--oracle.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "judged": "agree"}))
    case = next(case for case in read_run(copy).cases if case.name == "three-bands")
    pair = case.pair("oracle", "vtk")
    assert pair is not None
    assert pair.judged == "diverge_unexpected"
    assert "en_histogram" in pair.facts
