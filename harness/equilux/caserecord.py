"""One case as it stands in results.json: what became of its renders, how its pairs are judged, and why they diverge."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from equilux.adapter import Case
from equilux.casework import CaseWork
from equilux.diagnose.diagnosis import Found
from equilux.judge import DELIVERED, judge_case
from equilux.results import (
    AccuracyRecord,
    CaseRecord,
    ExpectationRecord,
    Luminance,
    PairRecord,
    RenderRecord,
    Standing,
    StatedUncertainty,
)
from equilux.standing import standing_of
from equilux.trust import TRUTHS, truth_among
from equilux_scenes.loader import corpus_folder

JUDGEMENT_WORDS = {
    "agree": "agree", "diverge_expected": "diverge as expected", "diverge_unexpected": "diverge unexpectedly",
    "improved": "agree against expectation", "not_comparable": "not comparable",
}  # fmt: skip


def case_record(work: CaseWork, excused: Mapping[str, Collection[str]], ruled: Collection[str]) -> CaseRecord:
    """Judge a case as it is by now. excused: see `judge_case`, as for ruled, the causes that have a rule."""
    case = work.case
    pairs = [work.pairs[names] for names in sorted(work.pairs)]
    statuses = {name: record["status"] for name, record in work.records.items()}
    judged = judge_case(case, statuses, pairs, work.diagnoses, excused=excused, ruled=ruled)
    diagnoses = work.diagnoses or {}
    truth = truth_among(name for name, status in statuses.items() if status in DELIVERED)

    def standing(name: str) -> Standing | None:
        if statuses[name] not in DELIVERED:
            return None
        return standing_of(name, truth, pairs, diagnoses.get(name), was_diagnosed=work.diagnoses is not None)

    return CaseRecord(
        case=case.name,
        scene=case.scene_name,
        model=case.scene.model,
        about=case.scene.about,
        scene_file=_scene_file(case),
        axes=dict(case.axes),
        width=case.scene.film.width,
        height=case.scene.film.height,
        requires=list(case.requires),
        photometry=work.photometry,
        expect=[
            ExpectationRecord(adapter=used.adapter, cause=used.cause, when=used.when, held=held)
            for used, held in zip(judged.expectations_used, judged.held, strict=True)
        ],
        renders={
            name: _render_record(work.records[name], work.luminance.get(name), standing(name)) for name in sorted(work.records)
        },
        pairs=[_pair_record(pair, judged.judged[pair["a"], pair["b"]], work) for pair in pairs],
    )


def case_line(work: CaseWork, judged: CaseRecord) -> str:
    """A finished case in one line."""
    renders = ", ".join(f"{name} {record.status}" for name, record in judged.renders.items())
    counts = Counter(str(pair.judged) for pair in judged.pairs)
    pairs = ", ".join(f"{counts[judgement]} {words}" for judgement, words in JUDGEMENT_WORDS.items() if counts[judgement])
    return f"{work.case.name}: {renders}; {f'pairs: {pairs}' if pairs else 'no pair'}"


def _render_record(record: Mapping[str, Any], luminance: Luminance | None, standing: Standing | None) -> RenderRecord:
    stated = record["uncertainty"]
    return RenderRecord(
        status=record["status"],
        reason=record["reason"],
        missing_features=record["missing_features"],
        signal=record["signal"],
        attempts=record["attempts"],
        version=record["version"],
        seconds=record["seconds"],
        cpu_seconds=record.get("cpu_seconds", {}),
        reused=record["reused"],
        accuracy=AccuracyRecord.model_validate(record["accuracy"]) if record.get("accuracy") else None,
        largest=(record.get("image") or {}).get("largest"),
        luminance=luminance,
        standing=standing,
        uncertainty=StatedUncertainty(**{name: stated[name] for name in StatedUncertainty.model_fields}) if stated else None,
    )


def _pair_record(pair: Mapping[str, Any], judged: str, work: CaseWork) -> PairRecord:
    fields = {name: pair[name] for name in PairRecord.model_fields if name in pair}
    explained, causes = _explained(pair, work)
    return PairRecord.model_validate(
        fields | {"judged": judged, "expected": judged == "diverge_expected", "explained": explained, "causes": causes}
    )


def _explained(pair: Mapping[str, Any], work: CaseWork) -> tuple[float | None, list[Found]]:
    """Why a pair diverges: with a truth, what was found of the render; between peers, what was found of both, each against the
    truth."""
    if pair["verdict"] != "diverge":
        return None, []
    if (found := work.explanations.get((pair["a"], pair["b"]))) is not None:
        return found.explained, list(found.causes)
    diagnosed = work.diagnoses or {}
    sides = [diagnosed[name] for name in (pair["a"], pair["b"]) if name in diagnosed]
    causes = [cause.model_copy(update={"side": cause.side or side.adapter}) for side in sides for cause in side.causes]
    explained = sides[0].explained if sides and pair["b"] in TRUTHS else None
    return explained, causes


def _scene_file(case: Case) -> str | None:
    """The spec's file, relative to the corpus or to the folder the run was started in; elsewhere its last two parts."""
    if case.source is None:
        return None
    source = case.source.resolve()
    for base in (corpus_folder().resolve(), Path.cwd()):
        if source.is_relative_to(base):
            return source.relative_to(base).as_posix()
    return Path(*source.parts[-2:]).as_posix()
