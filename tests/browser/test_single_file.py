"""The report in one file: the same pages, the same numbers, no other file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from browser.conftest import Opener

pytestmark = pytest.mark.browser


def test_opens_alone_without_errors_and_requests(single: Path, opened: Opener) -> None:
    view = opened(single)
    view.page.wait_for_function("document.querySelector('eq-matrix').rows")
    assert view.console == []
    assert [url for url in view.requests if not url.startswith("data:")] == [single.as_uri()]


def test_leads_to_a_case_and_back_and_shows_the_files_values(single: Path, tree: Path, opened: Opener) -> None:
    view = opened(single, "q=bands")
    view.page.locator("tr.row[data-case=three-bands] th a").click()
    view.settled()
    assert view.page.locator("h1").inner_text() == "three-bands"
    assert view.page.title().startswith("three-bands")
    x, y = (int(view.page.input_value(f"input[name={axis}]")) for axis in "xy")
    image = np.asarray(oiio.ImageBuf(str(tree / "cases" / "three-bands" / "vtk" / "image.exr")).get_pixels(oiio.FLOAT))
    for band, value in zip("RGB", image[y, x], strict=True):
        text = view.page.locator(f"[data-value='vtk.{band}']").inner_text()
        assert np.float32(float(text)) == np.float32(value), f"{band} at ({x}, {y}): page {text}, file {value}"
    view.page.go_back()
    view.page.wait_for_function("document.querySelector('eq-matrix')")
    assert view.page.input_value("input[name=q]") == "bands"
    assert view.console == []


def test_a_link_into_the_file_opens_that_case_at_that_pixel(single: Path, opened: Opener) -> None:
    view = opened(single, "case=clay-ball%5Bexponent%3D1000%5D&x=17&y=40&pair=vtk--reference")
    view.settled()
    assert view.page.locator("h1").inner_text() == "clay-ball[exponent=1000]"
    assert [view.page.input_value(f"input[name={axis}]") for axis in "xy"] == ["17", "40"]
    assert view.page.input_value("select[name=pair]") == "vtk--reference"
    view.page.keyboard.press("p")
    view.page.wait_for_function("document.querySelector('h1')?.textContent === 'clay-ball[exponent=100]'")
    view.settled()
    assert view.console == []


def test_hostile_words_stay_words(single: Path, opened: Opener) -> None:
    view = opened(single, "case=crash-test")
    view.settled()
    assert view.page.evaluate("window.hacked") is None
    assert view.console == []
