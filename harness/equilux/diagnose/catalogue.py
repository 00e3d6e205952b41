"""All rules there are: equilux's own, and third parties' from the entry-point group `equilux.causes`."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from equilux_scenes.causes import CAUSES, is_known
from equilux_tracer.causes import RULES, Rule

GROUP = "equilux.causes"
"""Entry points of this group name a Rule, a class of it, or a sequence of either; ids are written `name:cause`."""


def all_rules() -> Mapping[str, Rule]:
    """Id → rule, equilux's own first. What a third party registered and cannot be used is in `broken_rules`, and left out."""
    return _loaded()[0]


def broken_rules() -> tuple[str, ...]:
    """One line for each entry point that cannot be used: its name, its distribution, why."""
    return _loaded()[1]


@lru_cache(maxsize=1)
def _loaded() -> tuple[Mapping[str, Rule], tuple[str, ...]]:
    rules, broken = dict(RULES), []
    for entry_point in sorted(importlib.metadata.entry_points(group=GROUP), key=lambda found: (found.name, found.value)):
        try:
            for rule in _rules_of(entry_point.load()):
                rules[_checked_id(rule, rules)] = rule
        except Exception as problem:  # somebody else's code: it must not end a run
            origin = entry_point.dist.name if entry_point.dist is not None else "unknown distribution"
            broken.append(f"{GROUP}: {entry_point.name} ({origin}): {type(problem).__name__}: {problem}")
    return rules, tuple(broken)


def _rules_of(found: object) -> list[Rule]:
    parts: list[Any] = list(found) if isinstance(found, list | tuple) else [found]
    rules: list[Rule] = [part() if isinstance(part, type) else part for part in parts]
    for rule in rules:
        if not isinstance(rule, Rule):
            raise TypeError(f"got {type(rule).__name__}, allowed a Rule, a subclass of it, or a sequence of them")
    return rules


def _checked_id(rule: Rule, known: Mapping[str, Rule]) -> str:
    if rule.id in CAUSES or not is_known(rule.id):
        raise ValueError(f"id {rule.id!r}, allowed 'name:cause'; the plain ids are equilux's own")
    if rule.id in known:
        raise ValueError(f"id {rule.id!r} is registered twice")
    return rule.id
