"""A render judged three ways, in words, and what to do about a pair."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from equilux.diagnose.diagnosis import Found
from equilux.explain.causes import UNEXPLAINED, departs, is_expected
from equilux.explain.numbers import listed
from equilux.results import CaseRecord, PairRecord, Standing
from equilux.trust import TRUTHS, truth_among

FINDING_WORDS = {
    "as-modelled": ("as modelled", "it does what the scene's model says"),
    "model-difference": ("a model difference", "it departs from the scene's model, exactly as it declares"),
    "implementation-bug": ("an implementation bug", "it departs from what it declares, by rules of the renderer's own"),
    "translation-bug": ("a translation bug", "the renderer was probably asked the wrong question"),
    "unexplained": ("unexplained", "it departs, and no named cause accounts for it"),
}
PROPOSES = "the same run with --update-expectations proposes the edit of the spec"


def standing_lines(case: CaseRecord, pair: PairRecord) -> list[str]:
    """The three ways of judging, for each side that is no truth."""
    truth = truth_among(name for name, render in case.renders.items() if render.status in ("ok", "invalid"))
    lines: list[str] = []
    for adapter in (pair.a, pair.b):
        render = case.renders.get(adapter)
        if render is not None and render.standing is not None and adapter not in TRUTHS:
            lines += [f"{adapter}, three ways:", *(f"  {line}" for line in three_ways(render.standing, truth))]
    return lines


def three_ways(standing: Standing, truth: str | None) -> list[str]:
    """Against the truth, against the declared dialect, against the peers; and what follows."""
    against = {"agree": "agrees", "diverge": "diverges", None: "nothing to hold it against"}
    name = f"the truth ({truth})" if truth else "the truth"
    dialect = {"agree": "agrees", "diverge": "diverges", None: "nothing that it declares concerns this case"}
    peers = [
        f"{words} {listed(names)}"
        for words, names in (
            ("agrees with", [peer for peer, stands in standing.peers.items() if stands == "agree"]),
            ("diverges from", [peer for peer, stands in standing.peers.items() if stands == "diverge"]),
        )
        if names
    ]
    finding, meaning = FINDING_WORDS[standing.finding]
    return [
        f"against {name}: {against[standing.truth]}",
        f"against its declared dialect: {dialect[standing.dialect]}",
        f"against its peers: {', '.join(peers) or 'none was compared'}",
        f"finding: {finding}: {standing.reason or meaning}",
    ]


def next_steps(case: CaseRecord, pair: PairRecord, found: Sequence[Found], programs: Mapping[str, str], run: str) -> list[str]:
    """What to do, most useful first; nothing where all is as it should be."""
    steps: list[str] = []
    if pair.judged == "improved":
        steps = _improved(case, pair)
    elif pair.judged == "not_comparable":
        steps = ["give the renderer what the reason asks for, or judge it on another scene"]
    elif pair.judged == "diverge_unexpected":
        steps = _unexpected(case, pair, found, programs, run)
    return ["next:", *(f"  - {step}" for step in steps)] if steps else []


def _improved(case: CaseRecord, pair: PairRecord) -> list[str]:
    gone = [used for used in case.expect if used.adapter in (pair.a, pair.b) and used.held is False]
    gone = gone or [used for used in case.expect if used.adapter in (pair.a, pair.b)]
    names = listed(list(dict.fromkeys(used.cause for used in gone)))
    return [f"remove the expectation of {names} from {_spec(case)}, or narrow its `when`; {PROPOSES}"]


def _unexpected(case: CaseRecord, pair: PairRecord, found: Sequence[Found], programs: Mapping[str, str], run: str) -> list[str]:
    if pair.invalid:
        return [
            f"find out why {listed(_invalid_sides(case, pair))} delivers values that are no radiance: no expectation covers those"
        ]
    new = [cause for cause in found if cause.id != UNEXPLAINED and not is_expected(cause, departs(cause, pair), case)]
    left = [cause for cause in found if cause.id == UNEXPLAINED]
    steps = []
    for cause in new:
        who = departs(cause, pair)
        if cause.suspects == "translation" and not cause.declared:
            program = f": {programs[who]}" if who in programs else ""
            steps.append(
                f"{cause.id}: look at what {who} was given{program}; axes, units, names and the order of bands are suspects"
            )
        elif cause.declared:
            steps.append(f"{cause.id}: {who} declares it; pin it in {_spec(case)} with {_pin(cause, who)}")
        else:
            steps.append(
                f"{cause.id}: mend {who}{_formula(cause)}, or, if it always does so, declare it in its adapter's "
                f"dialect and pin it with {_pin(cause, who)}"
            )
    if new and not left:
        steps.append(PROPOSES)
    if left or not found:
        steps.append(_look(case, pair, left, run))
    return steps


def _look(case: CaseRecord, pair: PairRecord, left: Sequence[Found], run: str) -> str:
    """Where to look for what is not known."""
    places = [(cause.region.x0 + cause.region.x1, cause.region.y0 + cause.region.y1) for cause in left if cause.region]
    place = (places[0][0] // 2, places[0][1] // 2) if places else None
    if place is None and pair.worst is not None:
        place = (pair.worst.x, pair.worst.y)
    what = "what is unexplained" if left else "the difference"
    if place is None:
        return f"look at {what} in the report: {run}/report/index.html"
    return f"look at {what}: equilux explain {run} '{case.case}' {pair.a} {pair.b} --pixel {place[0]},{place[1]}"


def _invalid_sides(case: CaseRecord, pair: PairRecord) -> list[str]:
    sides = [name for name in (pair.a, pair.b) if name in case.renders and case.renders[name].status == "invalid"]
    return sides or [pair.a, pair.b]


def _formula(cause: Found) -> str:
    return f" so that it does {cause.formula[0]}" if cause.formula else ""


def _pin(cause: Found, who: str) -> str:
    name = f'"{cause.id}"' if ":" in cause.id else cause.id
    return f"expect: - {{adapter: {who}, cause: {name}}}"


def _spec(case: CaseRecord) -> str:
    return case.scene_file or f"the spec of {case.scene}"
