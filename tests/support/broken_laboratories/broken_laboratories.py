"""Things registered as adapters that are none."""

from __future__ import annotations

from types import SimpleNamespace

from equilux.adapter import Knobs

INCOMPLETE = SimpleNamespace(name="incomplete", api_version=1, version=lambda: "1", Knobs=Knobs, workers_per_core=1)
OUTDATED = SimpleNamespace(
    name="outdated", api_version=99, Knobs=Knobs, workers_per_core=1.0, lack_causes={}, version=None, probe=None,
    capabilities=None, translate=None, render=None, read=None,
)  # fmt: skip


class Unborn:
    """An adapter's class, registered instead of an instance."""

    name = "unborn"
