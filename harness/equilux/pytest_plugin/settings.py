"""The options of the plugin, read and checked as `equilux run` checks its own."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from equilux.complaint import BadUsage
from equilux.pytest_plugin import given

DEFAULT_OUT = "equilux-out"


@dataclass(frozen=True)
class Settings:
    """As they were given, not yet checked (`Session` does, once a scene was found). token: the session's name, the same in all
    processes of it. processes: how many share the machine.
    """

    out: Path
    token: str
    adapters: str | None = None
    knobs: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    case_filter: str | None = None
    timeout: str = "120"
    memory: str | None = None
    jobs: str | None = None
    diagnosis_timeout: str | None = None
    as_is: bool = False
    reuse: bool = True
    diagnose: bool = True
    processes: int = 1
    marks_groups: bool = False

    @classmethod
    def of(cls, config: pytest.Config, token: str) -> Settings:
        def text(name: str) -> str | None:
            value: Any = given(config, name)
            return None if value is None else str(value)

        return cls(
            out=config.invocation_params.dir / (text("out") or DEFAULT_OUT),
            token=token,
            adapters=text("adapters"),
            knobs=tuple(given(config, "set") or ()),
            limits=tuple(given(config, "limit") or ()),
            case_filter=text("case_filter"),
            timeout=text("timeout") or "120",
            memory=text("memory"),
            jobs=text("jobs"),
            diagnosis_timeout=text("diagnosis_timeout"),
            as_is=bool(given(config, "as_is")),
            reuse=not given(config, "no_reuse"),
            diagnose=not given(config, "no_diagnose"),
            processes=max(1, int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))),
            marks_groups=config.pluginmanager.hasplugin("xdist"),
        )


def above_zero(option: str, text: str, unit: str) -> float:
    """Raises BadUsage for what is no number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise BadUsage(f"{option}: got {text}, expected a number of {unit} above 0")
    return value


def at_least_one(option: str, text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) >= 1):
        raise BadUsage(f"{option}: got {text}, expected an integer of at least 1")
    return int(text)
