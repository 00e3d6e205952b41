"""The page about causes, made from the rules themselves: `python -m equilux_tracer.causes.table > docs/causes.md`."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator, Mapping

from equilux_scenes.causes import CAUSES
from equilux_tracer.causes import RULES
from equilux_tracer.causes.rule import Continuous, Discrete, Rule, Vector

TITLES = {
    "image": "The picture",
    "geometry": "Geometry",
    "highlight": "Diffuse term and highlight",
    "light": "Lights, ambient, emission",
    "transport": "What light meets on its way",
}
"""Group → its heading, in the order of the page."""

INTRODUCTION = """\
# Causes: by which rule a renderer departs from the model

<!-- Made by `python -m equilux_tracer.causes.table > docs/causes.md`; a test compares. Change the rules, not this page. -->

A cause is one named change of the lighting model, of the scene, or of the picture, which the reference tracer can carry out. So
it can be proven: of a render that diverges from the truth, the reference is made to behave by the cause, the picture is
computed anew, and compared with the render within the same uncertainty. A cause is reported where that brings diverging pixels
into agreement, never for a correlation. Where one is not enough, sets of up to three are tried, and the smallest that explains
the picture is reported; each cause with the share of the diverging pixels that would be lost without it. Causes that make the
same picture of a scene cannot be told apart there and are reported together. What no cause explains is reported as
`unexplained`, with the place where it lies.

A parameter, in brackets, is fitted to the picture. An idea may have been carried out in several ways: these *readings* are all
tried, the first is the plain one, and the report says which it was. *Suspects* is where the fault more likely is if nobody
declared the cause: in the renderer, or in the translation of the scene for it.

Symbols are those of the lighting model: N, L, V, R, H, T unit vectors that leave the surface, R = 2 (N·L) N − L, H = unit(L +
V), T the refracted direction of light from behind; E what arrives from a light, τ its shadow, g its gate (1 where N·L > 0, else
0), r its distance, ψ the angle to a spot's axis; K_diff, K_spec, p, K_amb, K_emit, k_refl, k_trans, t those of the material.
Numbers like Q5 are entries of the `QUIRKS.md` in that renderer's adapter. Third parties add rules of their own by the
entry-point group `equilux.causes`.
"""


def page(rules: Mapping[str, Rule] = RULES) -> str:
    """The whole page, Markdown."""
    return INTRODUCTION + "".join(_section(group, title, rules) for group, title in TITLES.items())


def _section(group: str, title: str, rules: Mapping[str, Rule]) -> str:
    lines = [f"\n## {title}\n", "| cause | what such a renderer does | the model says | the renderer does | suspects |"]
    lines.append("| --- | --- | --- | --- | --- |")
    lines += [_row(rule) for rule in rules.values() if rule.group == group]
    return "\n".join(lines) + "\n"


def _row(rule: Rule) -> str:
    model, changed = rule.formula
    cells = [f"`{rule.id}`{_parameter(rule)}", "<br>".join(_words(rule)), model, changed, rule.suspects]
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def _words(rule: Rule) -> Iterator[str]:
    text = inspect.cleandoc(type(rule).__doc__ or CAUSES[rule.id])
    yield from re.sub(r"\s*\n\s*(?=\S)", " ", re.sub(r"\n\s*\n", "\f", text)).split("\f")
    if len(rule.readings) > 1:
        yield "Readings:"
        yield from (f"• *{name}*: {words}" if name else f"• {words}" for name, words in rule.readings.items())


def _parameter(rule: Rule) -> str:
    match rule.parameter:
        case Continuous(name=name, unit=unit) | Discrete(name=name, unit=unit):
            return f" [{name}{_unit(unit)}]"
        case Vector(names=names, unit=unit):
            return f" [{', '.join(names)}{_unit(unit)}]"
    return ""


def _unit(unit: str) -> str:
    return f" {unit}" if unit else ""


if __name__ == "__main__":
    sys.stdout.write(page())
