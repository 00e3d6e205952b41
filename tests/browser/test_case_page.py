"""The page of one case: what it draws and says is what the files hold, bit for bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio
import pytest
from playwright.sync_api import Page

from browser.conftest import Opened, Opener, case_path
from browser.fake_tree import PHOTOMETRY

pytestmark = pytest.mark.browser

BANDS = ("R", "G", "B")
CLAMPED = "clay-ball[exponent=1000]"


def exr(path: Path, names: tuple[str, ...] = BANDS) -> npt.NDArray[np.float32]:
    """(h, w, channels) in the order named."""
    buffer = oiio.ImageBuf(str(path))
    order = [buffer.spec().channelnames.index(name) for name in names]
    return np.asarray(buffer.get_pixels(oiio.FLOAT), dtype=np.float32)[:, :, order]


def pair_exr(tree: Path, case: str, pair: str) -> npt.NDArray[np.float32]:
    return exr(tree / "cases" / case / "pairs" / f"{pair}.exr", (*BANDS, *(f"en.{band}" for band in BANDS), "class"))


def picture(page: Page, title: str) -> Any:
    return page.locator("figure.picture", has=page.locator("figcaption b", has_text=title)).locator("canvas")


def colour_at(page: Page, title: str, x: int, y: int, scale: int, case_x: int, case_y: int) -> tuple[int, int, int]:
    """Colour drawn for film pixel (x, y) on a canvas zoomed by `scale` about the centre of pixel (case_x, case_y)."""
    script = """(canvas, [x, y, scale, cx, cy]) => {
        const px = Math.round(canvas.width / 2 - scale * (cx + 0.5)) + scale * (x + 0.3);
        const py = Math.round(canvas.height / 2 - scale * (cy + 0.5)) + scale * (y + 0.3);
        return [...canvas.getContext('2d').getImageData(px, py, 1, 1).data].slice(0, 3);
    }"""
    r, g, b = picture(page, title).evaluate(script, [x, y, scale, case_x, case_y])
    return r, g, b


def inspect(view: Opened, x: int, y: int) -> dict[str, Any]:
    """Type a pixel and read all that the inspector then says of it."""
    view.page.fill("input[name=x]", str(x))
    view.page.fill("input[name=y]", str(y))
    script = """() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done({
        ...Object.fromEntries([...document.querySelectorAll('[data-value]')].map(cell => [cell.dataset.value, cell.textContent])),
        ...Object.fromEntries([...document.querySelectorAll('[data-row]')].map(row =>
            [row.dataset.row, [...row.querySelectorAll('td')].map(cell => cell.textContent)])),
    }))))"""
    shown: dict[str, Any] = view.page.evaluate(script)
    return shown


def as_float32(text: str) -> np.float32:
    return np.float32(float(text.replace("Inf", "inf")))


def same(text: str, value: np.float32) -> bool:
    shown = as_float32(text)
    return bool(shown == value) or bool(np.isnan(shown) and np.isnan(value))


@pytest.mark.parametrize("case", ["three-bands", "broken-floor", CLAMPED])
def test_inspector_shows_the_float32_values_of_the_files_exactly(tree: Path, opened: Opener, case: str) -> None:
    view = opened(case_path(tree, case))
    view.settled()
    pair = view.page.input_value("select[name=pair]")
    planes = pair_exr(tree, case, pair)
    images = {name: exr(tree / "cases" / case / name / "image.exr") for name in ("oracle", "povray", "reference", "vtk")}
    for x, y in [(40, 30), (10, 50), (12, 50), (60, 60), (51, 28), (0, 0), (95, 71)]:
        shown = inspect(view, x, y)
        for name, image in images.items():
            for band, value in zip(BANDS, image[y, x], strict=True):
                text = shown[f"{name}.{band}"]
                assert same(text, value), f"{name} {band} at ({x}, {y}): page {text}, file {value!r}"
        for row, offset in (("difference", 0), ("en", 3)):
            for text, value in zip(shown[row], planes[y, x, offset : offset + 3], strict=True):
                assert same(text, value), f"{pair} {row} at ({x}, {y}): page {text}, file {value!r}"
        assert shown["class"] == [("agree", "diverge", "edge", "invalid")[int(planes[y, x, 6])]]


@pytest.mark.parametrize("case", ["three-bands", CLAMPED])
def test_the_inspector_shows_luminance_as_the_weighted_sum_of_the_bands(tree: Path, opened: Opener, case: str) -> None:
    view = opened(case_path(tree, case))
    view.settled()
    weights = PHOTOMETRY["luminance_weights"]
    for x, y in [(40, 30), (51, 28)]:
        expected = float(exr(tree / "cases" / case / "oracle" / "image.exr")[y, x].astype(np.float64) @ weights)
        shown = float(inspect(view, x, y)["oracle.lum"].replace("\u2009", "").replace("−", "-"))
        assert shown == pytest.approx(expected, rel=1e-3), f"page {shown} cd/m², files {expected}"  # four digits


def test_the_legend_of_a_luminance_picture_is_in_candela_per_square_metre(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, CLAMPED), "map=false&band=lum&ev=0")
    view.settled()
    legend = view.page.locator("figure.picture", has=view.page.locator("figcaption b", has_text="oracle")).locator(".legend")
    white = float(legend.locator(".legend__ticks span").last.inner_text())
    assert legend.locator(".legend__unit").inner_text() == "luminance, cd/m²"
    assert white == pytest.approx(683.002, abs=0.5), f"white is one W/(m²·sr) in each band: {white} cd/m², K_m 683.002"


@pytest.mark.parametrize(("case", "rows"), [("three-bands", ["R", "G", "B"]), (CLAMPED, ["R G B"])])
def test_every_material_has_its_plots_and_its_checks(tree: Path, opened: Opener, case: str, rows: list[str]) -> None:
    view = opened(case_path(tree, case))
    material = view.page.locator("#materials .material")
    assert material.count() == 1
    assert material.locator("svg.brdf").count() == 2
    assert material.locator("svg").first.locator("polyline.curve").count() == len(rows)
    assert material.locator("tbody th").all_inner_texts() == rows
    assert "grows like 1/cosθ" in material.locator("tbody tr").first.inner_text()
    assert view.page.evaluate("window.hacked") is None


def test_bound_is_difference_over_normalised_error(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, CLAMPED))
    view.settled()
    planes = pair_exr(tree, CLAMPED, "vtk--oracle")
    x, y = (int(view.page.input_value(f"input[name={axis}]")) for axis in "xy")
    expected = float(planes[y, x, 0]) / float(planes[y, x, 3])
    shown = float(view.page.locator("[data-row=bound] td").first.inner_text())
    assert shown == pytest.approx(expected, rel=1e-4), f"page {shown}, files {expected}"  # shown to five digits


def test_the_page_opens_at_its_worst_pixel(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, CLAMPED))
    view.settled()
    worst = json.loads((tree / "cases" / CLAMPED / "pairs" / "vtk--oracle.json").read_text())["worst"]
    assert [int(view.page.input_value(f"input[name={axis}]")) for axis in "xy"] == [worst["x"], worst["y"]]


def test_a_link_selects_its_pixel(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"), "x=17&y=40")
    view.settled()
    assert [view.page.input_value(f"input[name={axis}]") for axis in "xy"] == ["17", "40"]


def test_hovering_and_clicking_inspect_the_pixel_under_the_pointer(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"))
    view.settled()
    canvas = picture(view.page, "povray")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    scale = box["width"] / 96
    view.page.mouse.move(box["x"] + 20.5 * scale, box["y"] + 33.5 * scale)
    view.drawn()
    assert [view.page.input_value(f"input[name={axis}]") for axis in "xy"] == ["20", "33"]
    view.page.mouse.click(box["x"] + 61.5 * scale, box["y"] + 12.5 * scale)
    view.page.mouse.move(5, 5)
    view.page.wait_for_function("location.hash.includes('x=61&y=12')")
    assert [view.page.input_value(f"input[name={axis}]") for axis in "xy"] == ["61", "12"]


def test_arrows_step_the_inspected_pixel(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"), "x=17&y=40")
    view.settled()
    view.page.focus(".viewer__panels")
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "Shift+ArrowDown"):
        view.page.keyboard.press(key)
    view.drawn()
    assert [view.page.input_value(f"input[name={axis}]") for axis in "xy"] == ["19", "49"]


def srgb_level(linear: float) -> float:
    clipped = min(max(linear, 0.0), 1.0)
    return 255 * (12.92 * clipped if clipped <= 0.0031308 else 1.055 * clipped ** (1 / 2.4) - 0.055)


@pytest.mark.parametrize("stops", [-3, 0, 1.5, 4])
def test_exposure_changes_the_drawn_colours_as_predicted(tree: Path, opened: Opener, stops: float) -> None:
    view = opened(case_path(tree, "three-bands"), f"ev={stops}&x=50&y=30&z=8")
    view.settled()
    image = exr(tree / "cases" / "three-bands" / "povray" / "image.exr")
    for x, y in [(48, 28), (52, 33), (46, 36), (55, 31)]:
        drawn = colour_at(view.page, "povray", x, y, 8, 50, 30)
        wanted = [srgb_level(float(value) * 2**stops) for value in image[y, x]]
        # Half a level by rounding, and 0.03 by the encoding table.
        far = max(abs(level - want) for level, want in zip(drawn, wanted, strict=True))
        assert far <= 0.53, f"at ({x}, {y}), {stops} stops: drawn {drawn}, predicted {wanted}"


def test_exposure_keys_move_by_half_stops_and_auto_goes_back(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"))
    view.settled()
    start = float(view.page.input_value("input[name=ev]"))
    view.page.keyboard.press("]")
    view.page.keyboard.press("]")
    view.drawn()
    assert float(view.page.input_value("input[name=ev]")) == pytest.approx(start + 1)
    view.page.click("[data-auto]")
    view.drawn()
    assert float(view.page.input_value("input[name=ev]")) == pytest.approx(start)


def test_signed_difference_has_two_colours_and_errors_within_the_uncertainty_stay_dim(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, CLAMPED), "z=8&x=51&y=29")
    view.settled()
    planes = pair_exr(tree, CLAMPED, "vtk--oracle")
    for x, y in [(51, 29), (50, 27), (46, 34), (45, 32)]:
        en = planes[y, x, 3]
        r, g, b = colour_at(view.page, "normalised error", x, y, 8, 51, 29)
        brightness = max(r, g, b)
        if abs(en) > 1:
            assert brightness > 115, f"E_n {en} at ({x}, {y}) is drawn {r, g, b}"
            assert (r > b) == (en > 0), f"E_n {en} at ({x}, {y}) is drawn {r, g, b}"
        else:
            assert brightness < 115, f"E_n {en} at ({x}, {y}) is drawn {r, g, b}"


def test_invalid_values_are_drawn_in_colours_of_their_own_and_counted(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "broken-floor"), "z=8&x=41&y=31")
    view.settled()
    assert colour_at(view.page, "povray", 43, 32, 8, 41, 31) == (255, 0, 255)
    figure = view.page.locator("figure.picture", has=view.page.locator("figcaption b", has_text="povray"))
    counts = json.loads((tree / "cases" / "broken-floor" / "povray" / "render.json").read_text())["image"]
    for kind, key in (("nan", "nan"), ("plusInf", "+inf"), ("minusInf", "-inf")):
        shown = figure.locator(f"[data-odd={kind}]").inner_text()
        assert shown.split()[0] == str(counts[key]), f"{kind}: page {shown}, render.json {counts[key]}"


def test_zoom_and_pan_move_all_pictures_together(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"))
    view.settled()
    canvas = picture(view.page, "vtk")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    view.page.mouse.move(box["x"] + box["width"] / 3, box["y"] + box["height"] / 3)
    for _ in range(6):
        before = view.page.locator("output[name=zoom-out]").inner_text()
        view.page.mouse.wheel(0, -120)
        view.page.wait_for_function("before => document.querySelector('output[name=zoom-out]').value !== before", arg=before)
    view.page.mouse.down()
    view.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, steps=4)
    view.page.mouse.up()
    view.page.mouse.move(5, 5)
    view.drawn()
    script = "viewer => viewer.panels.map(panel => viewer.view.place(panel.canvas, panel.picture))"
    places = view.page.locator("eq-viewer").evaluate(script)
    assert len(places) == 6
    assert all(place == places[0] for place in places), places
    same_pixels = """viewer => {
        const data = name => { const c = viewer.panels.find(p => p.caption.textContent.startsWith(name)).canvas;
                               return c.getContext('2d').getImageData(0, 0, c.width, c.height).data; };
        const [a, b] = [data('oracle'), data('reference')];
        return a.every((value, i) => value === b[i]);
    }"""
    assert view.page.locator("eq-viewer").evaluate(same_pixels)
    view.page.keyboard.press("0")
    view.drawn()
    assert view.page.locator("output[name=zoom-out]").inner_text() == "fit"


def test_zoomed_pixels_have_hard_edges(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"), "z=8&x=50&y=30")
    view.settled()
    colours = """canvas => {
        const row = Math.round(canvas.height / 2 - 8 * 30.5) + 8 * 28 + 2;
        const data = canvas.getContext('2d').getImageData(0, row, canvas.width, 1).data;
        const steps = [];
        for (let x = 1; x < canvas.width; x += 1) if ([0, 1, 2].some(k => data[4 * x + k] !== data[4 * x - 4 + k])) steps.push(x);
        const left = Math.round(canvas.width / 2 - 8 * 50.5);
        return steps.filter(x => (x - left) % 8 !== 0);
    }"""
    assert picture(view.page, "oracle").evaluate(colours) == []


def test_flip_shows_the_other_picture_while_held(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, CLAMPED), "mode=flip&a=oracle&b=vtk")
    view.settled()
    title = view.page.locator("figure.picture figcaption b")
    assert title.all_inner_texts() == ["oracle"]
    view.page.keyboard.down(" ")
    view.drawn()
    assert title.all_inner_texts() == ["vtk"]
    view.page.keyboard.up(" ")
    view.drawn()
    assert title.all_inner_texts() == ["oracle"]
    box = view.page.locator("[data-hold]").bounding_box()
    view.page.mouse.move(box["x"] + 5, box["y"] + 5)
    view.page.mouse.down()
    assert title.all_inner_texts() == ["vtk"]
    view.page.mouse.up()
    assert title.all_inner_texts() == ["oracle"]


def test_wipe_shows_one_picture_left_and_the_other_right(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"), "mode=wipe&a=oracle&b=en&wipe=0.5")
    view.settled()
    sample = """(canvas, t) => {
        const data = canvas.getContext('2d').getImageData(canvas.width * t, canvas.height * 0.02, 1, 1).data;
        return [...data].slice(0, 3);
    }"""
    canvas = view.page.locator("figure.picture canvas")
    left, right = canvas.evaluate(sample, 0.3), canvas.evaluate(sample, 0.7)
    assert left == [0, 0, 0]
    assert right == [20, 20, 20] or max(right) < 40
    assert left != right


def test_worst_link_goes_to_the_worst_pixel_and_zooms_in(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, CLAMPED), "x=1&y=1")
    view.settled()
    worst = json.loads((tree / "cases" / CLAMPED / "pairs" / "vtk--povray.json").read_text())["worst"]
    view.page.click(f"article[data-pair=vtk--povray] a:has-text('worst pixel ({worst['x']}, {worst['y']})')")
    view.page.wait_for_function(f"location.hash.includes('x={worst['x']}&y={worst['y']}')")
    assert [int(view.page.input_value(f"input[name={axis}]")) for axis in "xy"] == [worst["x"], worst["y"]]
    assert view.page.input_value("select[name=pair]") == "vtk--povray"
    assert view.page.locator("output[name=zoom-out]").inner_text() == "×16"


@pytest.mark.parametrize("case", [CLAMPED, "three-bands", "broken-floor"])
def test_class_map_counts_equal_the_pairs_json(tree: Path, opened: Opener, case: str) -> None:
    view = opened(case_path(tree, case), "cls=1")
    view.settled()
    assert view.page.is_checked("input[name=cls]")
    for pair in view.page.locator("select[name=pair] option").evaluate_all("options => options.map(o => o.value)"):
        view.page.select_option("select[name=pair]", pair)
        view.page.wait_for_function(f"document.querySelector('.inspector__classes').dataset.pair === '{pair}'")
        told = json.loads((tree / "cases" / case / "pairs" / f"{pair}.json").read_text())
        for name in ("agree", "diverge", "edge", "invalid"):
            shown = view.page.locator(f".inspector__classes [data-class={name}] b").inner_text().replace("\u202f", "")
            assert int(shown) == told[name], f"{pair} {name}: page {shown}, file {told[name]}"


def test_class_map_is_drawn_where_the_class_is(tree: Path, opened: Opener) -> None:
    plain = opened(case_path(tree, CLAMPED), "z=8&x=51&y=29")
    plain.settled()
    marked = opened(case_path(tree, CLAMPED), "z=8&x=51&y=29&cls=1")
    marked.settled()
    planes = pair_exr(tree, CLAMPED, "vtk--oracle")
    tile = "(canvas, [px, py]) => [...canvas.getContext('2d').getImageData(px, py, 8, 8).data]"
    for x, y in [(51, 27), (40, 40)]:
        at = "canvas => [Math.round(canvas.width / 2 - 8 * 51.5), Math.round(canvas.height / 2 - 8 * 29.5)]"
        left, top = picture(plain.page, "oracle").evaluate(at)
        before, after = (picture(v.page, "oracle").evaluate(tile, [left + 8 * x, top + 8 * y]) for v in (plain, marked))
        assert (before != after) == (planes[y, x, 6] == 1), f"class {planes[y, x, 6]} at ({x}, {y})"


def test_state_survives_a_reload(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"))
    view.settled()
    view.page.select_option("select[name=map]", "log")
    view.page.select_option("select[name=band]", "B")
    view.page.check("input[name=mode][value=wipe]", force=True)
    view.page.wait_for_function("['mode=wipe', 'map=log', 'band=B'].every(part => location.hash.includes(part))")
    view.page.reload()
    view.settled()
    assert view.page.input_value("select[name=map]") == "log"
    assert view.page.input_value("select[name=band]") == "B"
    assert view.page.locator("figure.picture").count() == 1


def test_only_what_is_looked_at_is_loaded(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "three-bands"))
    view.settled()
    loaded = {Path(url).name for url in view.requests if "/data/" in url}
    against_truth = {"povray--oracle.js", "reference--oracle.js", "vtk--oracle.js"}
    assert loaded == {"oracle.js", "povray.js", "reference.js", "vtk.js", *against_truth}
    view.page.select_option("select[name=pair]", "vtk--povray")
    view.page.wait_for_function("document.querySelector('.inspector__classes').dataset.pair === 'vtk--povray'")
    assert any("vtk--povray.js" in url for url in view.requests)


@pytest.mark.parametrize("case", [CLAMPED, "broken-floor", "crash-test", "slow-mesh", "half-size"])
def test_case_pages_open_without_errors_and_ask_nobody_for_anything(tree: Path, opened: Opener, case: str) -> None:
    view = opened(case_path(tree, case))
    view.settled()
    assert view.console == []
    assert view.foreign == []


def test_verdict_is_said_in_words(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, CLAMPED))
    said = view.page.locator(".lines--verdicts li").first.inner_text()
    told = json.loads((tree / "cases" / CLAMPED / "pairs" / "vtk--oracle.json").read_text())
    assert said.startswith(f"vtk diverges from oracle on {told['diverge']} of 6\u202f912 pixels")
    assert f"worst at ({told['worst']['x']}, {told['worst']['y']})" in said
    assert "pinned as exponent-clamped" in said


def test_programs_budgets_timings_and_stderr_are_shown_as_they_are(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "crash-test"))
    view.settled()
    render = view.page.locator("details.render[data-adapter=vtk]")
    facts = json.loads((tree / "cases" / "crash-test" / "vtk" / "render.json").read_text())
    assert render.locator("pre.stderr").inner_text() == facts["stderr_tail"]
    program = (tree / "cases" / "crash-test" / "vtk" / "program" / "scene.txt").read_text()
    assert render.locator("eq-copy pre").first.text_content() == program
    assert "mesh.bin" in render.inner_text()
    assert "10.2\u202fkB, not shown" in render.inner_text()
    budget = view.page.locator("details.render[data-adapter=reference] table.budget").text_content()
    assert "tessellation" in budget
    assert "sagitta of the facets" in budget
    assert view.page.evaluate("window.hacked") is None


def test_hostile_words_stay_words(tree: Path, opened: Opener) -> None:
    view = opened(case_path(tree, "crash-test"))
    view.settled()
    assert "<script>window.hacked = 1</script>" in view.page.locator("p.about").inner_text()
    assert view.page.evaluate("window.hacked") is None
    assert view.page.locator("img[src='x']").count() == 0
    assert view.console == []


def test_a_missing_data_file_is_named_and_breaks_nothing_else(tree: Path, opened: Opener) -> None:
    data = tree / "report" / "data" / "spot-cone" / "vtk.js"
    hidden = data.rename(data.with_suffix(".away"))
    try:
        view = opened(case_path(tree, "spot-cone"))
        view.page.wait_for_function("document.body.textContent.includes('vtk.js is missing')")
        assert view.page.locator("[data-value='povray.R']").inner_text() != "–"
    finally:
        hidden.rename(data)
