"""One process's part of a pytest session: what is planned, carried out once for each scene, and kept for the others."""

from __future__ import annotations

import fcntl
import shutil
from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from equilux.adapter import Case, Limits
from equilux.ci import RunView
from equilux.ci.view import shown
from equilux.complaint import BadUsage
from equilux.knobs import resolve
from equilux.plan import RUN, Plan, Selection, make_plan, select_adapters
from equilux.pytest_plugin.parts import Part, file_name, is_left, read_part, write_part
from equilux.pytest_plugin.settings import Settings, above_zero, at_least_one
from equilux.registry import Registry
from equilux.tree import SCRATCH_PREFIX, check_usable
from equilux.trust import TRUTHS, ordered_pair, truth_among
from equilux_scenes.limits import Limits as SpecLimits
from equilux_scenes.loader import SceneFile

if TYPE_CHECKING:
    from equilux.pytest_plugin.whole import WholeTree
    from equilux.run import Options

Pair = tuple[str, str]

MOST_AT_ONCE = 16
"""Scenes that are rendered in one go: how many a failure may have to wait for."""


@dataclass(frozen=True)
class Bench:
    """What every scene of the session is judged with: adapters, knobs, limits. Raises BadUsage where it cannot be had."""

    selection: Selection
    knobs: dict[str, object]
    spec_limits: SpecLimits


