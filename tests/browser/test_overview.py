"""The overview: counts, matrix, filters, keys."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from browser.conftest import Opener

pytestmark = pytest.mark.browser

VISIBLE = "[...document.querySelectorAll('tr.row')].filter(row => !row.hidden).map(row => row.dataset.case)"


def index(tree: Path) -> Path:
    return tree / "report" / "index.html"


def test_opens_from_a_file_without_errors_and_asks_nobody_for_anything(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    view.page.wait_for_function("document.querySelector('eq-matrix').rows")
    assert view.console == []
    assert view.foreign == []


def test_every_case_has_a_row_and_every_thumbnail_loads(tree: Path, opened: Opener) -> None:
    view = opened(index(tree), height=6000)
    cases = [case["case"] for case in json.loads((tree / "results.json").read_text())["cases"]]
    assert sorted(view.page.evaluate(VISIBLE)) == sorted(cases)
    # Thumbnails load lazily, as they come into view: the window is tall enough for all of them.
    waiting = "[...document.images].filter(image => image.offsetParent && !(image.complete && image.naturalWidth))"
    view.page.wait_for_function(f"{waiting}.length === 0")
    assert view.page.evaluate("[...document.images].filter(image => image.naturalWidth).length") > 60


def test_tiles_count_what_results_json_counts(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    for judged, number in json.loads((tree / "results.json").read_text())["summary"]["pairs"].items():
        tile = view.page.locator(f".tile--{judged} small").inner_text()
        assert tile == f"{number} of all pairs", f"{judged}: tile '{tile}', results.json {number}"


def test_filters_live_in_the_url_and_survive_a_reload(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    view.page.select_option("select[name=verdict]", "diverge_unexpected")
    view.page.fill("input[name=q]", "bands")
    assert view.page.evaluate(VISIBLE) == ["three-bands"]
    assert "verdict=diverge_unexpected" in view.page.url
    assert "q=bands" in view.page.url
    view.page.reload()
    assert view.page.input_value("input[name=q]") == "bands"
    assert view.page.evaluate(VISIBLE) == ["three-bands"]
    view.page.click("button[type=reset]")
    assert len(view.page.evaluate(VISIBLE)) == 10
    assert "#" not in view.page.url


def test_a_shared_link_shows_what_was_shared(tree: Path, opened: Opener) -> None:
    assert opened(index(tree), "status=crashed").page.evaluate(VISIBLE) == ["crash-test"]
    assert opened(index(tree), "feature=shape.mesh").page.evaluate(VISIBLE) == ["slow-mesh"]
    assert opened(index(tree), "family=light").page.evaluate(VISIBLE) == ["spot-cone"]
    assert opened(index(tree), "adapter=povray&verdict=diverge_unexpected").page.evaluate(VISIBLE) == ["broken-floor"]
    assert opened(index(tree), "q=exponent-clamped").page.evaluate(VISIBLE) == ["clay-ball[exponent=1000]"]


def test_nonsense_in_the_url_is_ignored(tree: Path, opened: Opener) -> None:
    view = opened(index(tree), "verdict=%3Cb%3E&sort=nothing&view=&foo")
    assert len(view.page.evaluate(VISIBLE)) == 10
    assert view.console == []


def test_sorting_puts_the_gravest_first_and_goes_back(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    before = view.page.evaluate(VISIBLE)
    view.page.select_option("select[name=sort]", "en")
    values = view.page.evaluate("[...document.querySelectorAll('tr.row')].map(row => Number(row.dataset.en))")
    assert values == sorted(values, reverse=True)
    assert view.page.evaluate(VISIBLE)[0] == "clay-ball[exponent=1000]"
    view.page.select_option("select[name=sort]", "")
    assert view.page.evaluate(VISIBLE) == before


def test_other_pairs_are_available(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    assert not view.page.locator("td.peer").first.is_visible()
    view.page.select_option("select[name=pairs]", "all")
    assert view.page.locator("td.peer").first.is_visible()


def test_pinned_divergences_name_their_cause(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    cell = view.page.locator("tr.row[data-case='clay-ball[exponent=1000]'] td[data-adapter=vtk]")
    assert "exponent-clamped" in cell.inner_text()
    assert "diverges as pinned" in cell.inner_text()


def test_links_to_cases_are_percent_encoded_and_lead_there(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    link = view.page.locator("tr.row[data-case='clay-ball[exponent=100]'] th a")
    assert link.get_attribute("href") == "cases/clay-ball%5Bexponent%3D100%5D.html"
    link.click()
    assert view.page.locator("h1").inner_text() == "clay-ball[exponent=100]"


def test_everything_can_be_reached_by_keys(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    keyboard = view.page.keyboard
    keyboard.press("/")
    keyboard.type("clay")
    keyboard.press("ArrowDown")
    keyboard.press("ArrowDown")
    keyboard.press("ArrowRight")
    focused = (
        "document.activeElement.closest('tr').dataset.case + ' ' + document.activeElement.closest('td').className.split(' ')[0]"
    )
    assert view.page.evaluate(focused) == "clay-ball[exponent=10] truth"
    outline = view.page.evaluate("getComputedStyle(document.activeElement).outlineStyle")
    assert outline == "solid"
    keyboard.press("ArrowRight")
    keyboard.press("Enter")
    view.page.wait_for_url("**/cases/**")
    assert view.page.locator("h1").inner_text() == "clay-ball[exponent=10]"
    view.settled()
    keyboard.press("n")
    view.page.wait_for_function("document.querySelector('h1')?.textContent === 'clay-ball[exponent=100]'")
    keyboard.press("u")
    view.page.wait_for_url("**/index.html")


def test_first_tab_stop_skips_to_the_content(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    view.page.keyboard.press("Tab")
    assert view.page.evaluate("document.activeElement.textContent") == "Skip to the content"
    view.page.keyboard.press("Enter")
    assert view.page.evaluate("document.activeElement.id") == "main"


def test_escape_clears_the_search(tree: Path, opened: Opener) -> None:
    view = opened(index(tree), "q=mesh")
    view.page.focus("input[name=q]")
    view.page.keyboard.press("Escape")
    assert len(view.page.evaluate(VISIBLE)) == 10


def test_hostile_words_stay_words(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    assert view.page.evaluate("window.hacked") is None
    assert "<script>window.hacked = 1</script>" in view.page.locator("tr.row[data-case=crash-test]").inner_text()
    assert view.console == []


def test_calibration_counts_every_value(tree: Path, opened: Opener) -> None:
    view = opened(index(tree))
    total = 0
    for case in json.loads((tree / "results.json").read_text())["cases"]:
        for pair in case["pairs"]:
            if pair["a"] == "povray" and pair["b"] == "oracle":
                total += sum(pair["en_histogram"]["counts"])
    shown = view.page.locator("figure.calibration", has_text="povray").locator("figcaption").inner_text()
    assert f"{total:,} values".replace(",", "\u202f") in shown
