"""A whole push: scenes, pictures, curves, causes, and `extremes.json`."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from equilux.extremes import telling
from equilux.extremes.causes import with_causes
from equilux.extremes.measure import measured
from equilux.extremes.push import Push
from equilux.extremes.record import AdapterRecord, AxisRecord, Extremes
from equilux.run import INTERRUPTED, Options, execute
from equilux.wholefile import whole_file, write_json

FILE = "extremes.json"
SCENES = "extremes"
"""Folder of the scene files that were rendered, as `equilux run` takes them."""


@dataclass(frozen=True)
class Pushed:
    """record: None if the run was interrupted. errors: faults of the engine itself."""

    record: Extremes | None
    errors: tuple[str, ...]


def carry_out(push: Push, options: Options) -> Pushed:
    """Render, measure, diagnose, write. Raises BadUsage for a folder that cannot be used.

    options.diagnose: whether to say why the first broken picture of each direction is wrong; nothing else is diagnosed.
    """
    finished = execute(push.plan, replace(options, diagnose=False, materials=False), telling.suitable(push))
    if finished.exit_code == INTERRUPTED:
        return Pushed(None, finished.errors)
    axes: Sequence[AxisRecord] = measured(push, finished.results, options.out)
    errors = list(finished.errors)
    if options.diagnose:
        axes, faults = with_causes(axes, push, options.out, options.store, limit_s=options.diagnosis_limit_s, jobs=options.jobs)
        errors += faults
    record = Extremes(run=finished.results.run, adapters=_adapters(push), axes=list(axes))
    _write_scenes(push, options.out / SCENES)
    write_json(options.out / FILE, record.model_dump(mode="json"))
    return Pushed(record, tuple(errors))


def _adapters(push: Push) -> dict[str, AdapterRecord]:
    knobs = {name: model.model_dump(mode="json") for name, model in push.plan.knobs.items()}
    return {
        entry.name: AdapterRecord(
            title=getattr(entry.adapter, "title", entry.name), version=entry.version, knobs=knobs.get(entry.name, {})
        )
        for entry in push.plan.entries
    }


def _write_scenes(push: Push, folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    axes = {axis.name: axis for axis in push.axes}
    for (name, model, value), case in push.cases.items():
        with whole_file(folder / f"{case.name}.scene.yaml") as temporary:
            temporary.write_text(axes[name].text(value, model), encoding="utf-8")
