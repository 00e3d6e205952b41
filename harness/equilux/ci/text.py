"""A pair and a render in full: the text of a failure, which alone must tell a renderer's developer what to fix.

The most of it is what `equilux explain` says; here are added the lines of the spec, the program that the renderer was given, and
what to type next.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator

from equilux.ci.places import places_in
from equilux.ci.view import RunView, shown
from equilux.ci.words import gone, pair_headline, render_headline
from equilux.explain.gather import gather
from equilux.explain.sentences import explain_pair
from equilux.results import CaseRecord, PairRecord
from equilux.tree import read_json
from equilux.trust import TRUTHS

STDERR_LINES = 12
"""What a terminal shows of a renderer's last words without scrolling away the rest."""


def pair_text(case: CaseRecord, pair: PairRecord, view: RunView) -> str:
    """Everything there is to say of a pair. The first line is the whole in short."""
    told = gather(view.read, case, pair)
    lines = [f"{case.case}: {pair_headline(case, pair)}", "", *explain_pair(case, pair, told)[1:], ""]
    lines += _spec_lines(case, pair, view)
    lines += [f"program given to {name}: {path}" for name, path in told.programs.items() if name not in TRUTHS]
    tree = shlex.quote(shown(view.tree))
    lines += [
        f"again:   equilux explain {tree} {shlex.quote(case.case)} {pair.a} {pair.b}",
        f"picture: equilux report {tree}",
    ]
    return "\n".join(lines)


def render_text(case: CaseRecord, adapter: str, view: RunView) -> str:
    """Why there is no picture, the renderer's last words, and the program that it was given."""
    render = case.renders[adapter]
    record = read_json(view.read.render_folder(case.case, adapter) / "render.json") or {}
    lines = [f"{case.case}: {render_headline(case, adapter)}", ""]
    ended = [f"by signal {render.signal}"] if render.signal else []
    ended += [f"after {render.attempts} attempts"] if render.attempts > 1 else []
    lines.append(" ".join(["status:", render.status, *ended]))
    lines.append(f"renderer: {adapter} {render.version}".rstrip())
    if render.missing_features:
        lines.append(f"lacks: {', '.join(render.missing_features)}")
    if tail := str(record.get("stderr_tail") or "").splitlines():
        lines.append("its last words:" if len(tail) <= STDERR_LINES else f"the last {STDERR_LINES} lines that it said:")
        lines += [f"  {line}" for line in tail[-STDERR_LINES:]]
    if (source := view.sources.get(case.scene)) is not None:
        lines.append(f"scene: {shown(source)}:{places_in(source).name[0]}")
    entry = (record.get("program") or {}).get("entry")
    path = view.read.render_folder(case.case, adapter) / "program" / str(entry)
    if entry and path.exists():
        lines.append(f"program given to {adapter}: {shown(path)}")
    return "\n".join(lines)


def _spec_lines(case: CaseRecord, pair: PairRecord, view: RunView) -> Iterator[str]:
    """Where the scene and its expectations of this pair stand."""
    source = view.sources.get(case.scene)
    if source is None:
        return
    places = places_in(source)
    yield f"scene: {shown(source)}:{places.name[0]}"
    pinned = [used for used in case.expect if used.adapter in (pair.a, pair.b)]
    for used in gone(case, pair) if pair.judged == "improved" else pinned:
        line, column = places.of(used)
        advice = " no longer holds: remove it" if pair.judged == "improved" else ""
        when = f" when {used.when}" if used.when else ""
        yield f"expectation: {shown(source)}:{line}:{column}: {used.adapter}: {used.cause}{when}{advice}"
