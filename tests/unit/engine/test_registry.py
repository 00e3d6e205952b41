"""Adapters are found by entry point, loaded lazily, and whatever is wrong with one is said of that one."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from equilux.complaint import BadUsage
from equilux.registry import Registry
from support.engine import LABORATORIES, entry

BROKEN = LABORATORIES.parent / "broken_laboratories"
RIVAL = LABORATORIES.parent / "rival_laboratories"


def test_adapters_of_every_distribution_on_the_path_are_found():
    found = Registry.discover()
    assert {"good", "absent", "reference", "oracle"} <= set(found.names)
    assert found.entries["good"].distribution == "fake-laboratories"
    assert found.entries["good"].error is None


def test_nothing_is_imported_before_it_is_looked_at(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delitem(sys.modules, "fake_laboratories", raising=False)
    found = Registry.discover()
    assert "fake_laboratories" not in sys.modules
    assert found.entries["good"].version == "fake 1.0"
    assert "fake_laboratories" in sys.modules


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("incomplete", "missing lack_causes, probe, capabilities, translate, render, read"),
        ("unimportable", "cannot be loaded: ModuleNotFoundError"),
        ("elsewhere", "cannot be loaded: AttributeError"),
        ("outdated", "api_version is 99, this equilux speaks 1"),
        ("outdated", "translate is not callable"),
        ("unborn", "it is the class Unborn; register an instance of it"),
        ("leaving", "it called sys.exit('not today')"),
        ("misnamed", "its name is 'outdated', it is registered as 'misnamed'"),
    ],
)
def test_what_is_no_adapter_says_what_it_lacks(monkeypatch: pytest.MonkeyPatch, name: str, says: str):
    monkeypatch.syspath_prepend(BROKEN)
    found = Registry.discover().entries[name]
    assert found.adapter is None
    assert found.error is not None
    assert says in found.error, f"got {found.error!r}, expected it to say {says!r}"
    assert not found.probe.found


def test_a_name_claimed_by_two_distributions_is_an_error_that_names_both(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(RIVAL)
    with pytest.raises(BadUsage) as problem:
        Registry.discover()
    (line,) = problem.value.lines
    assert "'good'" in line
    assert "fake-laboratories" in line
    assert "rival-laboratories" in line


def test_a_distribution_found_twice_on_the_path_counts_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    (tmp_path / "again").symlink_to(LABORATORIES)
    monkeypatch.syspath_prepend(tmp_path / "again")
    assert "good" in Registry.discover().names


def test_an_adapter_that_raises_where_it_must_not_is_reported():
    speechless = entry("speechless")
    assert speechless.version == "unknown (RuntimeError: no version)"
    assert speechless.probe.detail == "probe() raised OSError: no idea"


def test_an_unknown_adapter_is_answered_with_the_known_and_the_nearest():
    with pytest.raises(BadUsage) as problem:
        Registry([entry("good"), entry("slow")]).select(["god"])
    assert problem.value.lines == ("--adapters: unknown adapter 'god'; installed are good, slow (did you mean 'good'?)",)


def test_a_name_that_the_results_tree_uses_itself_cannot_be_an_adapter():
    assert "the name 'pairs' is taken by the results tree" in str(entry("pairs", "fake_laboratories:good").error)


def test_a_name_with_two_hyphens_cannot_be_an_adapter():
    found = entry("go--od", "fake_laboratories:good")
    assert "joined by single '-', '_' or '.'" in str(found.error)
