"""Both themes, narrow windows, speed. Screenshots are left in build/screenshots for eyes."""

from __future__ import annotations

import dataclasses
import shutil
from pathlib import Path

import pytest

from browser.conftest import Opener, case_path
from browser.fake_tree import FakeCase, Sphere, write_tree
from equilux_report import build

pytestmark = pytest.mark.browser

SCREENSHOTS = Path(__file__).parents[2] / "build" / "screenshots"
CLAMPED = "clay-ball[exponent=1000]"


def luminance(css: str) -> float:
    """Relative luminance (WCAG 2.2) of `rgb(…)`."""
    channels = [int(float(part)) / 255 for part in css[css.index("(") + 1 : -1].replace(",", " ").split()[:3]]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_follows_the_systems_theme_with_readable_words(tree: Path, opened: Opener, theme: str) -> None:
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    for name, path in (("overview", tree / "report" / "index.html"), ("case", case_path(tree, CLAMPED))):
        view = opened(path, theme=theme, width=1440, height=1000)
        if name == "case":
            view.settled()
        background = view.page.evaluate("getComputedStyle(document.documentElement).backgroundColor")
        assert (luminance(background) > 0.5) == (theme == "light"), f"{theme}: background {background}"
        surface = view.page.evaluate("getComputedStyle(document.querySelector('.panel, .card')).backgroundColor")
        for selector in ("body", ".muted", "a[href]", ".chip", ".icon--diverge_expected"):
            ink = view.page.evaluate(f"getComputedStyle(document.querySelector('main {selector}, {selector}')).color")
            ratio = contrast(ink, surface)
            assert ratio >= 4.5, f"{theme} {name} {selector}: {ink} on {surface} has contrast {ratio:.2f}, WCAG AA asks 4.5"
        view.page.screenshot(path=SCREENSHOTS / f"{name}-{theme}.png")


def test_theme_button_overrides_the_system_and_is_remembered(tree: Path, opened: Opener) -> None:
    view = opened(tree / "report" / "index.html", theme="light")
    button = view.page.locator("eq-theme button")
    button.click()
    button.click()
    assert button.inner_text() == "theme: dark"
    view.page.goto(case_path(tree, "three-bands").as_uri())
    background = view.page.evaluate("getComputedStyle(document.documentElement).backgroundColor")
    assert luminance(background) < 0.1, background
    button.click()  # back to the system's, for the tests that follow


@pytest.mark.parametrize("width", [360, 380, 768])
def test_narrow_windows_need_no_sideways_scrolling(tree: Path, opened: Opener, width: int) -> None:
    overview, case = tree / "report" / "index.html", case_path(tree, "broken-floor")
    for name, path, state in (("overview", overview, ""), ("pairs", overview, "pairs=all"), ("case", case, "")):
        view = opened(path, state, width=width, height=800, theme="dark")
        if name == "case":
            view.settled()
            view.page.evaluate("document.querySelectorAll('details').forEach(details => { details.open = true; })")
        wide = view.page.evaluate("document.documentElement.scrollWidth")
        assert wide <= width, f"{name} at {width}: content is {wide} wide"
        if width == 380:
            view.page.screenshot(path=SCREENSHOTS / f"{name}-narrow.png", full_page=True)


def test_overview_of_a_hundred_cases_opens_within_a_second(tmp_path: Path, opened: Opener) -> None:
    base = FakeCase("many", "bulk", "One of many.", Sphere(), width=16, height=12)
    cases = [dataclasses.replace(base, scene=f"case-{index:03}", family=f"family-{index % 7}") for index in range(8)]
    tree = write_tree(tmp_path / "run", cases)
    _multiply(tree, 100)
    index = build(tree)
    view = opened(index)
    session = view.page.context.new_cdp_session(view.page)
    # Time that the page's thread was really at work: a loaded machine must not fail the page.
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    view.page.reload()
    view.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    metrics = {entry["name"]: entry["value"] for entry in session.send("Performance.getMetrics")["metrics"]}
    assert view.page.locator("tr.row").count() == 100
    assert metrics["TaskDuration"] < 1.0, f"opened in {metrics['TaskDuration']:.2f} s, allowed 1 s"


def _multiply(tree: Path, number: int) -> None:
    """Copies of the first cases under new names, until there are `number`."""
    import json

    results = json.loads((tree / "results.json").read_text())
    first = results["cases"]
    for index in range(len(first), number):
        model = first[index % len(first)]
        name = f"case-{index:03}"
        shutil.copytree(tree / "cases" / model["case"], tree / "cases" / name)
        results["cases"].append({**model, "case": name, "scene": name})
    (tree / "results.json").write_text(json.dumps(results))
