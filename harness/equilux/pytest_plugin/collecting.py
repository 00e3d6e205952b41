"""Spec files as pytest sees them: one item per case and pair."""

from __future__ import annotations

import dataclasses
import os
import traceback
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import pytest

from equilux.ci.outcome import Outcome, of_pair, of_render
from equilux.ci.view import shown
from equilux.complaint import BadUsage
from equilux.plan import matching_names
from equilux.pytest_plugin import _conductor
from equilux.pytest_plugin.session import Conductor
from equilux_scenes.case import Case
from equilux_scenes.errors import SpecError, SpecErrors
from equilux_scenes.loader import SceneFile, load_scene_file, repeated_names


class SpecWarning(pytest.PytestWarning):
    """What a spec says that is allowed and probably not meant."""


class Failed(Exception):
    """An item that failed; its text is all that is shown, without a traceback. The first line is the whole in short."""


class SpecFile(pytest.File):
    """One `*.scene.yaml`."""

    def collect(self) -> Iterable[pytest.Item | pytest.Collector]:
        conductor = _conductor(self.config)
        if not conductor.usable:
            return []  # the first file has said why
        try:
            bench = conductor.bench
        except BadUsage as problem:
            raise self.CollectError("\n".join(problem.lines)) from None
        try:
            scene = load_scene_file(self.path, bench.spec_limits)
            self._check_name(conductor, scene)
        except SpecErrors as problem:
            raise self.CollectError("\n".join(map(_located, problem.errors))) from None
        for warning in scene.warnings:
            warnings.warn_explicit(SpecWarning(warning.message), None, shown(self.path), warning.line)
        return [node for case in scene.cases for node in self._nodes(case, scene, conductor)]

    def _nodes(self, case: Case, scene: SceneFile, conductor: Conductor) -> list[pytest.Item | pytest.Collector]:
        """A swept case's name holds brackets, and pytest takes all that follows the first one on its command line for one name;
        so its items stand right below the file. Both kinds can be typed as they are printed."""
        if not case.axes:
            return [CaseNode.from_parent(self, name=case.name, case=case, line=scene.name_place[0])]
        return [
            PairItem.from_parent(self, name=f"{case.name}::{'--'.join(pair)}", case=case, pair=pair, line=scene.name_place[0])
            for pair in conductor.pairs(case)
        ]

    def _check_name(self, conductor: Conductor, scene: SceneFile) -> None:
        first = conductor.names.setdefault(scene.scene.name, scene)
        if first.path != scene.path and (errors := list(repeated_names([first, scene]))):
            raise SpecErrors(errors)


class CaseNode(pytest.Collector):
    """The one case of a scene that has no sweep."""

    def __init__(self, *, case: Case, line: int, **of_node: Any) -> None:
        super().__init__(**of_node)
        self.case, self.line = case, line

    def collect(self) -> Iterable[pytest.Item]:
        for pair in _conductor(self.config).pairs(self.case):
            yield PairItem.from_parent(self, name="--".join(pair), case=self.case, pair=pair, line=self.line)


class PairItem(pytest.Item):
    """Two renders of one case; or one render, where there is nothing to compare it with."""

    def __init__(self, *, case: Case, pair: tuple[str, ...], line: int, **of_node: Any) -> None:
        super().__init__(**of_node)
        self.case, self.pair, self.line = case, pair, line
        if _conductor(self.config).settings.marks_groups:
            self.add_marker(pytest.mark.xdist_group(case.scene_name))  # one process renders for all items of a scene

    def runtest(self) -> None:
        try:
            outcomes = list(self._outcomes())
        except BadUsage as problem:
            raise Failed("\n".join(problem.lines)) from None
        except Exception as problem:  # ours, not a renderer's
            raise Failed(
                f"{self.case.name}: equilux itself failed: {type(problem).__name__}: {problem}\n\n{traceback.format_exc()}"
            ) from None
        self._tell(outcomes)
        failed = [outcome for outcome in outcomes if outcome.result == "failed"]
        if failed:
            raise Failed("\n\n".join(outcome.text or outcome.message for outcome in failed))
        skipped = [outcome for outcome in outcomes if outcome.result == "skipped"]
        if skipped:
            reason = pytest.skip.Exception("; ".join(outcome.message for outcome in skipped))
            reason._use_item_location = True  # skipped scenes are listed by their file, not by this one
            raise reason

    def _outcomes(self) -> Iterable[Outcome]:
        """Of each side that brought no picture; else of the pair."""
        conductor = _conductor(self.config)
        part = conductor.part(self.case)
        record, view = part.record(self.case.name), conductor.view(part, self.case)
        label = "--".join(self.pair)
        faults = [error for error in part.errors if error.startswith(f"{self.case.name}: ") and self._concerns(error)]
        for fault in faults:
            yield Outcome(label, "failed", "engine-fault", f"equilux itself failed: {fault}")
        if record is None:
            yield Outcome(label, "failed", "not-run", f"{self.case.name}: nothing came of it: the run was stopped")
            return
        sides = [of_render(record, name, view) for name in self.pair if name in record.renders]
        without_picture = [side for side in sides if side is not None]
        yield from without_picture
        pair = next((pair for pair in record.pairs if (pair.a, pair.b) == self.pair), None)
        if pair is not None:
            yield of_pair(record, pair, view)
        elif not without_picture and not faults:
            yield Outcome(
                label, "failed", "not-compared", f"{self.case.name}: {label} was not compared, and equilux did not say why"
            )

    def _concerns(self, error: str) -> bool:
        return any(name in error for name in self.pair)

    def _tell(self, outcomes: Sequence[Outcome]) -> None:
        """For JUnit files and other plugins; `equilux.scored` is what exit codes go by."""
        for outcome in outcomes:
            self.user_properties.append(("equilux.result", outcome.kind))
            self.user_properties += [(f"equilux.{name.replace(' ', '_')}", value) for name, value in outcome.facts]
        self.user_properties.append(("equilux.scored", "yes" if any(outcome.scored for outcome in outcomes) else "no"))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if not isinstance(excinfo.value, Failed):
            return super().repr_failure(excinfo)
        shown_failure = excinfo.getrepr(style="value")
        if (crash := shown_failure.reprcrash) is not None:  # where a summary line points to, and what it says
            first = str(excinfo.value).partition("\n")[0]
            shown_failure.reprcrash = dataclasses.replace(crash, path=str(self.path), lineno=self.line, message=first)
        return shown_failure

    def reportinfo(self) -> tuple[os.PathLike[str] | str, int | None, str]:
        return self.path, self.line - 1, f"{self.case.name}::{'--'.join(self.pair)}"


def deselect(config: pytest.Config, items: list[pytest.Item], conductor: Conductor) -> None:
    """--equilux-case-filter. Raises UsageError where it leaves no case."""
    pattern = conductor.settings.case_filter
    names = list(dict.fromkeys(item.case.name for item in items if isinstance(item, PairItem)))
    if pattern is None or not names:
        return
    try:
        kept = set(matching_names(names, pattern))
    except BadUsage as problem:
        if not hasattr(config, "workerinput"):
            raise pytest.UsageError(str(problem).replace("--", "--equilux-", 1)) from None
        kept = set()
    dropped = [item for item in items if isinstance(item, PairItem) and item.case.name not in kept]
    if dropped:
        config.hook.pytest_deselected(items=dropped)
        items[:] = [item for item in items if item not in set(dropped)]


def _located(error: SpecError) -> str:
    return str(dataclasses.replace(error, file=shown(Path(error.file))))
