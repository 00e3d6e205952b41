"""JUnit XML of a run: a suite per scene, a test case per pair and per render that brought no picture.

Written to be valid against both schemas in wide use, Ant's (JUnit.xsd) and Jenkins' (junit-10.xsd). That is why causes are
properties of the suite, named by their test case, why a failed render is a `failure` and no `error`, and why `testsuites` has no
attributes: the two schemas have no more in common.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence

from equilux.ci.outcome import Outcome, of_case
from equilux.ci.view import RunView
from equilux.results import CaseRecord

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 §2.2 does not allow, not even as a character reference."""
_ANSI = re.compile(r"\x1b\[[0-9;?]*[ -/]*[@-~]")


def junit(view: RunView) -> bytes:
    """The whole document, UTF-8."""
    root = ET.Element("testsuites")
    scenes: dict[str, list[CaseRecord]] = {}
    for case in view.results.cases:
        scenes.setdefault(case.scene, []).append(case)
    for index, (scene, cases) in enumerate(scenes.items()):
        root.append(_suite(index, scene, cases, view))
    if view.errors:
        root.append(_engine(len(scenes), view))
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def xml_text(text: str) -> str:
    """Text that XML can hold: colours of a terminal removed, other control characters shown as Python writes them."""
    return _NOT_XML.sub(lambda match: match.group().encode("unicode_escape").decode("ascii"), _ANSI.sub("", text))


def _suite(index: int, scene: str, cases: Sequence[CaseRecord], view: RunView) -> ET.Element:
    outcomes = [(f"{case.case}::{outcome.name}", outcome) for case in cases for outcome in of_case(case, view)]
    suite = _empty_suite(index, scene, [outcome for _, outcome in outcomes], view)
    properties = ET.SubElement(suite, "properties")
    facts = [
        ("model", cases[0].model),
        *((f"{name} {fact}", value) for name, outcome in outcomes for fact, value in outcome.facts),
    ]
    for name, value in facts:
        ET.SubElement(properties, "property", name=xml_text(name), value=xml_text(value))
    for name, outcome in outcomes:
        test = ET.SubElement(suite, "testcase", classname=scene, name=name, time=f"{outcome.seconds:.3f}")
        if outcome.result == "failed":
            failure = ET.SubElement(test, "failure", type=outcome.kind, message=xml_text(outcome.message))
            failure.text = xml_text(outcome.text)
        elif outcome.result == "skipped":
            ET.SubElement(test, "skipped", message=xml_text(outcome.message))
    return _ended(suite)


def _engine(index: int, view: RunView) -> ET.Element:
    """Faults of the engine itself: a run that could not do its work must not look passed."""
    faults = [Outcome(f"fault {number}", "failed", "engine-fault", error) for number, error in enumerate(view.errors, 1)]
    suite = _empty_suite(index, "equilux", faults, view)
    ET.SubElement(suite, "properties")
    for fault in faults:
        test = ET.SubElement(suite, "testcase", classname="equilux", name=fault.name, time="0.000")
        ET.SubElement(test, "failure", type=fault.kind, message=xml_text(fault.message)).text = xml_text(fault.message)
    return _ended(suite)


def _empty_suite(index: int, name: str, outcomes: Sequence[Outcome], view: RunView) -> ET.Element:
    return ET.Element(
        "testsuite",
        id=str(index),
        name=name,
        package="equilux",
        timestamp=view.results.run.started[:19],  # the schema's dateTime has no zone; ours is UTC
        hostname="localhost",  # the schema asks for one; results name no hosts
        tests=str(len(outcomes)),
        failures=str(sum(outcome.result == "failed" for outcome in outcomes)),
        errors="0",
        skipped=str(sum(outcome.result == "skipped" for outcome in outcomes)),
        time=f"{sum(outcome.seconds for outcome in outcomes):.3f}",
    )


def _ended(suite: ET.Element) -> ET.Element:
    for name in ("system-out", "system-err"):
        ET.SubElement(suite, name)
    return suite
