"""The main job: carry out a plan, and write what came of it as a results tree."""

from __future__ import annotations

import shutil
import signal
import threading
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from types import FrameType
from typing import Any

from equilux import ci, machine
from equilux.accuracy import NOT_YET, Climb
from equilux.adapter import Case, Limits
from equilux.caserecord import case_line, case_record
from equilux.casework import CaseWork, Provenance
from equilux.diagnosing import TIME_LIMIT_S, Method, known_rules, unusable_rules
from equilux.dialect import declared_dialect, told
from equilux.identity import render_key
from equilux.job import Outcome
from equilux.judge import FAILED, exit_code
from equilux.plan import RUN, Plan, PlannedRender
from equilux.pool import Laboratory, Pool, Request
from equilux.progress import Progress, Silent
from equilux.results import CaseRecord, Results, RunRecord, summarise
from equilux.reuse import Store
from equilux.tree import RUN_SCHEMA, Tree
from equilux.wholefile import write_json
from equilux.workerstart import shared_nursery

ENGINE_FAULT = 3
INTERRUPTED = 130


@dataclass(frozen=True)
class Options:
    """How to carry out a plan. `jobs`: cores to use. `diagnose`: say why renders diverge, each within `diagnosis_limit_s`.
    `materials`: write what every case's BRDFs are. `command`: what the user typed, for the record."""

    out: Path
    jobs: int = field(default_factory=machine.available_cores)
    limits: Limits = field(default_factory=Limits)
    reuse: bool = True
    store: Store | None = None
    fail_fast: bool = False
    flip: bool = False
    diagnose: bool = True
    diagnosis_limit_s: float = TIME_LIMIT_S
    materials: bool = True
    command: tuple[str, ...] = ()


@dataclass(frozen=True)
class Finished:
    """A run that ended. `errors`: faults of the engine itself."""

    results: Results
    exit_code: int
    errors: tuple[str, ...] = ()


def execute(plan: Plan, options: Options, progress: Progress | None = None) -> Finished:
    """Run what is planned. Raises BadUsage for a folder that cannot be used; every other fault is a status in the results."""
    progress = progress or Silent()
    if any(render.action == RUN for render in plan.renders):
        shared_nursery()  # it starts while we go on
    identity = plan.identity()
    with Tree.open(options.out, identity, keep=options.reuse) as tree:
        run = _Run(plan, options, progress, tree, identity)
        run.write_manifest(None)
        with run.stopping_on_signals():
            run.carry_out()
        return run.finish()


