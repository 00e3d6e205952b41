"""Reads a results tree into records. Nothing here needs more than the tree, and what is missing is said, not fatal.

A run that was interrupted has folders but perhaps no `results.json`: then the cases are those found on disk.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from equilux_report.facts import Facts, items, mapping, objects, text

TRUTHS = ("oracle", "reference")
"""Against whom a case is judged, most trusted first (contracts §3)."""

HAS_PIXELS = ("ok", "invalid")
"""Statuses of renders that come with an image."""


@dataclass(frozen=True)
class Problem:
    """Something that the tree should hold and does not, or that cannot be read."""

    where: str
    what: str


@dataclass(frozen=True)
class Render:
    """What one adapter made of one case. `facts`: render.json over what results.json says of it."""

    case: str
    adapter: str
    folder: Path
    facts: Facts

    @property
    def status(self) -> str:
        return text(self.facts, "status") or "incomplete"

    @cached_property
    def image(self) -> Path | None:
        """The float32 picture, if there is one."""
        path = self.folder / "image.exr"
        return path if path.is_file() else None


@dataclass(frozen=True)
class Pair:
    """Two renders of one case, compared. `facts`: the pair's own JSON over what results.json says of it."""

    case: str
    a: str
    b: str
    planes: Path | None
    facts: Facts
    first_invalid: tuple[int, int] | None = None
    """Column and row of the first invalid pixel, known once the planes have been read."""

    @property
    def verdict(self) -> str:
        return text(self.facts, "verdict") or "not-comparable"

    @property
    def judged(self) -> str:
        """agree, diverge_expected, diverge_unexpected, improved or not_comparable."""
        told = text(self.facts, "judged")
        if told:
            return told
        if self.verdict == "diverge":
            return "diverge_expected" if self.facts.get("expected") is True else "diverge_unexpected"
        return "agree" if self.verdict == "agree" else "not_comparable"

    @property
    def name(self) -> str:
        return f"{self.a}--{self.b}"


@dataclass(frozen=True)
class CaseRecord:
    """One case with its renders (by adapter, alphabetical) and its pairs."""

    name: str
    facts: Facts
    renders: Mapping[str, Render]
    pairs: tuple[Pair, ...]
    materials: Facts = field(default_factory=dict)
    """What materials.json says; empty where there is none."""

    @property
    def scene(self) -> str:
        return text(self.facts, "scene") or self.name.partition("[")[0]

    @property
    def family(self) -> str:
        """The folder that the scene's file lies in: scenes are filed by what they test."""
        return Path(text(self.facts, "scene_file")).parent.name

    @property
    def truth(self) -> str | None:
        """The render that the others are judged against, if the case has one."""
        return next((name for name in TRUTHS if name in self.renders and self.renders[name].status in HAS_PIXELS), None)

    def pair(self, a: str, b: str) -> Pair | None:
        """The pair of two adapters, in either order."""
        return next((pair for pair in self.pairs if {pair.a, pair.b} == {a, b}), None)

    def against_truth(self, adapter: str) -> Pair | None:
        """The adapter's pair with the truth."""
        return None if self.truth is None else self.pair(adapter, self.truth)


@dataclass(frozen=True)
class Run:
    """A whole results tree."""

    root: Path
    manifest: Facts
    results: Facts
    cases: tuple[CaseRecord, ...]
    problems: tuple[Problem, ...]

    @property
    def adapters(self) -> list[str]:
        """Every adapter of the run: the truths last, the others in alphabetical order."""
        names = {adapter for case in self.cases for adapter in case.renders}
        return sorted(names - set(TRUTHS)) + [name for name in reversed(TRUTHS) if name in names]


