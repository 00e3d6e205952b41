"""junit.xml: what both schemas in wide use allow (Ant's JUnit.xsd, Jenkins' junit-10.xsd), and what it says."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest

from equilux.ci import RunView
from equilux.ci.junit import junit, xml_text

SUITE_ATTRIBUTES = {
    "id": r"\d+", "name": r".+", "package": r".+", "timestamp": r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "hostname": r".+",
    "tests": r"\d+",
    "failures": r"\d+", "errors": r"\d+", "skipped": r"\d+", "time": r"\d+\.\d{3}",
}  # fmt: skip
"""Ant's schema requires all but `skipped`; Jenkins' allows them, with three decimals of a second at most."""


@pytest.fixture
def root(view: RunView) -> ET.Element:
    return ET.fromstring(junit(view))


def named(root: ET.Element, name: str) -> ET.Element:
    (test,) = [test for test in root.iter("testcase") if test.get("name") == name]
    return test


def test_the_document_has_only_what_both_schemas_allow_in_their_order(root: ET.Element):
    assert (root.tag, root.attrib) == ("testsuites", {})
    for suite in root:
        assert suite.tag == "testsuite"
        assert set(suite.attrib) == set(SUITE_ATTRIBUTES)
        for name, pattern in SUITE_ATTRIBUTES.items():
            assert re.fullmatch(pattern, suite.attrib[name]), f"{name}={suite.attrib[name]!r}, allowed {pattern}"
        tags = [child.tag for child in suite]
        assert tags == ["properties", *["testcase"] * (len(tags) - 3), "system-out", "system-err"]
        assert all((child.tag, set(child.attrib)) == ("property", {"name", "value"}) for child in suite[0])
        for test in suite.iter("testcase"):
            assert set(test.attrib) == {"classname", "name", "time"}
            assert [child.tag for child in test] in ([], ["failure"], ["skipped"])
            assert all(set(child.attrib) <= {"type", "message"} for child in test)


def test_the_counts_of_a_suite_are_those_of_its_test_cases(root: ET.Element):
    for suite in root:
        counted = [len(list(suite.iter(tag))) for tag in ("testcase", "failure", "skipped")]
        assert counted == [int(suite.attrib[name]) for name in ("tests", "failures", "skipped")], suite.get("name")
        spent = sum(float(test.attrib["time"]) for test in suite.iter("testcase"))
        assert spent == pytest.approx(float(suite.attrib["time"]), abs=0.001 * int(suite.attrib["tests"]))  # rounded to 1 ms each


def test_there_is_a_suite_per_scene_and_a_test_case_per_pair_and_per_render_without_a_picture(root: ET.Element):
    names = [(suite.get("name"), [test.get("name") for test in suite.iter("testcase")]) for suite in root]
    pairs = ["povray--oracle", "vtk--oracle", "vtk--povray", "vtk--reference", "reference--oracle", "mitsuba", "opengl", "extra"]
    assert names == [
        ("clay", [*(f"clay[exponent=1]::{name}" for name in pairs), "clay[exponent=1000]::vtk--oracle"]),
        ("fog", ["fog::vtk--oracle"]),
        ("equilux", ["fault 1"]),
    ]


@pytest.mark.parametrize(
    ("name", "tag", "kind"),
    [
        ("clay[exponent=1]::vtk--oracle", "failure", "diverge_unexpected"),
        ("clay[exponent=1]::povray--oracle", "failure", "improved"),
        ("clay[exponent=1]::mitsuba", "failure", "crashed"),
        ("clay[exponent=1]::opengl", "skipped", None),
        ("clay[exponent=1]::extra", "skipped", None),
        ("fog::vtk--oracle", "skipped", None),
        ("fault 1", "failure", "engine-fault"),
    ],
)
def test_what_fails_a_run_fails_here_and_what_does_not_is_skipped(root: ET.Element, name: str, tag: str, kind: str | None):
    (child,) = named(root, name)
    assert (child.tag, child.get("type")) == (tag, kind)


@pytest.mark.parametrize("name", ["clay[exponent=1000]::vtk--oracle", "clay[exponent=1]::reference--oracle"])
def test_what_is_expected_or_agrees_passes(root: ET.Element, name: str):
    assert list(named(root, name)) == []


def test_a_missing_renderer_that_was_asked_for_by_name_fails(view: RunView):
    (child,) = named(ET.fromstring(junit(replace(view, named=frozenset({"extra"})))), "clay[exponent=1]::extra")
    assert (child.tag, child.get("type")) == ("failure", "missing")


def test_a_render_is_timed_once_and_a_reused_one_not_at_all(root: ET.Element):
    times = {test.get("name"): float(test.attrib["time"]) for test in root.iter("testcase")}
    assert times["clay[exponent=1]::povray--oracle"] == 3.0  # both renders, 1.5 s each
    assert times["clay[exponent=1]::vtk--oracle"] == 1.5
    assert times["clay[exponent=1]::vtk--reference"] == 0.0


def test_causes_are_properties_named_by_their_test_case(root: ET.Element):
    found = {(each.get("name"), each.get("value")) for each in root[0].iter("property")}
    assert ("clay[exponent=1]::vtk--oracle cause", "vtk: exponent-clamped [128]") in found
    assert ("clay[exponent=1]::vtk--oracle explained", "0.998") in found
    assert ("clay[exponent=1000]::vtk--oracle expected cause", "vtk: exponent-clamped") in found
    assert ("clay[exponent=1]::opengl missing feature", "model.phong") in found


def test_what_a_renderer_writes_never_breaks_the_document(root: ET.Element):
    (failure,) = named(root, "clay[exponent=1]::mitsuba")
    text = failure.text or ""
    assert "parse error at line 3: \\x00\\x08 <&>]]> \\uffff" in text
    assert "crashed by signal 11 after 2 attempts" in text
    assert "program given to mitsuba: out/cases/clay[exponent=1]/mitsuba/program/scene.xml" in text


def test_text_that_xml_cannot_hold_is_shown_as_python_writes_it():
    assert xml_text("a\x00b\x1fc\ud800d\ufffee\tf\n\x1b[1;31mg") == "a\\x00b\\x1fc\\ud800d\\ufffee\tf\ng"
