"""What run.json says, arranged for reading: when, how, on what machine, with which versions."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from equilux_report import numerals
from equilux_report.facts import Facts, items, mapping, number, text
from equilux_report.tree import Run

SHOWN_APART = ("schema", "equilux", "command", "clock", "interrupted", "adapters", "libraries", "machine", "options", "identity")


@dataclass(frozen=True)
class AdapterFacts:
    """One renderer of the run."""

    name: str
    version: str
    detail: str
    knobs: str


@dataclass(frozen=True)
class RunFacts:
    """A manifest, arranged."""

    started: str
    ended: str
    seconds: float | None
    command: str
    interrupted: str
    equilux: str
    adapters: tuple[AdapterFacts, ...]
    libraries: Facts
    machine: Facts
    options: Facts
    others: Facts
    """What this report does not know of, shown as it is."""

    @property
    def when(self) -> str:
        """Start of the run to the minute: the zone is kept."""
        date, _, clock = self.started.partition("T")
        zone = "" if "+00:00" not in clock and not clock.endswith("Z") else " UTC"
        return f"{date} {clock[:5]}{zone}" if clock else self.started


def run_facts(run: Run) -> RunFacts:
    """Arrange the manifest of a run."""
    manifest = run.manifest
    clock = mapping(manifest, "clock")
    return RunFacts(
        started=text(clock, "started"),
        ended=text(clock, "ended"),
        seconds=number(clock, "seconds"),
        command=shlex.join(str(word) for word in items(manifest, "command")),
        interrupted=_words(manifest.get("interrupted")),
        equilux=text(manifest, "equilux"),
        adapters=tuple(_adapter(name, mapping(mapping(manifest, "adapters"), name)) for name in mapping(manifest, "adapters")),
        libraries=mapping(manifest, "libraries"),
        machine=_readable(mapping(manifest, "machine")),
        options=_readable(mapping(manifest, "options")),
        others={key: value for key, value in manifest.items() if key not in SHOWN_APART},
    )


def _adapter(name: str, facts: Facts) -> AdapterFacts:
    knobs = ", ".join(f"{knob} = {_words(value)}" for knob, value in mapping(facts, "knobs").items())
    return AdapterFacts(name, text(facts, "version"), text(facts, "error") or text(facts, "detail"), knobs)


def _readable(facts: Facts) -> Mapping[str, Any]:
    """Bytes as GB, and units out of the names' tails."""
    return {
        key.removesuffix("_bytes"): numerals.size(int(value)) if key.endswith("_bytes") and isinstance(value, int) else value
        for key, value in facts.items()
    }


def _words(value: object) -> str:
    return "" if value is None or value is False else "yes" if value is True else str(value)