@dataclass
class Conductor:
    """Plans scenes as they are collected and renders each once, when the first of its items is run or with one before it.

    Items of one scene may run in several processes: whoever comes first renders, the others wait and read what it left in the
    results tree (`parts`). Only what the chosen items need is rendered. A renderer's start costs more than many a scene, so
    scenes are taken together: one at first, to have something to tell, then twice as many each time, up to MOST_AT_ONCE.
    """

    settings: Settings
    names: dict[str, SceneFile] = field(default_factory=dict)
    """Scenes by name: a name means one scene in a run."""
    _chosen: dict[str, dict[str, tuple[Case, set[str]]]] = field(default_factory=dict)
    _done: dict[str, Part] = field(default_factory=dict)
    _at_once: int = 1
    _whole: WholeTree | None = None

    # --- planning -----------------------------------------------------------------------------------------------------

    @cached_property
    def _bench(self) -> Bench | BadUsage:
        """Adapters and knobs, the same for all scenes; or why there are none."""
        try:
            names = _names(self.settings.adapters)
            selection = select_adapters(Registry.discover(), names)
            check_usable(Path(shown(self.settings.out)))
            self._options(Path())
            try:
                limits = SpecLimits.from_options(self.settings.limits)
            except ValueError as problem:
                raise BadUsage(str(problem)) from problem
            return Bench(selection, dict(resolve(self.settings.knobs, selection.entries)), limits)
        except BadUsage as problem:
            return BadUsage(*(line.replace("--", "--equilux-", 1) if line.startswith("--") else line for line in problem.lines))

    @property
    def bench(self) -> Bench:
        """Raises BadUsage."""
        if isinstance(self._bench, BadUsage):
            raise self._bench
        return self._bench

    @property
    def usable(self) -> bool:
        """Whether the session was asked for what can be done; asked before a complaint, so that it is made once."""
        return not isinstance(self.__dict__.get("_bench"), BadUsage)

    def pairs(self, case: Case) -> list[Pair | tuple[str]]:
        """The pairs that `equilux run` would compare, in its order. An adapter that is not going to render stands in one pair
        with the truth of the case, so that it is told once."""
        renders = self._plan([case]).renders
        running = [render.adapter for render in renders if render.action == RUN]
        truth = truth_among(running)
        found: list[Pair | tuple[str]] = [
            ordered_pair(one, other) for index, one in enumerate(running) for other in running[index + 1 :]
        ]
        for render in renders:
            if render.action != RUN:
                found.append((render.adapter,) if truth is None else (render.adapter, truth))
        return sorted(found)

    def _plan(self, cases: Iterable[Case], adapters: set[str] | None = None) -> Plan:
        bench = self.bench
        entries = tuple(
            entry for entry in bench.selection.entries if adapters is None or entry.name in adapters or entry.name in TRUTHS
        )
        selection = Selection(entries, bench.selection.named, bench.selection.added)
        return make_plan(list(cases), selection, bench.knobs, as_is=self.settings.as_is)  # type: ignore[arg-type]

    def choose(self, items: Iterable[tuple[Case, tuple[str, ...]]]) -> None:
        """Tell which items will be run: what they do not need is not rendered."""
        self._chosen.clear()
        for case, pair in items:
            cases = self._chosen.setdefault(case.scene_name, {})
            cases.setdefault(case.name, (case, set()))[1].update(pair)

    # --- carrying out -------------------------------------------------------------------------------------------------

    def part(self, case: Case) -> Part:
        """What became of the case's scene: from this process, from another one, or rendered now. Raises BadUsage, and what an
        interrupt raises."""
        scene = case.scene_name
        if scene not in self._done:
            with ExitStack() as held:
                self._hold(scene, held)
                found = read_part(self._parts, scene)
                part = found if found is not None else self._carry_out([scene, *self._to_come(scene, held)])
            self._done |= dict.fromkeys(part.places, part)
        return self._done[scene]

    def _to_come(self, scene: str, held: ExitStack) -> list[str]:
        """Scenes after this one that nobody has begun, to be rendered along with it, for the same adapters; they are held."""
        wanted, self._at_once = self._at_once - 1, min(2 * self._at_once, MOST_AT_ONCE)
        names, adapters = list(self._chosen), self._adapters_of(scene)
        found: list[str] = []
        for other in names[names.index(scene) + 1 :]:
            if len(found) == wanted:
                break
            if is_left(self._parts, other) or self._adapters_of(other) != adapters:
                continue
            if self._hold(other, held, wait=False) and not is_left(self._parts, other):  # it may have been left just now
                found.append(other)
        return found

    def _adapters_of(self, scene: str) -> set[str]:
        return set[str]().union(*(adapters for _, adapters in self._chosen[scene].values()))

    def view(self, part: Part, case: Case) -> RunView:
        sources = {case.scene_name: case.source} if case.source is not None else {}
        return RunView(part.results, self.settings.out, self.bench.selection.named, sources, part.errors)

    def _carry_out(self, scenes: Sequence[str]) -> Part:
        """Run the engine on the scenes' cases in a tree of their own, and move what it made to the session's tree."""
        from equilux.run import INTERRUPTED, execute

        chosen = [case for scene in scenes for case, _ in self._chosen[scene].values()]
        plan = self._plan(chosen, self._adapters_of(scenes[0]))
        own = self._scratch / "work" / file_name(scenes[0])
        options = self._options(own)
        finished = execute(plan, options)
        if finished.exit_code == INTERRUPTED:
            raise KeyboardInterrupt
        for case in finished.results.cases:
            target = self.settings.out / "cases" / case.case
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.rmtree(target, ignore_errors=True)
            (own / "cases" / case.case).rename(target)
        names = list(self._chosen)
        part = Part.of(finished, own, {scene: names.index(scene) for scene in scenes}, plan.cases)
        write_part(self._parts, part)
        shutil.rmtree(own, ignore_errors=True)
        if options.store is not None and options.store.written:
            options.store.prune()
        return part

    def _options(self, out: Path) -> Options:
        """Raises BadUsage for numbers that are none."""
        from equilux import machine
        from equilux.reuse import Store, default_root
        from equilux.run import Options

        given = self.settings
        jobs = max(1, machine.available_cores() // given.processes)
        memory = above_zero("--memory", given.memory, "MiB") * 2**20 if given.memory else machine.usable_memory()
        options = Options(
            out=out,
            jobs=at_least_one("--jobs", given.jobs) if given.jobs else jobs,
            limits=Limits(above_zero("--timeout", given.timeout, "seconds"), int(memory)),
            reuse=given.reuse,
            store=Store(default_root()) if given.reuse else None,
            diagnose=given.diagnose,
            command=("pytest",),
        )
        if given.diagnosis_timeout is None:
            return options
        from dataclasses import replace

        return replace(options, diagnosis_limit_s=above_zero("--diagnosis-timeout", given.diagnosis_timeout, "seconds"))

    # --- what processes share -----------------------------------------------------------------------------------------

    @property
    def _scratch(self) -> Path:
        """Beside the results, and no part of them: the tree removes it when it is next opened."""
        return self.settings.out / f"{SCRATCH_PREFIX}{self.settings.token}"

    @property
    def _parts(self) -> Path:
        return self._scratch / "parts"

    def _hold(self, scene: str, held: ExitStack, *, wait: bool = True) -> bool:
        """Be the only process of the session at this scene, until `held` is closed. False where another one is and wait is not
        wanted."""
        self._parts.mkdir(parents=True, exist_ok=True)
        lock = held.enter_context((self._parts / f"{file_name(scene)}.lock").open("w"))
        try:
            fcntl.flock(lock, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def open_tree(self, command: tuple[str, ...]) -> None:
        """Take the session's results tree, in the one process that speaks for all. Raises BadUsage."""
        from equilux.pytest_plugin.whole import WholeTree

        if self._whole is None:
            self._whole = WholeTree.open(self.settings.out, self._parts, command)

    def finish(self) -> None:
        """Put the parts together, in the process that opened the tree."""
        if self._whole is not None:
            self._whole.close()

    def last_words(self) -> list[str]:
        return self._whole.last_words() if self._whole is not None else []


def _names(text: str | None) -> list[str] | None:
    """As `--adapters` of `equilux run`."""
    from equilux.cli.inputs import split_names

    return split_names("--adapters", text)
