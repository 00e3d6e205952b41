"""Which adapter renders which case, and why the others do not, is decided before anything runs."""

from __future__ import annotations

import pytest

from equilux.complaint import BadUsage
from equilux.plan import filter_cases, select_adapters
from equilux_scenes.loader import load_scene_text
from support.engine import planned, registry, scene, scene_text

EXPECTS_HIGHLIGHT_MISSING = "expect:\n  - {adapter: matte, cause: highlight-missing}"


def action(adapter: str, *names: str, **options: object) -> tuple[str, tuple[str, ...]]:
    plan = planned([adapter, *names], **options)  # type: ignore[arg-type]
    (found,) = [render for render in plan.renders if render.adapter == adapter]
    return found.action, found.missing_features


def test_an_adapter_that_has_every_feature_runs():
    assert action("matte", scenes=[scene()]) == ("run", ())


def test_a_lacking_feature_makes_it_unsupported_and_is_named():
    assert action("matte", scenes=[scene(specular=0.5)]) == ("unsupported", ("material.specular",))


def test_no_adapter_needs_what_is_dealt_with_while_a_scene_is_read():
    found = load_scene_text(scene_text().replace("intensity: 7.5", "luminous_flux: 800"))
    assert {"input.photometric", "input.flux"} <= set(found.cases[0].requires)
    assert action("matte", scenes=[found]) == ("run", ())


def test_an_expectation_of_the_cause_that_stands_for_the_lack_lets_it_run():
    assert action("matte", scenes=[scene(specular=0.5, rest=EXPECTS_HIGHLIGHT_MISSING)]) == ("run", ())


@pytest.mark.parametrize("rest", [
    "expect:\n  - {adapter: matte, cause: diffuse-missing}",
    "expect:\n  - {adapter: good, cause: highlight-missing}",
])  # fmt: skip
def test_another_cause_or_another_adapter_does_not_let_it_run(rest: str):
    assert action("matte", scenes=[scene(specular=0.5, rest=rest)])[0] == "unsupported"


def test_an_expectation_lets_it_run_only_where_its_condition_holds():
    rest = (
        "sweep:\n  shine: {path: materials.clay.specular, values: [0.1, 0.9]}\n"
        'expect:\n  - {adapter: matte, cause: highlight-missing, when: "shine > 0.5"}'
    )
    plan = planned(["matte"], scenes=[scene(specular=0.5, rest=rest)])
    assert [render.action for render in plan.renders if render.adapter == "matte"] == ["unsupported", "run"]


def test_as_is_lets_every_laboratory_run():
    assert action("matte", scenes=[scene(specular=0.5)], as_is=True) == ("run", ())


MESH = """\
equilux: 1
name: meshy
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 30}
film: {width: 4, height: 3}
materials: {clay: {emission: 1}}
objects:
  - {kind: mesh, material: clay, vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces: [[0, 1, 2]]}
"""


def test_as_is_never_lets_a_truth_run_without_a_feature_it_lacks():
    plan = planned(["good", "reference"], scenes=[load_scene_text(MESH)], as_is=True)
    actions = {render.adapter: render.action for render in plan.renders}
    assert actions == {"good": "run", "oracle": "unsupported", "reference": "run"}


def test_a_renderer_that_is_not_installed_is_missing():
    assert action("absent") == ("missing", ())


def test_the_truths_are_added_when_they_are_not_named():
    selection = select_adapters(registry("good", "reference"), ["good"])
    assert selection.added == ("oracle", "reference")
    assert [entry.name for entry in selection.entries] == ["good", "oracle", "reference"]


def test_a_truth_that_is_named_is_not_added_again():
    selection = select_adapters(registry("good", "reference"), ["reference", "good", "good"])
    assert selection.added == ("oracle",)
    assert [entry.name for entry in selection.entries] == ["reference", "good", "oracle"]


def test_without_names_every_adapter_takes_part_and_none_counts_as_named():
    selection = select_adapters(registry("good", "reference"), None)
    assert [entry.name for entry in selection.entries] == ["good", "oracle", "reference"]
    assert (selection.named, selection.added) == (frozenset(), ())


SWEPT = scene("ball", specular=0.5, rest="sweep:\n  exponent: {path: materials.clay.exponent, values: [1, 10, 100]}").cases


@pytest.mark.parametrize(
    ("pattern", "matches"),
    [
        ("*", ["1", "10", "100"]),
        ("ball[exponent=1]", ["1"]),
        ("*=1*", ["1", "10", "100"]),
        ("*=1??", ["10"]),
        ("ball[[]exponent=1]", None),
        ("ball", None),
        ("[a-z]*", None),
    ],
)
def test_in_a_case_filter_only_star_and_question_mark_are_wild(pattern: str, matches: list[str] | None):
    if matches is None:
        with pytest.raises(BadUsage, match="matches none of the 3 cases"):
            filter_cases(SWEPT, pattern)
    else:
        assert [case.name for case in filter_cases(SWEPT, pattern)] == [f"ball[exponent={value}]" for value in matches]
