"""A pair in words: the verdict, the worst pixel, the causes, the three ways of judging, what to do next. Reads no files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.explain.causes import cause_lines, causes_of, name_of, unexplained_lines
from equilux.explain.numbers import BANDS, UNIT, bands, counted, listed, number, share, short
from equilux.explain.pixel import PixelFacts
from equilux.explain.standing import next_steps, standing_lines
from equilux.results import CaseRecord, PairRecord, Worst

VERDICT_WORDS = {
    "agree": "agree within their uncertainties",
    "diverge_expected": "diverge, as the scene expects",
    "diverge_unexpected": "diverge, and the scene does not expect it",
    "improved": "an expectation of the scene no longer holds",
    "not_comparable": "cannot be compared",
}
REASON_WIDTH = 120


@dataclass(frozen=True)
class Told:
    """What results.json does not hold, and what a results tree may add. worst: the worst pixel with its bound, part by part.
    statistics: the pair's .json. diagnoses: by adapter. programs: by adapter, the file that its renderer was given."""

    worst: PixelFacts | None = None
    statistics: Mapping[str, Any] = field(default_factory=dict)
    diagnoses: Mapping[str, Diagnosis] = field(default_factory=dict)
    programs: Mapping[str, str] = field(default_factory=dict)
    run: str = "RUN"


def explain_pair(case: CaseRecord, pair: PairRecord, told: Told | None = None) -> list[str]:
    """All that is known of why two renders differ, as lines of text, blank lines between paragraphs."""
    told = told or Told()
    found = causes_of(case, pair, told.diagnoses)
    paragraphs = [_verdict(case, pair, told), _worst(pair, told)]
    if pair.verdict == "diverge":
        paragraphs.append(_why(case, pair, found))
    paragraphs += [standing_lines(case, pair), next_steps(case, pair, found, told.programs, told.run)]
    lines: list[str] = []
    for paragraph in paragraphs:
        lines += ([""] if lines and paragraph else []) + paragraph
    return lines


def one_line(case: CaseRecord, pair: PairRecord) -> str:
    """The pair on one line: verdict, how much, where, and why: "vtk against oracle: diverge, and …: 812 of 49152 pixels, worst
    0.0123 W/(m²·sr) at (128, 40): exponent-clamped [128] (99.8 %)"."""
    parts = [f"{pair.a} against {pair.b}: {VERDICT_WORDS[pair.judged]}"]
    if pair.verdict == "diverge":
        if pair.diverge:
            parts.append(f"{pair.diverge} of {counted(pair.pixels, 'pixel')}" + _by_how_much(pair))
        if pair.invalid:
            parts.append(f"{counted(pair.invalid, 'pixel')} invalid")
    if pair.reason and not pair.reason.startswith(f"{pair.diverge} of {pair.pixels} "):
        parts.append(pair.reason)
    causes = [
        name_of(found) + (f" ({share(found.explained)})" if found.explained is not None else "")
        for found in causes_of(case, pair, {})
    ]
    return ": ".join(filter(None, [", ".join(parts[:1]), ", ".join(parts[1:]), listed(causes)]))


def _by_how_much(pair: PairRecord) -> str:
    worst = f", worst {short(pair.max_abs)} {UNIT}" if pair.max_abs is not None else ""
    far = pair.look_at
    return worst + (f" at ({far.x}, {far.y})" if far is not None else "")


# --- verdict ----------------------------------------------------------------------------------------------------------


def _verdict(case: CaseRecord, pair: PairRecord, told: Told) -> list[str]:
    lines = [f"{case.case}: {pair.a} against {pair.b}", f"verdict: {_verdict_words(case, pair)}"]
    if pair.reason and not pair.reason.startswith(f"{pair.diverge} of {pair.pixels} "):  # the counts follow
        lines.append(f"reason: {pair.reason}")
    counts = [(pair.agree, "agree"), (pair.diverge, "diverge"), (pair.edge, "edge"), (pair.invalid, "invalid")]
    if sum(count for count, _ in counts):
        told_counts = [
            f"{count} {name}" + (f" ({share(count / pair.pixels)})" if count and pair.pixels else "") for count, name in counts
        ]
        lines.append(f"pixels: {', '.join(told_counts)}, of {pair.pixels}")
    lines += _invalid_kinds(pair, told.statistics)
    if pair.max_abs is not None:
        statistics = {
            "largest": pair.max_abs, "rms": pair.rms, "bias": pair.bias, "median": pair.p50, "p95": pair.p95, "p99": pair.p99,
        }  # fmt: skip
        said = ", ".join(f"{name} {short(value)}" for name, value in statistics.items() if value is not None)
        lines.append(f"difference over all pixels but edges: {said} {UNIT}" + _relative(pair))
    return lines


def _relative(pair: PairRecord) -> str:
    return f"; relative to {pair.b} at most {short(pair.max_rel)}" if pair.max_rel is not None else ""


