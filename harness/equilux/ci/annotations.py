"""GitHub annotations: workflow commands that mark the spec's lines in a pull request.

GitHub shows ten errors of a step, so what is alike (one scene, one adapter, one kind) is one annotation, and what needs a look
most comes first.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from equilux.ci import words
from equilux.ci.places import Position, places_in
from equilux.ci.view import RunView

CASES_NAMED = 5
"""Of one annotation: it is a note in a review, and the summary has the rest."""


@dataclass(frozen=True)
class _Mark:
    """What several messages have in common."""

    source: Path | None
    place: Position
    title: str


def commands(view: RunView, workspace: str | None = None) -> list[str]:
    """One workflow command per line. workspace: the checkout, which GitHub takes file names to be relative to."""
    marks: dict[_Mark, list[str]] = {}
    for mark, message in (*_pairs("diverge_unexpected", view), *_pairs("improved", view), *_renders(view)):
        marks.setdefault(mark, []).append(message)
    engine = [_command({"title": "equilux: fault of the engine"}, error) for error in view.errors]
    return engine + [_written(mark, messages, workspace) for mark, messages in marks.items()]


def _pairs(judged: str, view: RunView) -> Iterator[tuple[_Mark, str]]:
    """At the scene's name; what is gone at its expectation."""
    for case in view.results.cases:
        source = view.sources.get(case.scene)
        places = places_in(source)
        for pair in case.pairs:
            if pair.judged != judged or not words.speaks_for_itself(case, pair):
                continue
            message = f"{case.case}: {words.pair_headline(case, pair)}"
            if judged == "improved":
                for used in words.gone(case, pair):
                    title = f"{case.scene}: {used.adapter} no longer diverges by {used.cause}"
                    yield _Mark(source, places.of(used), title), message
            else:
                yield _Mark(source, places.name, f"{case.scene}: {pair.a} diverges unexpectedly"), message


def _renders(view: RunView) -> Iterator[tuple[_Mark, str]]:
    for case, name in words.failed_renders(view.results.cases, view.named):
        source = view.sources.get(case.scene)
        title = f"{case.scene}: {name} {case.renders[name].status}"
        yield _Mark(source, places_in(source).name, title), f"{case.case}: {words.render_headline(case, name)}"


def _written(mark: _Mark, messages: list[str], workspace: str | None) -> str:
    messages = list(dict.fromkeys(messages))
    more = len(messages) - CASES_NAMED
    text = "\n".join(messages[:CASES_NAMED]) + (f"\n… and {more} more" if more > 0 else "")
    place: dict[str, str] = {}
    if (file := _file(mark.source, workspace)) is not None:
        place = {"file": file, "line": str(mark.place[0]), "col": str(mark.place[1])}
    return _command(place | {"title": mark.title}, text)


def _file(source: Path | None, workspace: str | None) -> str | None:
    """Relative to the checkout; None for a spec that lies elsewhere (the shipped corpus), where no line can be marked."""
    if source is None:
        return None
    base = Path(workspace).resolve() if workspace else Path.cwd()
    path = source.resolve()
    return path.relative_to(base).as_posix() if path.is_relative_to(base) else None


def _command(properties: dict[str, str], message: str) -> str:
    """A workflow command; what it may not hold is escaped as the runner expects it (docs.github.com, "Workflow commands")."""
    written = ",".join(f"{key}={_property(value)}" for key, value in properties.items())
    return f"::error {written}::{_data(message)}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
