"""A report of the fake tree, and a Chromium that refuses every request that is not for a file of it."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from browser.fake_causes import write_diagnosed_tree
from browser.fake_tree import write_tree
from equilux_report import build

CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update", "--no-first-run"]


@pytest.fixture(scope="session")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results tree with its report inside."""
    root = write_tree(tmp_path_factory.mktemp("browser") / "run")
    build(root)
    return root


@pytest.fixture(scope="session")
def single(tree: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same in one file, moved away from everything else."""
    index = build(tree, out=tmp_path_factory.mktemp("single") / "report", single_file=True)
    alone = tmp_path_factory.mktemp("alone") / "report.html"
    shutil.copy(index, alone)
    return alone


@pytest.fixture(scope="session")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results tree whose divergences have causes, with its report inside."""
    root = write_diagnosed_tree(tmp_path_factory.mktemp("diagnosed") / "run")
    build(root)
    return root


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """The system's Chromium, else Playwright's own."""
    found = next((path for name in CHROMIUM if (path := shutil.which(name))), None)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=ARGUMENTS)
        yield browser
        browser.close()


@dataclass
class Opened:
    """A page and what went on behind it."""

    page: Page
    console: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    @property
    def foreign(self) -> list[str]:
        """Requests for anything but files, and inline data."""
        return [url for url in self.requests if not url.startswith(("file:", "data:", "blob:"))]

    def settled(self) -> None:
        """Wait until every picture that is shown has been drawn."""
        self.page.wait_for_function(
            "[...document.querySelectorAll('figure.picture .panel-note')].length > 0"
            " && [...document.querySelectorAll('figure.picture .panel-note')].every(note => note.textContent !== '…')"
            " && document.querySelector('[data-inspect=radiance] tbody td').textContent !== '–'"
        )
        self.drawn()

    def drawn(self) -> None:
        """Wait until what was asked for has been drawn: drawing waits for one frame, and the next comes after it."""
        self.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


Opener = Callable[..., Opened]


@pytest.fixture(scope="session")
def context(chromium: Browser) -> BrowserContext:
    return chromium.new_context()


@pytest.fixture
def opened(context: BrowserContext) -> Iterator[Opener]:
    """Opens a page: `opened(path, "fragment", width=…, theme=…)`."""
    pages = []

    def go(path: Path, fragment: str = "", *, width: int = 1280, height: int = 900, theme: str = "light") -> Opened:
        result = Opened(context.new_page())
        pages.append(result.page)
        result.page.set_viewport_size({"width": width, "height": height})
        result.page.emulate_media(color_scheme=theme)  # type: ignore[arg-type]
        result.page.set_default_timeout(10_000)
        result.page.on("console", lambda message: result.console.append(f"{message.type}: {message.text}"))
        result.page.on("pageerror", lambda error: result.console.append(f"exception: {error}"))
        result.page.on("request", lambda request: result.requests.append(request.url))
        result.page.goto("file://" + quote(str(path)) + (f"#{fragment}" if fragment else ""))
        return result

    yield go
    for page in pages:
        page.close()


def case_path(tree: Path, case: str) -> Path:
    return tree / "report" / "cases" / f"{case}.html"
