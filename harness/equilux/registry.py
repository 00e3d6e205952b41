"""Finding adapters: the entry-point group `equilux.adapters`, loaded lazily, every failure kept as data.

An adapter that cannot be used is not hidden: its entry carries the reason, `equilux adapters list` shows it, and a run that uses
it records `failed`. Only two distributions claiming one name stops everything, because then a name means nothing.
"""

from __future__ import annotations

import importlib.metadata
import re
import traceback
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from equilux.adapter import API_VERSION, Adapter, Capability, Knobs, Probe
from equilux.complaint import BadUsage, nearest
from equilux.dialect import complaints_about

GROUP = "equilux.adapters"
NAME_PATTERN = re.compile(r"[a-z0-9]+(?:[-_.]?[a-z0-9]+)*")
"""Names become folders and halves of `a--b`, so two hyphens in a row cannot be part of one."""
RESERVED = ("pairs",)
"""Names that mean something else in a case's folder."""

METHODS = ("version", "probe", "capabilities", "translate", "render", "read")
ATTRIBUTES = ("name", "api_version", "Knobs", "workers_per_core", "lack_causes")


@dataclass(frozen=True)
class Loaded:
    """An adapter that was loaded and conforms, or the reason why there is none."""

    adapter: Adapter | None
    error: str | None


@dataclass
class Entry:
    """One registered adapter. Nothing of it is imported before `adapter` or `error` is looked at."""

    name: str
    distribution: str
    distribution_version: str
    entry_point: importlib.metadata.EntryPoint = field(repr=False)

    @cached_property
    def _loaded(self) -> Loaded:
        return load(self.entry_point)

    @property
    def adapter(self) -> Adapter | None:
        return self._loaded.adapter

    @property
    def error(self) -> str | None:
        """Why the adapter cannot be used; None when it can."""
        return self._loaded.error

    @cached_property
    def version(self) -> str:
        """The renderer's version, "unknown" (with the reason) when asking for it raises."""
        if self.adapter is None:
            return "unknown"
        try:
            return str(self.adapter.version())
        except Exception as problem:
            return f"unknown ({last_line(problem)})"

    @cached_property
    def probe(self) -> Probe:
        """Whether the renderer is installed. An adapter whose probe raises against the protocol is reported as not found."""
        if self.adapter is None:
            return Probe(False, self.error or "not loaded")
        try:
            found = self.adapter.probe()
        except Exception as problem:
            return Probe(False, f"probe() raised {last_line(problem)}")
        if not isinstance(found, Probe):
            return Probe(False, f"probe() returned {type(found).__name__}, expected Probe")
        return found

    @cached_property
    def capabilities(self) -> dict[str, Capability]:
        """Feature → capability. Empty when the adapter is not usable. Raises what the adapter raises."""
        return dict(self.adapter.capabilities()) if self.adapter is not None else {}


def last_line(problem: BaseException) -> str:
    """An exception in one line, as the last line of its traceback has it."""
    return " ".join(traceback.format_exception_only(problem)[-1].split())


def load(entry_point: importlib.metadata.EntryPoint) -> Loaded:
    """Import the entry point and check that what it names is an adapter of this protocol version. Never raises on its account."""
    try:
        candidate = entry_point.load()
    except Exception as problem:
        return Loaded(None, f"{entry_point.value} cannot be loaded: {last_line(problem)}")
    except SystemExit as problem:
        return Loaded(None, f"{entry_point.value} cannot be loaded: it called sys.exit({problem.code!r})")
    wrong = complaints(candidate, entry_point.name)
    if wrong:
        return Loaded(None, f"{entry_point.value} is not an adapter: {'; '.join(wrong)}")
    return Loaded(candidate, None)


def complaints(candidate: object, name: str) -> list[str]:
    """Everything by which an object departs from the adapter protocol, in words; empty when it conforms."""
    if isinstance(candidate, type):
        return [f"it is the class {candidate.__name__}; register an instance of it"]
    missing = [attribute for attribute in (*ATTRIBUTES, *METHODS) if not hasattr(candidate, attribute)]
    wrong = [f"missing {', '.join(missing)}"] if missing else []
    if "api_version" not in missing and (got := getattr(candidate, "api_version")) != API_VERSION:  # noqa: B009
        wrong.append(f"api_version is {got!r}, this equilux speaks {API_VERSION}")
    if "name" not in missing and (got := getattr(candidate, "name")) != name:  # noqa: B009
        wrong.append(f"its name is {got!r}, it is registered as {name!r}")
    wrong += [
        f"{method} is not callable" for method in METHODS if method not in missing and not callable(getattr(candidate, method))
    ]
    if name in RESERVED:
        wrong.append(f"the name '{name}' is taken by the results tree")
    if NAME_PATTERN.fullmatch(name) is None:
        wrong.append(f"the name {name!r} is not made of lower-case letters and digits joined by single '-', '_' or '.'")
    if "Knobs" not in missing and not _is_knobs_model(getattr(candidate, "Knobs")):  # noqa: B009
        wrong.append("Knobs is not a subclass of equilux.adapter.Knobs")
    if "workers_per_core" not in missing:
        share = getattr(candidate, "workers_per_core")  # noqa: B009
        if not isinstance(share, int | float) or not 0 < share < 1000:
            wrong.append(f"workers_per_core is {share!r}, expected a number above 0 and below 1000")
    return wrong + complaints_about(getattr(candidate, "dialect", ()))


def _is_knobs_model(candidate: object) -> bool:
    return isinstance(candidate, type) and issubclass(candidate, Knobs)


class Registry:
    """All adapters registered in this environment, by name."""

    def __init__(self, entries: Iterable[Entry]) -> None:
        self.entries: dict[str, Entry] = {}
        for entry in sorted(entries, key=lambda entry: entry.name):
            if (other := self.entries.get(entry.name)) is not None:
                raise BadUsage(
                    f"two distributions register the adapter '{entry.name}': {other.distribution} "
                    f"({other.entry_point.value}) and {entry.distribution} ({entry.entry_point.value}); uninstall one of them"
                )
            self.entries[entry.name] = entry

    @classmethod
    def discover(cls) -> Registry:
        """Read the entry points of every distribution on the path. Raises BadUsage for a name claimed twice."""
        return cls(_installed_entries())

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.entries)

    def select(self, names: Sequence[str], option: str = "--adapters") -> list[Entry]:
        """The entries of these names, in this order. Raises BadUsage naming what is unknown, what is known and the nearest."""
        unknown = [name for name in names if name not in self.entries]
        if unknown:
            raise BadUsage(
                f"{option}: unknown adapter '{unknown[0]}'; installed are {', '.join(self.names) or 'none'}"
                f"{nearest(unknown[0], self.names)}"
            )
        return [self.entries[name] for name in dict.fromkeys(names)]


def _installed_entries() -> list[Entry]:
    """One entry per (name, distribution): a distribution found twice on the path (a checkout and its install) counts once."""
    found: dict[tuple[str, str, str], Entry] = {}
    for point in importlib.metadata.entry_points(group=GROUP):
        distribution = point.dist.name if point.dist is not None else "an unnamed distribution"
        version = point.dist.version if point.dist is not None else ""
        found.setdefault((point.name, distribution, point.value), Entry(point.name, distribution, version, point))
    return list(found.values())