class _Run:
    """One run in progress."""

    def __init__(self, plan: Plan, options: Options, progress: Progress, tree: Tree, identity: Mapping[str, Any]) -> None:
        self._plan, self._options, self._progress, self._tree, self._identity = plan, options, progress, tree, identity
        self._store = options.store if options.reuse else None
        self._work = {case.name: CaseWork(case, tree, self._store, options.flip) for case in plan.cases}
        self._left = Counter(render.case.name for render in plan.renders)
        self._knobs = {name: knobs.model_dump(mode="json") for name, knobs in plan.knobs.items()}
        self._versions = {entry.name: entry.version for entry in plan.entries}
        self._keys = dict(identity["adapters"])
        self._dialects = {entry.name: declared_dialect(entry.adapter) for entry in plan.entries if entry.adapter is not None}
        self._excused: dict[str, dict[str, tuple[str, ...]]] = {case.name: {} for case in plan.cases}
        for render in plan.renders:
            self._excused[render.case.name][render.adapter] = render.excused
        self._climb = Climb.of(plan)
        self._before: dict[tuple[str, str], tuple[Provenance, Outcome, Path]] = {}
        """Renders that were not accurate enough, until a better one is there."""
        self._started = (datetime.now(UTC), time.monotonic())
        self._lock = threading.Lock()
        self._diagnosing = ThreadPoolExecutor(max(2, options.jobs), thread_name_prefix="equilux-diagnose")
        self._pool: Pool | None = None
        self._stopped_by: str | None = None
        self._complete_cases: dict[str, CaseRecord] = {}

    # --- carrying out -------------------------------------------------------------------------------------------------

    def carry_out(self) -> None:
        """Everything that needs no renderer first, then the renders, with comparison and diagnosis running beside them."""
        self._progress.begin(len(self._plan.renders), len(self._plan.cases))
        for broken in unusable_rules() if self._options.diagnose else ():
            self._progress.note(broken)
        threads = max(2, self._options.jobs)
        workers = ThreadPoolExecutor(threads, thread_name_prefix="equilux-compare")
        try:
            pending = [workers.submit(self._without_rendering, planned) for planned in self._plan.renders]
            to_render = [planned for planned, future in zip(self._plan.renders, pending, strict=True) if not future.result()]
            if to_render and self._stopped_by is None:
                self._render(self._urgent_first(to_render), workers)
        finally:
            workers.shutdown(wait=True)
            self._diagnosing.shutdown(wait=True)
            self._progress.end()

    def _urgent_first(self, planned: list[PlannedRender]) -> list[PlannedRender]:
        """Cases that are expected to diverge first: their diagnoses, the longest chains of all, then run beside the other renders
        and not after them."""
        return sorted(planned, key=lambda render: not (self._options.diagnose and render.case.expectations))

    def _without_rendering(self, planned: PlannedRender) -> bool:
        """Settle a render that need not be run: refused, kept from an earlier run, or in the store. False when it must be run."""
        try:
            return self._settled(planned, self._work[planned.case.name])
        except Exception as problem:
            self._fault(planned, problem)
            if planned.action != RUN:
                self._done(planned.case, planned.adapter, planned.action, planned.reason)
            return planned.action != RUN

    def _settled(self, planned: PlannedRender, work: CaseWork) -> bool:
        if planned.action != RUN:
            work.refuse(self._provenance(planned), planned.action, planned.reason, planned.missing_features)
            self._done(planned.case, planned.adapter, planned.action, planned.reason)
            return True
        if self._stopped_by is not None or not self._options.reuse:
            return False
        case, adapter = planned.case.name, planned.adapter
        while True:
            who, demand = self._provenance(planned), self._climb.demand(case, adapter)
            if not (self._tree.continued and work.settle_earlier(who, demand)):
                status = work.settle_from_store(who, demand)
                if status is None:
                    return False
                if status == NOT_YET:
                    self._climb.up(case, adapter)
                    continue
            self._done(planned.case, adapter, work.records[adapter]["status"], None)
            return True

    def _fault(self, render: PlannedRender | Request, problem: Exception) -> None:
        """Note a fault of the engine itself: it is told at the end, and the run cannot end well."""
        self._work[render.case.name].errors.append(f"{render.case.name}: {render.adapter}: {type(problem).__name__}: {problem}")

    def _render(self, planned: list[PlannedRender], workers: ThreadPoolExecutor) -> None:
        wanted = {render.adapter for render in planned}
        laboratories = [
            Laboratory(entry.name, entry.entry_point.value, float(entry.adapter.workers_per_core))
            for entry in self._plan.entries
            if entry.name in wanted and entry.adapter is not None
        ]
        requests = [self._request(render) for render in planned]
        with Pool(self._options.jobs, laboratories, self._tree.scratch) as pool:
            self._pool = pool
            while requests and self._stopped_by is None:
                settling: list[Future[Request | None]] = []

                def settle(request: Request, outcome: Outcome, folder: Path, into: list[Any] = settling) -> None:
                    into.append(workers.submit(self._settle, request, outcome, folder))

                pool.run(requests, settle)
                requests = [again for future in settling if (again := future.result()) is not None]

    def _request(self, render: PlannedRender | Request) -> Request:
        return Request(render.case, render.adapter, self._knobs_of(render), self._options.limits)

    def _knobs_of(self, render: PlannedRender | Request) -> Mapping[str, Any]:
        """Those of the run, or those that are tried now for the accuracy that is asked."""
        found = self._climb.knobs(render.case.name, render.adapter)
        return self._knobs.get(render.adapter, {}) if found is None else found

    def _settle(self, request: Request, outcome: Outcome, folder: Path) -> Request | None:
        """Settle a render that came back. Returns the request for a more accurate one where that is to be tried."""
        who = self._provenance(request)
        work, place = self._work[request.case.name], (request.case.name, request.adapter)
        before = self._before.pop(place, None)
        ended = "the run was stopped" if self._stopped_by is not None else None
        if before is not None and outcome.status in FAILED and self._climb.down(*place):
            ended = f"its next setting {outcome.status}: {outcome.reason or 'no reason given'}"
            shutil.rmtree(folder, ignore_errors=True)
            who, outcome, folder = before
        elif before is not None:
            shutil.rmtree(before[2], ignore_errors=True)
        try:
            demand = self._climb.demand(*place, ended)
            status = work.settle(who, outcome, folder, compare_too=self._stopped_by is None, demand=demand)
            if status == NOT_YET:
                self._before[place] = (who, outcome, folder)
                self._climb.up(*place)
                return self._request(request)
        except Exception as problem:  # a full disk, a fault of ours: reported, and never taken for a finished render
            status = "failed"
            self._fault(request, problem)
            shutil.rmtree(folder, ignore_errors=True)
        self._done(request.case, request.adapter, status, (work.records.get(request.adapter) or {}).get("reason"))
        return None

    def _provenance(self, render: PlannedRender | Request) -> Provenance:
        name, knobs = render.adapter, self._knobs_of(render)
        identity = {**self._keys[name], "knobs": dict(knobs)}
        return Provenance(name, self._versions[name], knobs, render_key(render.case, identity, name))

    def _done(self, case: Case, adapter: str, status: str, reason: str | None) -> None:
        """Count a render as done; tell the user; decide whether to go on."""
        with self._lock:
            self._left[case.name] -= 1
            complete = self._left[case.name] == 0
        self._progress.render_done(case.name, adapter, status)
        if status in (*FAILED, "invalid"):
            self._progress.note(f"{case.name}: {adapter} {status}: {reason or ''}".rstrip(": "))
        work = self._work[case.name]
        if complete and work.diverges and self._options.diagnose:
            self._diagnosing.submit(self._complete, work)  # renders that wait to be compared do not wait for it
        elif complete:
            self._complete(work)
        if self._options.fail_fast and (status in FAILED or (status == "missing" and adapter in self._plan.named)):
            self._stop(f"--fail-fast: {case.name}: {adapter} {status}")

    def _complete(self, work: CaseWork) -> None:
        """Diagnose and judge a case whose renders are all there."""
        if self._options.diagnose and self._stopped_by is None:
            work.diagnose(Method(self._dialects, self._options.diagnosis_limit_s))
            if self._stopped_by is None:
                work.explain_peers()
        judged = self._judged(work)
        with suppress(OSError):  # a full disk: `finish` tries again, and fails
            if self._options.materials:
                work.write_materials()
            self._complete_cases[work.case.name] = judged
        self._progress.case_done(case_line(work, judged))
        work.forget_pictures()
        if self._options.fail_fast and any(pair.judged in ("diverge_unexpected", "improved") for pair in judged.pairs):
            self._stop("--fail-fast: " + work.case.name)

    # --- stopping -----------------------------------------------------------------------------------------------------

    def _stop(self, why: str) -> None:
        """Start nothing more, end what runs, keep what is finished."""
        self._stopped_by = self._stopped_by or why
        if self._pool is not None:
            self._pool.stop()

    @contextmanager
    def stopping_on_signals(self) -> Iterator[None]:
        """The first SIGINT or SIGTERM stops the run cleanly; the next one is as rude as usual."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}

        def handle(number: int, _frame: FrameType | None) -> None:
            for each, handler in before.items():
                signal.signal(each, handler)
            self._stop(signal.Signals(number).name)

        for number in before:
            signal.signal(number, handle)
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    # --- results ------------------------------------------------------------------------------------------------------

    def finish(self) -> Finished:
        """Judge everything and write results.json and the final run.json."""
        worked = [work for work in self._work.values() if work.records]
        cases = [self._complete_cases.get(work.case.name) or self._judged(work) for work in worked]
        for work in worked if self._options.materials else ():
            if work.case.name not in self._complete_cases:
                work.write_materials()
        statuses = [(name, render.status) for case in cases for name, render in case.renders.items()]
        pairs = [(pair.a, pair.b, pair.judged) for case in cases for pair in case.pairs]
        errors = tuple(error for work in self._work.values() for error in work.errors)
        code = exit_code(statuses, pairs, self._plan.named)
        if errors:
            code = ENGINE_FAULT
        if self._stopped_by is not None and not self._stopped_by.startswith("--"):
            code = INTERRUPTED
        started, ended, seconds = self._clock()
        record = RunRecord(
            equilux=machine.version_of_equilux(),
            adapters=self._versions,
            command=list(self._options.command),
            started=started,
            ended=ended,
            seconds=seconds,
            interrupted=self._stopped_by,
        )
        results = Results(run=record, cases=cases, summary=summarise(cases, code))
        write_json(self._tree.root / "results.json", results.model_dump(mode="json"))
        self.write_manifest(record)
        ci.write_files(ci.RunView(results, self._tree.root, self._plan.named, ci.sources_of(self._plan.cases), errors))
        return Finished(results, code, errors)

    def _judged(self, work: CaseWork) -> CaseRecord:
        return case_record(work, self._excused[work.case.name], known_rules() if self._options.diagnose else ())

    def _clock(self) -> tuple[str, str, float]:
        began, began_monotonic = self._started
        return (
            began.isoformat(timespec="seconds"),
            datetime.now(UTC).isoformat(timespec="seconds"),
            time.monotonic() - began_monotonic,
        )

    def write_manifest(self, finished: RunRecord | None) -> None:
        """run.json: written before the first render, so that an interrupted tree is known for what it is, and once more at the
        end."""
        options = self._options
        rules = known_rules() if options.diagnose else {}
        adapters = {
            entry.name: {
                "title": getattr(entry.adapter, "title", entry.name),
                "version": entry.version,
                "distribution": f"{entry.distribution} {entry.distribution_version}",
                "found": entry.probe.found,
                "detail": entry.probe.detail,
                "error": entry.error,
                "knobs": self._knobs.get(entry.name, {}),
                "named": entry.name in self._plan.named,
                "added": entry.name in self._plan.added,
                "dialect": told(self._dialects.get(entry.name, ()), rules),
            }
            for entry in self._plan.entries
        }
        clock = {
            "started": self._clock()[0],
            "ended": finished.ended if finished else None,
            "seconds": finished.seconds if finished else None,
        }
        write_json(
            self._tree.root / "run.json",
            {
                "schema": RUN_SCHEMA,
                "equilux": machine.version_of_equilux(),
                "command": list(options.command),
                "clock": clock,
                "interrupted": finished.interrupted if finished else None,
                "adapters": adapters,
                "libraries": machine.library_versions(),
                "machine": machine.describe_machine(),
                "options": {
                    "jobs": options.jobs,
                    "timeout_s": options.limits.timeout_s,
                    "memory_bytes": options.limits.memory_bytes,
                    "reuse": options.reuse,
                    "fail_fast": options.fail_fast,
                    "flip": options.flip,
                    "diagnose": options.diagnose,
                    "diagnosis_limit_s": options.diagnosis_limit_s,
                    "accuracy": self._plan.ladders.error if self._plan.ladders is not None else None,
                },
                "identity": self._identity,
            },
        )
