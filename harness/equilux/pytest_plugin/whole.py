"""The results tree of a session: held by one process, filled by all, and in the end like that of `equilux run`."""

from __future__ import annotations

import io
import shlex
import shutil
import time
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from equilux import ci, machine
from equilux.ci.view import shown
from equilux.judge import exit_code
from equilux.pytest_plugin.parts import Part, read_parts
from equilux.results import Results, RunRecord, summarise
from equilux.run import ENGINE_FAULT
from equilux.tree import RUN_SCHEMA, Tree
from equilux.wholefile import write_json


@dataclass
class WholeTree:
    """Open from before the first item until after the last. `close` puts the parts together; without any there are no results."""

    tree: Tree
    parts: Path
    command: tuple[str, ...]
    began: tuple[datetime, float]
    _said: list[str] = field(default_factory=list)

    @classmethod
    def open(cls, out: Path, parts: Path, command: tuple[str, ...]) -> WholeTree:
        """Raises BadUsage for a folder that cannot be used."""
        whole = cls(Tree.open(out, {}, keep=False), parts, command, (datetime.now(UTC), time.monotonic()))
        write_json(whole.tree.root / "run.json", whole._manifest([], None))  # an interrupted tree is known for what it is
        return whole

    def close(self) -> None:
        """Write what `equilux run` writes: results.json, run.json, junit.xml, summary.md."""
        parts = read_parts(self.parts)
        if parts:
            results, view = self._together(parts)
            write_json(self.tree.root / "results.json", results.model_dump(mode="json"))
            write_json(self.tree.root / "run.json", self._manifest(parts, results.run))
            ci.write_files(view)
            said = io.StringIO()
            ci.announce(view, stream=said)
            tree = shlex.quote(shown(self.tree.root))
            self._said = [*said.getvalue().splitlines(), f"equilux: results in {tree}; pictures: equilux report {tree}"]
        shutil.rmtree(self.parts.parent, ignore_errors=True)
        self.tree.close()

    def last_words(self) -> list[str]:
        """For the end of the session: where the results are, and what GitHub is to read."""
        return self._said

    def _together(self, parts: list[Part]) -> tuple[Results, ci.RunView]:
        places = {scene: place for part in parts for scene, place in part.places.items()}
        cases = sorted((case for part in parts for case in part.results.cases), key=lambda case: places[case.scene])
        errors = tuple(error for part in parts for error in part.errors)
        named = frozenset(
            name for part in parts for name, entry in part.manifest.get("adapters", {}).items() if entry.get("named")
        )
        statuses = [(name, render.status) for case in cases for name, render in case.renders.items()]
        pairs = [(pair.a, pair.b, pair.judged) for case in cases for pair in case.pairs]
        code = ENGINE_FAULT if errors else exit_code(statuses, pairs, named)
        started, began = self.began
        record = RunRecord(
            equilux=machine.version_of_equilux(),
            adapters={name: version for part in parts for name, version in part.results.run.adapters.items()},
            command=list(self.command),
            started=started.isoformat(timespec="seconds"),
            ended=datetime.now(UTC).isoformat(timespec="seconds"),
            seconds=time.monotonic() - began,
        )
        results = Results(run=record, cases=cases, summary=summarise(cases, code))
        sources = {scene: path for part in parts for scene, path in part.sources.items()}
        return results, ci.RunView(results, self.tree.root, named, sources, errors)

    def _manifest(self, parts: list[Part], record: RunRecord | None) -> dict[str, Any]:
        """run.json: the first part's, for what all have in common, with the cases and adapters of all."""
        merged: dict[str, Any] = dict(parts[0].manifest) if parts else {"schema": RUN_SCHEMA}
        identity: dict[str, dict[str, Any]] = {"cases": {}, "adapters": {}}
        adapters: dict[str, Any] = {}
        for part in parts:
            adapters |= part.manifest.get("adapters", {})
            for kind, entries in identity.items():
                entries |= part.manifest.get("identity", {}).get(kind, {})
        started = self.began[0].isoformat(timespec="seconds")
        return merged | {
            "equilux": machine.version_of_equilux(),
            "command": list(self.command),
            "clock": {
                "started": started,
                "ended": record.ended if record else None,
                "seconds": record.seconds if record else None,
            },
            "interrupted": None,
            "adapters": adapters,
            "identity": identity,
        }