@dataclass
class _Reader:
    root: Path
    problems: list[Problem] = field(default_factory=list)

    def json(self, path: Path, *, required: bool) -> dict[str, Any]:
        where = str(path.relative_to(self.root))
        try:
            value = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            if required:
                self.problems.append(Problem(where, "is missing"))
            return {}
        except (OSError, ValueError) as error:
            self.problems.append(Problem(where, f"cannot be read: {error}"))
            return {}
        if not isinstance(value, dict):
            self.problems.append(Problem(where, "does not hold a JSON object"))
            return {}
        return value

    def case(self, name: str, facts: Facts) -> CaseRecord:
        folder = self.root / "cases" / name
        told = mapping(facts, "renders")
        on_disk = {path.parent.name for path in folder.glob("*/render.json")}
        renders = {}
        for adapter in sorted({key for key in told if _is_safe(key)} | on_disk):
            path = folder / adapter / "render.json"
            renders[adapter] = Render(
                name, adapter, folder / adapter, {**mapping(told, adapter), **self.json(path, required=True)}
            )
            if renders[adapter].status in HAS_PIXELS and renders[adapter].image is None:
                self.problems.append(Problem(f"cases/{name}/{adapter}/image.exr", "is missing"))
        materials = self.json(folder / "materials.json", required=False)
        return CaseRecord(name, facts, renders, tuple(self.pairs(name, folder / "pairs", facts)), materials)

    def pairs(self, case: str, folder: Path, facts: Facts) -> list[Pair]:
        told = {(text(item, "a"), text(item, "b")): item for item in objects(facts, "pairs")}
        on_disk = {tuple(path.stem.split("--", 1)) for path in sorted(folder.glob("*--*.json"))}
        pairs = []
        for a, b in [*told, *sorted(on_disk - set(told))]:
            if not (_is_safe(a) and _is_safe(b)):
                self.problems.append(Problem(f"cases/{case}", f"a pair without the names of its sides: {a!r}, {b!r}"))
                continue
            planes = folder / f"{a}--{b}.exr"
            own = self.json(folder / f"{a}--{b}.json", required=True)
            # Judgement is made afresh for every run, statistics are reused: results.json has the last word where it speaks.
            merged = {**own, **told.get((a, b), {})}
            if (a, b) not in told and b in TRUTHS:  # the run was interrupted before it wrote its results
                diagnosis = self.json(folder.parent / a / "diagnosis.json", required=False)
                merged |= {key: diagnosis[key] for key in ("explained", "causes") if key in diagnosis}
            pairs.append(Pair(case, a, b, planes if planes.is_file() else None, merged))
        return pairs


def _is_safe(name: object) -> bool:
    """Whether a name may become part of a path: never out of its folder."""
    return isinstance(name, str) and name not in ("", ".", "..") and not re.search(r"[/\\\x00-\x1f]", name)


def _matcher(case_filter: str | None) -> re.Pattern[str]:
    """`*` and `?` only: brackets are part of case names."""
    wild = {"*": ".*", "?": "."}
    return re.compile("".join(wild.get(letter, re.escape(letter)) for letter in (case_filter if case_filter else "*")), re.DOTALL)


def read_run(root: Path, case_filter: str | None = None) -> Run:
    """Read the tree at `root`; keep the cases that match `case_filter` (`*` and `?`).

    Raises FileNotFoundError where `root` is not a folder. Anything less than that is listed in `problems`.
    """
    if not root.is_dir():
        raise FileNotFoundError(f"{root}: not a results tree: no such folder")
    reader = _Reader(root)
    manifest = reader.json(root / "run.json", required=True)
    results = reader.json(root / "results.json", required=True)
    entries: dict[str, Facts] = {}
    for entry in objects(results, "cases"):
        name = text(entry, "case")
        if _is_safe(name):
            entries[name] = entry
        else:
            reader.problems.append(Problem("results.json", f"a case whose name cannot be a folder: {name!r}"))
    for folder in sorted((root / "cases").glob("*/")):
        entries.setdefault(folder.name, {})
    match = _matcher(case_filter)
    cases = tuple(reader.case(name, facts) for name, facts in entries.items() if match.fullmatch(name))
    if len(items(results, "cases")) == 0:
        reader.problems.append(
            Problem("results.json", "names no case" if results else "says nothing: the run may have been interrupted")
        )
    return Run(root, manifest, results, cases, tuple(reader.problems))
