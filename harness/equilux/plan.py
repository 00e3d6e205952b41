"""What a run will do, decided before anything is rendered: which adapter renders which case, and why the others do not."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from equilux.adapter import Capability, Case, Knobs
from equilux.complaint import BadUsage
from equilux.registry import Entry, Registry, last_line
from equilux.trust import TRUTHS

if TYPE_CHECKING:
    from equilux.accuracy import Ladders

RUN = "run"


@dataclass(frozen=True)
class PlannedRender:
    """One case for one adapter. `action` is "run", or the status it gets without being run.

    excused: the expected causes that stand for features that the adapter lacks: what lets it render the case at all.
    """

    case: Case
    adapter: str
    action: str
    reason: str | None = None
    missing_features: tuple[str, ...] = ()
    excused: tuple[str, ...] = ()


@dataclass(frozen=True)
class Plan:
    """All renders in the order of the cases, and what they depend on."""

    cases: tuple[Case, ...]
    entries: tuple[Entry, ...]
    renders: tuple[PlannedRender, ...]
    knobs: Mapping[str, Knobs]
    named: frozenset[str] = frozenset()
    """Adapters that the user asked for by name: missing ones are a failure."""
    added: tuple[str, ...] = ()
    """Truths that were added because they were not named."""
    ladders: Ladders | None = None
    """The accuracy that is asked for, and what is tried for it."""

    def identity(self) -> dict[str, object]:
        """What must agree for an existing results tree to be continued: scenes, adapters, versions, knobs."""
        from equilux.identity import adapter_identity, case_digest

        identity: dict[str, object] = {
            "cases": {case.name: case_digest(case) for case in self.cases},
            "adapters": {entry.name: adapter_identity(entry, self.knobs.get(entry.name)) for entry in self.entries},
        }
        return identity | ({"accuracy": self.ladders.identity()} if self.ladders is not None else {})


@dataclass(frozen=True)
class Selection:
    """Which adapters take part: those named and the truths, or, when none are named, all."""

    entries: tuple[Entry, ...]
    named: frozenset[str] = frozenset()
    added: tuple[str, ...] = field(default=())


def select_adapters(registry: Registry, names: Sequence[str] | None) -> Selection:
    """Raises BadUsage for unknown names, and when no adapter is installed at all."""
    if names is None:
        if not registry.entries:
            raise BadUsage("no adapter is installed: no distribution registers the entry-point group 'equilux.adapters'")
        return Selection(tuple(registry.entries.values()))
    if not names:
        raise BadUsage(f"--adapters: got no name, expected a list such as --adapters {','.join(registry.names) or 'NAME'}")
    entries = registry.select(names)
    added = tuple(name for name in TRUTHS if name not in names and name in registry.entries)
    return Selection((*entries, *(registry.entries[name] for name in added)), frozenset(names), added)


def filter_cases(cases: Iterable[Case], pattern: str | None) -> tuple[Case, ...]:
    """The cases whose name matches (`matching_names`); all of them without a pattern."""
    cases = tuple(cases)
    if pattern is None or not cases:
        return cases
    matching = set(matching_names([case.name for case in cases], pattern))
    return tuple(case for case in cases if case.name in matching)


def matching_names(names: Sequence[str], pattern: str) -> list[str]:
    """The names that match; `*` and `?` are wild and everything else is literal, brackets too. Raises BadUsage when none does."""
    expression = re.compile("".join({"*": ".*", "?": "."}.get(letter, re.escape(letter)) for letter in pattern), re.DOTALL)
    matching = [name for name in names if expression.fullmatch(name)]
    if not matching:
        shown = ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
        raise BadUsage(
            f"--case-filter: '{pattern}' matches none of the {len(names)} cases ({shown}); '*' and '?' are wild, "
            "the whole name must match"
        )
    return matching


def make_plan(cases: Sequence[Case], selection: Selection, knobs: Mapping[str, Knobs], *, as_is: bool = False) -> Plan:
    """Decide for every case and adapter. Probes each adapter once."""
    capabilities: dict[str, Mapping[str, Capability] | str] = {entry.name: _capabilities(entry) for entry in selection.entries}
    renders = tuple(
        _planned(case, entry, capabilities[entry.name], as_is=as_is, named=entry.name in selection.named)
        for case in cases
        for entry in selection.entries
    )
    return Plan(tuple(cases), selection.entries, renders, knobs, selection.named, selection.added)


def _capabilities(entry: Entry) -> Mapping[str, Capability] | str:
    """What the adapter can do, or why it does not say."""
    try:
        return entry.capabilities
    except Exception as problem:
        return f"capabilities() raised {last_line(problem)}"


def _planned(
    case: Case, entry: Entry, capabilities: Mapping[str, Capability] | str, *, as_is: bool, named: bool
) -> PlannedRender:
    if entry.adapter is None:
        return PlannedRender(case, entry.name, "failed", entry.error)
    if isinstance(capabilities, str):
        return PlannedRender(case, entry.name, "failed", capabilities)
    if not entry.probe.found:
        return PlannedRender(case, entry.name, "missing", entry.probe.detail)
    lacking = [feature for feature in case.demands if feature not in capabilities or capabilities[feature].level == "none"]
    unexcused = [feature for feature in lacking if not _excused(feature, entry, case, as_is=as_is)]
    if unexcused:
        models = [feature for feature in unexcused if feature.startswith("model.")]
        notes = [
            f"{feature} ({capabilities[feature].note})" if feature in capabilities and capabilities[feature].note else feature
            for feature in models or unexcused  # whoever does not do the model does nothing of the scene
        ]
        return PlannedRender(case, entry.name, "unsupported", f"cannot express {', '.join(notes)}", tuple(unexcused))
    stand_ins = dict.fromkeys(cause for feature in lacking if (cause := _stands_for(feature, entry, case)) is not None)
    return PlannedRender(case, entry.name, RUN, excused=tuple(stand_ins))


def _excused(feature: str, entry: Entry, case: Case, *, as_is: bool) -> bool:
    """Whether a case is rendered although the adapter lacks a feature: its absence is expected by name, or wanted as it is.

    Never a truth: what the oracle lacks it would silently leave out, and everybody would be judged against that.
    """
    if entry.name in TRUTHS or entry.adapter is None:
        return False
    return as_is or _stands_for(feature, entry, case) is not None


def _stands_for(feature: str, entry: Entry, case: Case) -> str | None:
    """The cause that a lacking feature shows as, where the scene expects it."""
    stands_for = entry.adapter.lack_causes.get(feature) if entry.adapter is not None else None
    expected = {expectation.cause for expectation in case.expectations if expectation.adapter == entry.name}
    return stands_for if stands_for in expected else None