def _verdict_words(case: CaseRecord, pair: PairRecord) -> str:
    words = VERDICT_WORDS[pair.judged]
    pinned = [used.cause for used in case.expect if used.adapter in (pair.a, pair.b)]
    if pair.judged == "diverge_expected" and pinned:
        return f"{words} ({listed(list(dict.fromkeys(pinned)))})"
    if pair.judged == "improved":
        gone = [used.cause for used in case.expect if used.adapter in (pair.a, pair.b) and used.held is False] or pinned
        agreement = "agree" if pair.verdict == "agree" else "diverge by other causes"
        return f"{words}: they {agreement}, {listed(gone, 'nor')} is not found"
    return words


def _invalid_kinds(pair: PairRecord, statistics: Mapping[str, Any]) -> list[str]:
    kinds = statistics.get("invalid_kinds") or {}
    words = {"nan": "NaN", "+inf": "+Inf", "-inf": "−Inf", "negative": "negative beyond its own uncertainty"}
    lines = []
    for side, adapter in (("a", pair.a), ("b", pair.b)):
        held = [f"{count} {words.get(kind, kind)}" for kind, count in (kinds.get(side) or {}).items() if count]
        if held:
            lines.append(f"invalid pixels of {adapter}: {', '.join(held)}")
    return lines


# --- the worst pixel --------------------------------------------------------------------------------------------------


def _worst(pair: PairRecord, told: Told) -> list[str]:
    if pair.worst is None:
        return []
    if told.worst is not None:
        named = [f"worst pixel: {line}" if not index else line for index, line in enumerate(pixel_lines(pair, told.worst))]
    else:
        named = [f"worst pixel: {line}" if not index else line for index, line in enumerate(_both(pair, pair.worst))]
        if pair.en_max is not None:
            named.append(f"  |E_n| = {short(pair.en_max)}: the difference is that many times the uncertainty B of the two")
    if pair.farthest is None or (pair.farthest.x, pair.farthest.y) == (pair.worst.x, pair.worst.y):
        return named
    first, *rest = _both(pair, pair.farthest)
    return [f"farthest apart: {first}", *rest, *named]


def _both(pair: PairRecord, pixel: Worst) -> list[str]:
    """Where, and what either side shows there."""
    width = max(len(pair.a), len(pair.b))
    sides = ((pair.a, pixel.a), (pair.b, pixel.b))
    return [f"({pixel.x}, {pixel.y})", *(f"  {name.ljust(width)}  {bands(shown)} {UNIT}" for name, shown in sides)]


def pixel_lines(pair: PairRecord, facts: PixelFacts) -> list[str]:
    """One pixel: both values, the difference, B with its parts, E_n, the class."""
    width = max(len(pair.a), len(pair.b))
    band = facts.band
    in_band = f" (band {BANDS[band]}, the worst)" if len({*facts.difference}) > 1 else ""
    said_class = f", {facts.pixel_class}" if facts.pixel_class else ""
    lines = [
        f"({facts.x}, {facts.y}){said_class}",
        f"  {pair.a.ljust(width)}  {bands(facts.a)} {UNIT}",
        f"  {pair.b.ljust(width)}  {bands(facts.b)} {UNIT}",
        f"  difference {number(facts.difference[band], 4)}, uncertainty of both B = {short(facts.bound[band])}, "
        f"E_n = {short_or_infinite(facts.normalised_error[band])}{in_band}",
    ]
    if facts.parts:
        lines.append("  B is the sum of:")
    for part in facts.parts:
        amount = short(part.amount[band])
        reason = f": {_cut(part.reason)}" if part.reason else ""
        lines.append(f"    {amount:>9}  {part.adapter}: {part.term} ({part.kind}){reason}")
    return lines


def _cut(reason: str) -> str:
    """The beginning of a derivation; all of it is in render.json and in --json."""
    return reason if len(reason) <= REASON_WIDTH else reason[: REASON_WIDTH - 1].rstrip() + "…"


def short_or_infinite(value: float) -> str:
    if value in (float("inf"), float("-inf")):
        return f"{'−' if value < 0 else ''}∞ (they differ, and claim to be exact)"
    return short(value)


# --- why --------------------------------------------------------------------------------------------------------------


def _why(case: CaseRecord, pair: PairRecord, found: Sequence[Found]) -> list[str]:
    proven = [cause for cause in found if cause.id != "unexplained"]
    left = [cause for cause in found if cause.id == "unexplained"]
    lines = ["why:"] if found else ["why: not diagnosed" + _not_diagnosed(pair)]
    for position, cause in enumerate(proven, 1):
        lines += cause_lines(position, cause, case, pair)
    if len(proven) > 1 and pair.explained is not None:
        lines.append(f"  all together explain {share(pair.explained)} of the diverging pixels")
    for cause in left:
        lines += unexplained_lines(cause, pair)
    return lines


def _not_diagnosed(pair: PairRecord) -> str:
    if pair.invalid and not pair.diverge:
        return ": no cause stands for pixels that are no radiance"
    if pair.max_abs is None:
        return ": the pictures cannot be laid over each other"
    return ""
