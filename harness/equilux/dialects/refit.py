"""Finding a declared rule's number anew: from the pictures of a run, as if nobody had declared it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from equilux.adapter import Bound, Budget, Case, Geometric
from equilux.casework import MAPS_FILE, saved_picture
from equilux.compare import RenderedImage
from equilux.diagnose.diagnosis import Found
from equilux.diagnosing import restating, scored_pair
from equilux.identity import case_digest
from equilux.readrun import ReadRun
from equilux.results import CaseRecord
from equilux.tree import read_json
from equilux.trust import TRUTHS
from equilux.uncertainty import Uncertainty
from equilux_scenes.loader import corpus_folder, load_scene_file

if TYPE_CHECKING:
    from equilux_tracer.causes import Rule

TIME_LIMIT_S = 60.0
"""One rule alone is searched for, which takes seconds."""


def refitted(run: ReadRun, record: CaseRecord, adapter: str, rule: Rule) -> Found | None:
    """What the search finds of a render when this rule is the only one it knows and nothing is declared. None where it finds
    nothing, and where the scene of the case, as it was rendered, is not at hand."""
    from equilux.diagnose import search

    case = case_of(run, record)
    truth = next((name for name in TRUTHS if name in record.renders and record.renders[name].status == "ok"), None)
    pair = read_json(run.pair_file(record.case, adapter, truth, "json")) if truth is not None else None
    if case is None or truth is None or pair is None:
        return None
    folder = run.render_folder(record.case, adapter)
    side, budget = rendered(adapter, folder)
    found = search.diagnose(
        case,
        side,
        rendered(truth, run.render_folder(record.case, truth))[0],
        scored_pair(pair, run.pair_file(record.case, adapter, truth, "json").parent),
        restate=restating(side, budget),
        rules={rule.id: rule},
        time_limit_s=TIME_LIMIT_S,
    )
    return next(iter(found.proven), None)


def case_of(run: ReadRun, record: CaseRecord) -> Case | None:
    """The case as it was rendered; None where its file is not at hand, or is another one by now."""
    digest = run.manifest.get("identity", {}).get("cases", {}).get(record.case)
    for base in (corpus_folder(), Path.cwd()):
        path = base / (record.scene_file or "")
        if path.is_file():
            for case in load_scene_file(path).cases:
                if case.name == record.case and case_digest(case) == digest:
                    return case
    return None


def rendered(adapter: str, folder: Path) -> tuple[RenderedImage, Budget | None]:
    """A render of a results tree, and its budget where the tree says all of it.

    Raises OSError or ValueError for one that is damaged.
    """
    stated = (read_json(folder / "render.json") or {}).get("uncertainty") or {}
    side = RenderedImage(adapter, saved_picture(folder), Uncertainty.from_json(stated, folder / MAPS_FILE))
    return side, budget_of(stated["terms"])


def budget_of(terms: Sequence[Mapping[str, Any]]) -> Budget | None:
    """The budget that render.json tells of; None where a term varies per pixel, of which it tells a summary alone."""
    out: list[Bound | Geometric] = []
    for term in terms:
        named = (term["name"], term["reason"])
        if term["kind"] == "bound" and isinstance(term["abs"], float | int):
            out.append(Bound(*named, abs=term["abs"], rel=term["rel"]))
        elif term["kind"] == "geometric":
            normal, position_m = (_of_objects(term[name]) for name in ("normal", "position_m"))
            out.append(Geometric(*named, normal=normal, position_m=position_m, film_px=term["film_px"]))
        else:
            return None
    return Budget(tuple(out))


def _of_objects(value: Any) -> float | dict[int, float]:
    return {int(index): float(part) for index, part in value.items()} if isinstance(value, Mapping) else float(value)
