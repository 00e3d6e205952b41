"""Results trees without any renderer: pictures and causes are given, comparison is the engine's own."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from equilux.budget import Bound, Budget, Sampled
from equilux.compare import RenderedImage, compare_pair, write_pair
from equilux.diagnose.diagnosis import Diagnosis, Found, Region
from equilux.planes import write_planes
from equilux.results import (
    CaseRecord,
    ExpectationRecord,
    PairRecord,
    RenderRecord,
    Results,
    RunRecord,
    Standing,
    StatedUncertainty,
    summarise,
)
from equilux.trust import trust_rank
from equilux.uncertainty import stated
from equilux.wholefile import write_json

WIDTH, HEIGHT = 8, 6
CLAMPED = Found(
    id="exponent-clamped",
    parameter=128.0,
    explained=1.0,
    residual_max_abs=3e-9,
    side="vtk",
    words="the highlight's exponent is cut off at 128",
    formula=("K_spec (R·V)^p", "K_spec (R·V)^min(p, max)"),
    region=Region(pixels=4, x0=2, y0=2, x1=3, y1=3, words="on objects[0] (sphere, clay), in the highlight of light key"),
)


def truth() -> np.ndarray:
    """(6, 8, 3), between 0.1 and 1, every pixel different."""
    return np.linspace(0.1, 1, WIDTH * HEIGHT * 3).reshape(HEIGHT, WIDTH, 3)


def brighter(pixels: tuple[slice, slice] = (slice(2, 4), slice(2, 4)), by: float = 0.25) -> np.ndarray:
    """The truth, brighter in a few pixels."""
    image = truth()
    image[pixels] += by
    return image


@dataclass
class Render:
    """One render to write. image None: it brought none, `status` and `reason` say why."""

    image: np.ndarray | None = field(default_factory=truth)
    causes: Sequence[Found] = ()
    standing: Standing | None = None
    abs: float = 1e-6
    rel: float = 1e-7
    sigma: float = 0.0
    seconds: float = 0.5
    status: str = "ok"
    reason: str | None = None


@dataclass
class Case:
    """One case to write; `truth` is added as oracle. judged: by adapter, of its pair with the oracle."""

    name: str = "clay-ball"
    renders: Mapping[str, Render] = field(default_factory=dict)
    axes: Mapping[str, Any] = field(default_factory=dict)
    expect: Sequence[ExpectationRecord] = ()
    judged: Mapping[str, str] = field(default_factory=dict)
    scene_file: str | None = None

    @property
    def scene(self) -> str:
        return self.name.partition("[")[0]


def write_tree(root: Path, cases: Sequence[Case], *, files: bool = True, **run: Any) -> Path:
    """Write a run. files: pictures too, not results.json alone. run: fields of run.json and RunRecord."""
    root.mkdir(parents=True, exist_ok=True)
    records = [_write_case(root, case, files=files) for case in cases]
    record = {
        "equilux": "0.1.0",
        "adapters": {"oracle": "0.1.0", "vtk": "9.4.0"},
        "command": ["equilux", "run"],
        "started": "2025-03-01T10:20:30+00:00",
        "ended": "2025-03-01T10:21:11+00:00",
        "seconds": 41.0,
    }
    manifest = {"schema": "equilux/run/1", "machine": {"cores": 2}, "libraries": {"numpy": "2.2.0"}, "adapters": {}}
    for key, value in run.items():
        (record if key in record else manifest)[key] = value
    write_json(root / "run.json", manifest | {"equilux": record["equilux"], "command": record["command"]})
    results = Results(run=RunRecord(**record), cases=records, summary=summarise(records, 0))
    write_json(root / "results.json", results.model_dump(mode="json"))
    return root


def rewrite(root: Path, change: Any) -> None:
    """Change results.json by a function of its content."""
    path = root / "results.json"
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def _write_case(root: Path, case: Case, *, files: bool) -> CaseRecord:
    renders = {"oracle": Render(abs=0.0, rel=2.0**-50)} | dict(case.renders)
    sides = {name: _side(name, render) for name, render in renders.items() if render.image is not None}
    folder = root / "cases" / case.name
    records = {name: _write_render(folder / name, render, sides.get(name), files=files) for name, render in renders.items()}
    pairs = []
    for a in sorted(sides, key=trust_rank, reverse=True):
        for b in sides:
            if trust_rank(b) < trust_rank(a):
                pairs.append(_write_pair(folder, case, sides[a], sides[b], renders, files=files))
    return CaseRecord(
        case=case.name, scene=case.scene, model="phong", scene_file=case.scene_file or f"lights/{case.scene}.scene.yaml",
        axes=dict(case.axes), width=WIDTH, height=HEIGHT, requires=["model.phong"], expect=list(case.expect), renders=records,
        pairs=pairs,
    )  # fmt: skip


def _side(name: str, render: Render) -> RenderedImage:
    assert render.image is not None
    terms: list[Any] = [Bound("quantisation", "half a step of the output channel", abs=render.abs, rel=render.rel)]
    if render.sigma:
        terms.append(Sampled("noise", "independent repeats", np.full(render.image.shape, render.sigma), repeats=64))
    return RenderedImage(name, render.image, stated(Budget(tuple(terms)), render.image))


def _write_render(folder: Path, render: Render, side: RenderedImage | None, *, files: bool) -> RenderRecord:
    facts = side.uncertainty.to_json() if side is not None else None
    if files:
        (folder / "program").mkdir(parents=True)
        (folder / "program" / "scene.txt").write_text("what the renderer was given\n")
        image = None
        if side is not None:
            write_planes(folder / "image.exr", {band: side.image[..., i] for i, band in enumerate("RGB")})
            np.save(folder / "image.npy", side.image)
            side.uncertainty.save_maps(folder / "uncertainty.exr")
            image = {"sha256": hashlib.sha256(side.image.tobytes()).hexdigest(), "width": side.image.shape[1]}
        program = {"entry": "scene.txt", "sha256": "0" * 64}
        write_json(folder / "render.json", {"status": render.status, "uncertainty": facts, "image": image, "program": program})
        if render.causes:
            diagnosis = Diagnosis(adapter=folder.name, diverging=4, explained=1.0, causes=tuple(render.causes))
            write_json(folder / "diagnosis.json", diagnosis.model_dump(mode="json"))
    return RenderRecord(
        status=render.status, reason=render.reason, seconds={"render": render.seconds}, standing=render.standing,
        uncertainty=StatedUncertainty(**{key: facts[key] for key in StatedUncertainty.model_fields}) if facts else None,
    )  # fmt: skip


def _write_pair(
    folder: Path, case: Case, a: RenderedImage, b: RenderedImage, renders: Mapping[str, Render], *, files: bool
) -> PairRecord:
    result = compare_pair(a, b, None)
    if files:
        write_pair(folder, result)
    fields = {name: result.json[name] for name in PairRecord.model_fields if name in result.json}
    diverges, against_truth = result.json["verdict"] == "diverge", b.adapter == "oracle"
    judged = {"agree": "agree", "diverge": "diverge_unexpected"}.get(result.json["verdict"], "not_comparable")
    if against_truth:
        judged = case.judged.get(a.adapter, judged)
    causes = list(renders[a.adapter].causes) if diverges and against_truth else []
    found = {"causes": causes, "explained": 1.0 if causes else None}
    return PairRecord.model_validate(fields | {"judged": judged, "expected": judged == "diverge_expected"} | found)
