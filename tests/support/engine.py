"""Running the engine with fake laboratories, in the test's own process."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

from equilux import knobs, plan
from equilux.adapter import Limits
from equilux.progress import Progress
from equilux.registry import GROUP, Entry, Registry
from equilux.results import CaseRecord
from equilux.reuse import Store
from equilux.run import Finished, Options, execute
from equilux_scenes.loader import SceneFile, load_scene_text

LABORATORIES = Path(__file__).parent / "laboratories"

SCENE = """\
equilux: 1
name: {name}
about: A lit sphere on a tiny film.
model: phong
camera: {{projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30}}
film: {{width: 8, height: 6}}
lights:
  key: {{kind: point, position: [0, 2, 3], intensity: 7.5}}
materials:
  clay: {{diffuse: 0.6, specular: {specular}, exponent: 20}}
objects:
  - {{kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}}
{rest}
"""


def scene(name: str = "tiny", *, specular: float = 0, rest: str = "") -> SceneFile:
    """An 8 × 6 scene. `rest`: further keys, as YAML."""
    return load_scene_text(scene_text(name, specular=specular, rest=rest))


def scene_text(name: str = "tiny", *, specular: float = 0, rest: str = "") -> str:
    return SCENE.format(name=name, specular=specular, rest=rest)


def entry(name: str, value: str | None = None, distribution: str = "fakes") -> Entry:
    value = value or f"fake_laboratories:{name.replace('-', '_')}"
    return Entry(name, distribution, "1.0", EntryPoint(name, value, GROUP))


def registry(*names: str) -> Registry:
    """A registry of fakes, the fake oracle among them; the fake reference only where it is named."""
    return Registry(entry(name) for name in dict.fromkeys((*names, "oracle")))


def planned(
    names: Sequence[str], scenes: Sequence[SceneFile] | None = None, settings: Sequence[str] = (), *, named: bool = True,
    as_is: bool = False,
) -> plan.Plan:  # fmt: skip
    selection = plan.select_adapters(registry(*names), list(names) if named else None)
    cases = [case for found in (scenes or [scene()]) for case in found.cases]
    return plan.make_plan(cases, selection, knobs.resolve(settings, selection.entries), as_is=as_is)


def run(
    out: Path, *names: str, scenes: Sequence[SceneFile] | None = None, settings: Sequence[str] = (), named: bool = True,
    as_is: bool = False, store: Path | None = None, reuse: bool = True, timeout_s: float = 20.0, memory_bytes: int = 8 << 30,
    jobs: int = 2, fail_fast: bool = False, progress: Progress | None = None, diagnose: bool = False,
) -> Finished:  # fmt: skip
    """One run with these fakes and the fake oracle. Without a store nothing is remembered between runs. Without `diagnose`
    expectations are judged by presence: the fakes paint a ramp, which no scene shows and no cause explains."""
    what = planned(names, scenes, settings, named=named, as_is=as_is)
    options = Options(out=out, jobs=jobs, limits=Limits(timeout_s, memory_bytes), reuse=reuse, fail_fast=fail_fast,
                      diagnose=diagnose, store=Store(store) if store is not None else None)  # fmt: skip
    return execute(what, options, progress)


def only_case(finished: Finished) -> CaseRecord:
    (case,) = finished.results.cases
    return case


def pair_of(case: CaseRecord, a: str, b: str) -> Any:
    (pair,) = [pair for pair in case.pairs if {pair.a, pair.b} == {a, b}]
    return pair


def renders_made(state: Path, adapter: str) -> int:
    """How often the fake renderer ran."""
    marks = state / f"{adapter}.renders"
    return len(marks.read_text()) if marks.exists() else 0


def write_scene(path: Path, name: str = "tiny", *, specular: float = 0, rest: str = "") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(scene_text(name, specular=specular, rest=rest))
    return path
