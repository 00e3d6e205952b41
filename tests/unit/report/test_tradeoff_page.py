"""The page of a measurement of the trade: whole, escaped, and every number of its JSON in reach."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from equilux.tradeoff.answers import answers
from equilux.tradeoff.presets import derive
from equilux.tradeoff.record import Cost, FeatureCost, StartUp
from equilux_report import build_tradeoff
from equilux_report.tradeplots import marks_of, trade_plot
from support.made_up_trade import about, case, failed, measurement, setting

SETTINGS = [
    setting("facets <16>", 0.1, 1e-2), setting("facets 64", 0.3, 1e-4, most_accurate_knobs=True), setting("wasteful", 0.4, 1e-3),
    failed("broken"),
]  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    found = measurement(case("ball[p=1]", quick=SETTINGS, slow=[setting("default", 2.0, 0.0)]))
    found.answers = answers(found.cases, "wall", errors=[1e-3], times=[0.2])
    found.start_up = {
        "quick": StartUp(wall=about(0.5), cpu=about(0.2), small_picture_wall=about(0.01), small_picture_cpu=about(0.01))
    }
    spreads = {f"{kind}_{clock}": about(0.1) for kind in ("without", "with", "extra") for clock in ("wall", "cpu")}
    renderers = {"quick": Cost(status="measured", **spreads), "slow": Cost(status="unsupported", reason="cannot mirror")}
    found.features = [FeatureCost(feature="mirror", words="mirrors", with_case="on", without_case="off", renderers=renderers)]
    found.presets = derive(found)
    (tmp_path / "tradeoff.json").write_text(json.dumps(found.model_dump(mode="json")))
    return tmp_path


def test_the_page_tells_of_every_setting_answer_preset_and_feature(folder: Path):
    page = build_tradeoff(folder)
    text = page.read_text()
    told = ("facets 64", "wasteful", "ended by SIGSEGV", "cheapest with error ≤ 0.001", "within 0.2 s", "balanced")
    for words in (*told, "mirror", "cannot mirror"):
        assert words in text, words
    assert "facets &lt;16&gt;" in text
    assert "facets <16>" not in text
    assert (page.parent / "static" / "report.css").is_file()


def test_the_plots_are_files_of_their_own_and_well_formed(folder: Path):
    build_tradeoff(folder)
    assert sorted(path.name for path in folder.glob("*.svg")) == ["ball_p=1_-cpu.svg", "ball_p=1_-wall.svg", "features.svg"]
    for path in folder.glob("*.svg"):
        assert ET.parse(path).getroot().tag == "{http://www.w3.org/2000/svg}svg"


def test_every_mark_of_a_plot_lies_on_the_paper_an_error_of_0_too(folder: Path):
    measured = json.loads((folder / "tradeoff.json").read_bytes())
    marks = marks_of(measured["cases"][0], "wall", ("quick", "slow"))
    assert [mark.y for mark in marks] == [1e-2, 1e-4, 1e-3, 0.0]
    root = ET.fromstring(trade_plot(marks, ("quick", "slow"), "t", "wall"))
    labels = [node for node in root.iter("{http://www.w3.org/2000/svg}text") if node.get("class") == "halo"]
    assert {node.text for node in labels} == {"facets <16>", "facets 64", "default"}
    for node in labels:
        assert 0 <= float(node.get("x", "nan")) <= 760
        assert 0 <= float(node.get("y", "nan")) <= 430


def test_what_is_no_measurement_is_refused(tmp_path: Path):
    (tmp_path / "tradeoff.json").write_text('{"schema": "other"}')
    with pytest.raises(ValueError, match="expected equilux/tradeoff/1"):
        build_tradeoff(tmp_path)
